"""The three criteria side by side, and McIver's claim on pulsation."""

from __future__ import annotations

import math
from collections.abc import Iterator

import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.drive import CRITERIA, Drive
from cyclosweep.reference.facts import Fact, Mark

__all__ = ["facts", "pulsation"]

PIN_COUNTS = range(6, 16)


def facts(drive: Drive) -> Iterator[Fact]:
    """Figures of each criterion for one drive, for comparison only.

    Parameters
    ----------
    drive : Drive
        The drive.

    Yields
    ------
    Fact
    """
    group = "three criteria"
    notes = {
        "published-map": "feeds the published study; a reconstruction that matches the map",
        "inside": "the hole's centre inside the pitch circle, no clipping",
        "statics": "one spring per contact, loads by sin(psi): twist from C_OS^t + C_OP/(N_OP p)",
    }
    for criterion in CRITERIA:
        note = notes[criterion]
        mark: Mark = "reconstruction" if criterion == "published-map" else "derived"
        active = drive.active_pins(criterion)
        for name, value in (
            ("mean", active.mean),
            ("fewest", float(active.minimum)),
            ("most", float(active.maximum)),
        ):
            fact = f"active pins, {name}, {criterion}"
            yield Fact(group, fact, None, value, "1", mark, None, note)
        chosen = drive.replace(criterion=criterion)
        twist = chosen.evaluate((1.0,))["twist_1tn_deg"]
        yield Fact(group, f"twist at 1 T_N, {criterion}", None, twist, "deg", "assumed", None, note)


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
    half_sine = drive.eccentricity_mm / (2 * drive.output_pin_circle_radius_mm)
    delta = math.asin(half_sine) / math.tau
    for discs in sorted({1, drive.disc_count}):
        for pins in PIN_COUNTS:
            row: dict[str, float] = {"disc_count": discs, "output_pin_count": pins}
            for code, criterion in enumerate(CRITERIA):
                (mean, low, high), (p_mean, p_low, p_high), _ = _core.active_pins(
                    code, float(drive.ratio), discs, pins, delta, drive.hole_clocking_deg / 360
                )
                if criterion == "statics":
                    mean, ripple = p_mean, p_high - p_low
                else:
                    ripple = high - low
                row[criterion.replace("-", "_")] = ripple / mean
            rows.append(row)
    return pl.DataFrame(rows)
