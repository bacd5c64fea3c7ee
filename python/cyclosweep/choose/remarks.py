"""What to be careful about in a drive's numbers: limits passed, numbers that are assumed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from cyclosweep.choose.fit_of_parts import misfits
from cyclosweep.design.drive import Drive

__all__ = ["Remark", "remarks_on"]

Level = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Remark:
    """One sentence about a drive.

    Attributes
    ----------
    level : {"error", "warning", "note"}
        Cannot be, should not be, or worth knowing.
    text : str
        The sentence, with the numbers.
    """

    level: Level
    text: str


def remarks_on(
    drive: Drive, results: Mapping[str, float | None], reason: str | None, parts_reason: str | None
) -> list[Remark]:
    """Check a drive's numbers.

    Parameters
    ----------
    drive : Drive
        The drive.
    results : mapping
        Its result columns by name, None or absent where they do not apply.
    reason, parts_reason : str, optional
        Why it cannot be built, and why there is no component model of it.

    Returns
    -------
    list of Remark
        Errors first, then warnings, then notes.
    """
    found = [*_errors(reason), *_warnings(drive, results), *_notes(drive, reason, parts_reason)]
    order: tuple[Level, ...] = ("error", "warning", "note")
    return sorted(found, key=lambda remark: order.index(remark.level))


def _errors(reason: str | None) -> Iterator[Remark]:
    if reason is not None:
        yield Remark("error", f"cannot be built: {reason}")


def _warnings(drive: Drive, results: Mapping[str, float | None]) -> Iterator[Remark]:
    def above(name: str, limit: float) -> float | None:
        value = results.get(name)
        return value if value is not None and value > limit else None

    if drive.overall_efficiency > 1:
        yield Remark(
            "warning",
            f"efficiency above one: {drive.output_torque_nm:g} N m at the output is "
            f"{drive.overall_efficiency:.3g} times what ratio {drive.ratio} makes of "
            f"{drive.nominal_torque_nm:.4g} N m at the input "
            f"({drive.input_power_kw:g} kW at {drive.input_speed_rpm:g} rpm)",
        )
    for name, what in (
        ("torque_transfer_efficiency", "torque transfer efficiency"),
        ("efficiency", "efficiency of the component model"),
    ):
        if (value := above(name, 1.0)) is not None:
            yield Remark("warning", f"{what} above one: {value:.4g}")
    for name, what in (
        ("pin_yield_ratio_max", "output pins yield at their roots"),
        ("contact_yield_ratio_max", "contacts yield below their surface"),
    ):
        if (value := above(name, 1.0)) is not None:
            yield Remark("warning", f"{what}: {value:.3g} times the yield strength")
    for words in misfits(drive):
        yield Remark("warning", words)
    stress, strength = results.get("pin_bending_stress_mpa"), drive.pin_yield_strength_mpa
    if stress is not None and strength is not None and stress > strength:
        yield Remark(
            "warning",
            f"bending stress of the output pins by statics is {stress:.4g} MPa, above the yield "
            f"strength of {strength:g} MPa",
        )
    factor = results.get("compliance_factor")
    if factor is not None and factor < 1:
        yield Remark(
            "note",
            f"Eq. (13) multiplies the published compliance by {factor:.4g}: fewer active pins then "
            "mean less twist, which is no gain of the drive",
        )


def _notes(drive: Drive, reason: str | None, parts_reason: str | None) -> Iterator[Remark]:
    marks = Counter(mark.partition(":")[0].strip() for mark in drive.provenance.values())
    assumed = [
        key for key, mark in drive.provenance.items() if mark.partition(":")[0].strip() == "assumed"
    ]
    if assumed:
        yield Remark("warning", f"assumed are {len(assumed)} of its numbers: {', '.join(assumed)}")
    given = [key for key in drive.marked() if _is_given(drive, key)]
    unmarked = [key for key in given if key not in drive.provenance]
    if unmarked and marks:
        yield Remark(
            "note", f"numbers without a mark of their origin: {', '.join(unmarked)}"
        )  # fmt: skip
    elif unmarked:
        yield Remark("note", "none of its numbers has a mark of its origin ([provenance])")
    if drive.free_play_deg == 0:
        yield Remark("note", "free play is zero: every twist is that of the elastic parts alone")
    if parts_reason is not None:
        yield Remark("note", f"no component model: {parts_reason}")
    elif reason is None and (numbers := list(_standing_in(drive))):
        yield Remark(
            "note",
            "the component model and its efficiency rest on what stands in for numbers left out: "
            + ", ".join(numbers),
        )


def _standing_in(drive: Drive) -> Iterator[str]:
    """Numbers of the component model for which a default stands in, with their values."""
    reaches = [f"disc_{disc}_reach_mm" for disc in range(1, drive.disc_count + 1)]
    for key, value, mark in drive.part_table().iter_rows():
        is_used = key in reaches or not key.endswith("_reach_mm")
        if is_used and getattr(drive, key) is None and value is not None:
            default = mark.removeprefix("assumed: ")
            yield f"{key} {default if default.startswith('as ') else f'{value:g}'}"


def _is_given(drive: Drive, key: str) -> bool:
    """Whether a key has a value of its own: one that is not what stands there without it.

    By the value alone: what a drive was made from, and whether it was written and read back, does
    not change it.
    """
    if key == "criterion":
        return False
    if key.startswith("shaft_"):
        return True
    return bool(getattr(drive, key) != type(drive).model_fields[key].default)
