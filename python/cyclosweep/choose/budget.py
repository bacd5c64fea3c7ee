"""Which part of a drive gives how much of its torsional compliance, by both models."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.design.loaded import ARCMIN

__all__ = ["BudgetItem", "budget_of_components", "budget_of_published"]

Values = Mapping[str, float | None]

_PARTS = {
    "twist_ring_contacts_arcmin": "ring pin contacts",
    "twist_output_contacts_arcmin": "output pin contacts",
    "twist_pin_bending_arcmin": "output pins, bending and shear",
    "twist_pin_root_arcmin": "flange at the pins' roots",
    "twist_eccentric_bearing_arcmin": "eccentric bearings",
    "twist_shaft_arcmin": "output shaft",
    "twist_clearance_arcmin": "clearances taken up",
}
"""Columns of the component model that sum to the twist at rated torque, and what they are."""


@dataclass(frozen=True)
class BudgetItem:
    """One part of a drive's compliance, seen at the output.

    Attributes
    ----------
    part : str
        What yields.
    compliance_arcmin_per_nm : float
        Its compliance [arcmin/(N m)]; the items of a drive sum to the whole.
    share : float
        Its share of the whole [1].
    """

    part: str
    compliance_arcmin_per_nm: float
    share: float

    @property
    def stiffness_nm_per_arcmin(self) -> float | None:
        """Stiffness of the drive if nothing but this part yielded [N m/arcmin]; None if rigid."""
        found = self.compliance_arcmin_per_nm
        return 1.0 / found if found else None


def budget_of_published(drive: Drive, results: Values) -> list[BudgetItem]:
    """Compliance of each shaft segment, of the shoulders and of the output pins, Eqs. (4)-(11).

    Parameters
    ----------
    drive : Drive
        What it is made of.
    results : mapping
        Its result columns by name.

    Returns
    -------
    list of BudgetItem
        They sum to ``output_compliance_rad_per_nm``, before the torque transfer efficiency of
        Eq. (13); empty where that does not apply. One item where the stiffness is given.

    Examples
    --------
    >>> drive = Drive.reference_87()
    >>> items = budget_of_published(drive, drive.evaluate())
    >>> items[-1].part, round(sum(item.share for item in items), 12)
    ('output pins, bending and shear', 1.0)
    """
    total = results["output_compliance_rad_per_nm"]
    if total is None:
        return []
    if drive.output_stiffness_nm_per_arcmin is not None:
        return _items({"output stiffness as given": total})
    shaft = results["shaft_compliance_rad_per_nm"]
    assert shaft is not None  # there is one wherever the output's compliance is
    parts = dict(_segments(drive, shaft))
    parts["shoulders of the shaft"] = max(shaft - sum(parts.values()), 0.0)
    parts["output pins, bending and shear"] = total - shaft
    return _items(parts)


def budget_of_components(drive: Drive, results: Values) -> list[BudgetItem]:
    """Compliance of each part at rated torque by the component model, mean over the crank.

    Parameters
    ----------
    drive : Drive
        Its rated torque is read.
    results : mapping
        Its result columns by name, those of the component model among them.

    Returns
    -------
    list of BudgetItem
        They sum to twist over torque from the unloaded middle; empty without the model.
    """
    twists = {part: results.get(column) for column, part in _PARTS.items()}
    known = {part: twist for part, twist in twists.items() if twist is not None}
    if len(known) < len(twists):
        return []
    return _items({part: twist * ARCMIN / drive.output_torque_nm for part, twist in known.items()})


def _segments(drive: Drive, shaft: float) -> Iterator[tuple[str, float]]:
    """Compliance [rad/(N m)] of each segment: it is in proportion to the segment's length."""
    for number, segment in enumerate(drive.shaft, start=1):
        longer = drive.replace(**{f"shaft_{number}_length_mm": 2.0 * segment.length_mm})
        _, _, found = longer.study().evaluate_range(0, 1, ["shaft_compliance_rad_per_nm"])
        yield f"shaft segment {number}, {segment.kind}", float(found[0, 0]) - shaft


def _items(parts: Mapping[str, float]) -> list[BudgetItem]:
    total = sum(parts.values())
    return [BudgetItem(part, value / ARCMIN, value / total) for part, value in parts.items()]


def budget_table(items: list[tuple[str, str, BudgetItem]]) -> pl.DataFrame:
    """Items of several drives and models as one table.

    Parameters
    ----------
    items : list of (str, str, BudgetItem)
        Drive, model, item.

    Returns
    -------
    polars.DataFrame
        ``drive``, ``model``, ``part``, ``compliance_arcmin_per_nm``, ``stiffness_nm_per_arcmin``
        (null for a part that does not yield), ``share``.
    """
    schema = {
        "drive": pl.String(),
        "model": pl.String(),
        "part": pl.String(),
        "compliance_arcmin_per_nm": pl.Float64(),
        "stiffness_nm_per_arcmin": pl.Float64(),
        "share": pl.Float64(),
    }
    rows = [
        (drive, model, item.part, item.compliance_arcmin_per_nm, item.stiffness_nm_per_arcmin,
         item.share)
        for drive, model, item in items
    ]  # fmt: skip
    return pl.DataFrame(rows, schema=schema, orient="row")
