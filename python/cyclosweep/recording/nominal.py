"""Unit of the angle and side of the gear, told by the stiffness that a drive file states."""

import math
from dataclasses import dataclass

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.design.nominal_line import Side
from cyclosweep.errors import DesignError
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.structure import DEAD_ZONE_SHARE
from cyclosweep.recording.units import factor_of

__all__ = ["Guess", "explain", "slope_of", "unit_by_steps"]

ANGLE_UNITS = {
    name: factor_of(name, "angle_deg")
    for name in ("deg", "rad", "mrad", "arcmin", "arcsec", "turns")
}
"""Degrees in one unit of a column that does not say which."""

FEWEST_BITS = 8
"""Least resolution of an encoder whose steps tell the unit."""

MOST_BITS = 26
"""Finest resolution looked for: encoders of shafts have up to 26 bits."""

FEWEST_LEVELS = 12
"""Readings that must all lie on a step, each of which does by chance once in fifty times."""

CLEAR = 2.0
"""A guess counts if the drive comes out within this factor of its file, and every other guess fits
worse by it: the nearest two units, radians and turns, differ by 6.3."""


@dataclass(frozen=True, slots=True)
class Guess:
    """Unit and side with which a recording fits its drive best.

    Attributes
    ----------
    unit : str
        Unit of the angle.
    side : {"input", "output"}
        Shaft of torque and angle.
    factor : float
        Measured over nominal compliance.
    clear : bool
        Whether no other guess comes near.
    """

    unit: str
    side: Side
    factor: float
    clear: bool


def unit_by_steps(angle: Floats) -> str | None:
    """Tell the unit of an encoder's angle by its steps: a turn has a power of two of them.

    Parameters
    ----------
    angle : ndarray of float, shape (n,)
        Angle in the file's unit.

    Returns
    -------
    str or None
        None where the steps are not those of an encoder.
    """
    levels = np.unique(angle[np.isfinite(angle)])
    if len(levels) < FEWEST_LEVELS:
        return None
    for unit, degrees in ANGLE_UNITS.items():
        for bits in range(MOST_BITS + 1):
            places = levels * (2.0**bits * degrees / 360.0)
            if np.abs(places - np.rint(places)).max() < 0.01:
                # Whole numbers and halves are such steps, too, but of few bits.
                if bits >= FEWEST_BITS:
                    return unit
                break
    return None


def slope_of(torque_nm: Floats, angle: Floats) -> float | None:
    """Slope of angle over torque beside a free play, by least squares.

    Parameters
    ----------
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    angle : ndarray of float, shape (n,)
        Angle in the file's unit.

    Returns
    -------
    float or None
        Magnitude [unit/(N m)]; None where too little is known.
    """
    known = np.isfinite(torque_nm) & np.isfinite(angle)
    torque, angle = torque_nm[known], angle[known]
    loaded = np.abs(torque) > DEAD_ZONE_SHARE * np.abs(torque).max(initial=0.0)
    torque, angle = torque[loaded], angle[loaded]  # without load the twist lies within the play
    if len(torque) < 3 or not np.ptp(torque) or not np.ptp(angle):
        return None
    columns = [torque, np.ones_like(torque)]
    if torque.min() < 0 < torque.max():
        columns.append(np.sign(torque))
    slope = abs(float(np.linalg.lstsq(np.column_stack(columns), angle, rcond=None)[0][0]))
    return slope if slope > 0 and math.isfinite(slope) else None


def explain(slope: float, drive: Drive, unit: str | None, side: Side | None) -> Guess | None:
    """Find the unit and the side with which a slope is nearest to the drive's own.

    Parameters
    ----------
    slope : float
        Measured slope, in the file's unit over N m.
    drive : Drive
        The drive file.
    unit : str or None
        Unit of the angle where it is known, which is then deg.
    side : {"input", "output"} or None
        The shaft where it is known.

    Returns
    -------
    Guess or None
        None where the drive has no line.
    """
    found: list[tuple[float, str, Side, float]] = []
    sides: tuple[Side, ...] = ("input", "output") if side is None else (side,)
    for shaft in sides:
        try:
            nominal = drive.nominal_line(shaft).compliance_deg_per_nm
        except DesignError:
            return None
        for name, degrees in ANGLE_UNITS.items() if unit is None else [("deg", 1.0)]:
            factor = slope * degrees / nominal
            found.append((abs(math.log(factor)), name, shaft, factor))
    found.sort()
    clear = found[0][0] < math.log(CLEAR) and (
        len(found) == 1 or found[1][0] - found[0][0] > math.log(CLEAR) / 2
    )
    return Guess(found[0][1], found[0][2], found[0][3], clear)
