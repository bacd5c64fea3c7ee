"""The three criteria for an active pin side by side, and McIver's claim on pulsation."""

from __future__ import annotations

from collections.abc import Iterator

import polars as pl

from cyclosweep.design.drive import CRITERIA, Criterion, Drive
from cyclosweep.reference.facts import Fact, Mark
from cyclosweep.reference.model import Model
from cyclosweep.reference.sources import MCIVER

__all__ = ["facts", "mciver", "pulsation"]

GROUP = "three criteria"
PIN_COUNTS = range(6, 16)
_MCIVER: dict[Criterion, str] = {
    "published-map": "by the reconstruction nine pins swing between 4 and 10 active contacts, "
    "eight between 4 and 8: with nine, one half has a hole more than the other",
    "inside": "",
    "statics": "by statics neither eight nor nine pins on two discs pulsate at all: the sum of "
    "sin^2 is the same in every position",
}


def facts(model: Model, drive: Drive) -> Iterator[Fact]:
    """Figures of each criterion for one drive, for comparison only.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.
    drive : Drive
        The drive.

    Yields
    ------
    Fact
    """
    notes: dict[Criterion, str] = {
        "published-map": "a reconstruction that matches the map",
        "inside": "the hole's centre inside the pitch circle, no clipping",
        "statics": "one spring per contact, loads by sin(psi): twist from C_OS^t + C_OP/(N_OP p)",
    }
    for criterion in CRITERIA:
        note = ("feeds the twist; " if criterion == drive.criterion else "") + notes[criterion]
        mark: Mark = "reconstruction" if criterion == "published-map" else "derived"
        active = model.pin_map(drive, criterion)
        for name, value in (
            ("mean", active.mean),
            ("fewest", float(active.minimum)),
            ("most", float(active.maximum)),
        ):
            fact = f"active pins, {name}, {criterion}"
            yield Fact(GROUP, fact, None, value, "1", mark, "comparison", None, note)
        twist = model.evaluate(drive.replace(criterion=criterion))["twist_1tn_deg"]
        fact = f"twist at 1 T_N, {criterion}"
        yield Fact(GROUP, fact, None, twist, "deg", "assumed", "comparison", None, note)


def mciver(model: Model) -> Iterator[Fact]:
    """Compare McIver's claim that nine pins pulsate less with what each criterion says.

    Parameters
    ----------
    model : Model
        The package, or the package with one error put in.

    Yields
    ------
    Fact
        One row of kind ``evidence`` for each criterion; 1 means that the claim holds.
    """
    drive = Drive.reference_87()
    for criterion in CRITERIA:
        eight, nine = (
            _pulsation(model, drive.replace(output_pin_count=pins), criterion) for pins in (8, 9)
        )
        yield Fact(
            GROUP,
            f"McIver: nine pins pulsate less than eight (1 = yes), {criterion}",
            1.0,
            float(nine < eight - 1e-9),
            "1",
            "derived",
            "evidence",
            0.0,
            "on the built-in drive with another number of pins",
            _MCIVER[criterion],
            0.0 if _MCIVER[criterion] else None,
            MCIVER,
        )


def _pulsation(model: Model, drive: Drive, criterion: Criterion) -> float:
    """(greatest - least) / mean over one turn: of stiffness by statics, else of contacts."""
    found = model.pin_map(drive, criterion)
    if criterion == "statics":
        return (found.stiffness_maximum - found.stiffness_minimum) / found.stiffness_mean
    return (found.maximum - found.minimum) / found.mean


def pulsation(drive: Drive) -> pl.DataFrame:
    """How much the pins' share pulsates over one turn, against the number of pins.

    Parameters
    ----------
    drive : Drive
        Everything but the number of pins.

    Returns
    -------
    polars.DataFrame
        ``output_pin_count`` 6 to 15, ``disc_count`` 1 and the drive's own, and for each criterion
        (greatest - least) / mean: of the active contacts for ``published-map`` and ``inside``,
        of the stiffness (sum of sin^2) for ``statics``.

    Notes
    -----
    McIver (cited in section 5 of the paper) claims that nine or a higher odd number of pins
    pulsates less. By ``inside`` that holds on two discs, where odd numbers pulsate half as much
    as their even neighbours, and not on one; by ``published-map`` odd numbers pulsate more; by
    ``statics`` an even number does not pulsate at all, nor does any number on two discs.
    """
    rows = []
    for discs in sorted({1, drive.disc_count}):
        for pins in PIN_COUNTS:
            row: dict[str, float] = {"disc_count": discs, "output_pin_count": pins}
            changed = drive.replace(disc_count=discs, output_pin_count=pins)
            for criterion in CRITERIA:
                row[criterion.replace("-", "_")] = _pulsation(Model(), changed, criterion)
            rows.append(row)
    return pl.DataFrame(rows)
