"""Unit of the angle and side of the gear, told by the stiffness that a drive file states."""

import math
from dataclasses import dataclass

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.design.nominal_line import Side
from cyclosweep.errors import DesignError
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import wraps_at_360
from cyclosweep.recording.structure import DEAD_ZONE_SHARE
from cyclosweep.recording.units import factor_of

__all__ = ["FAR", "Guess", "explain", "overload", "slope_of", "unit_by_jumps", "unit_by_steps"]

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

CLEAR_OF_BOTH = 1.25
"""The same where unit and side are both guessed: with six units at two shafts, one of them comes
within a factor of two of almost any slope."""

FAR = 10.0
"""Factor beyond which a compliance is another unit's or shaft's, not a softer drive's."""

MOST_LOAD = 5.0
"""Largest torque over the rated one that a test reaches: drives stand that in an emergency stop."""

WHOLE_TURN = 0.95
"""Share of a turn that the readings of a dial which wraps cover at least."""

WILD = 12.0
"""Misfit over the usual one, as a standard deviation, of samples that are left out of a slope."""

PASSES = 3
"""Times that a slope is found, each without the samples that are far off the one before."""


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
    shafts : int
        Shafts among which the side was chosen: those that bear the torque.
    """

    unit: str
    side: Side
    factor: float
    clear: bool
    shafts: int = 1


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


def unit_by_jumps(angle: Floats, torque_nm: Floats) -> str | None:
    """Tell the unit of a dial that wraps by its jumps, which are a turn.

    Parameters
    ----------
    angle : ndarray of float, shape (n,)
        Angle in the file's unit.
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].

    Returns
    -------
    str or None
        None where it does not wrap.
    """
    known = np.isfinite(angle) & np.isfinite(torque_nm)
    if np.count_nonzero(known) < FEWEST_LEVELS:
        return None
    for unit, degrees in ANGLE_UNITS.items():
        turned = angle[known] * degrees
        if np.ptp(turned) > WHOLE_TURN * 360.0 and wraps_at_360(turned, torque_nm[known]):
            return unit
    return None


def overload(torque_nm: float, drive: Drive, side: Side) -> float:
    """Torque over the rated one of a shaft.

    Parameters
    ----------
    torque_nm : float
        Magnitude of the torque [N m].
    drive : Drive
        The drive file.
    side : {"input", "output"}
        The shaft.

    Returns
    -------
    float
    """
    rated = drive.output_torque_nm
    if side == "input":
        rated = max(rated / drive.ratio, drive.nominal_torque_nm)
    return torque_nm / rated


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
    terms = np.column_stack(columns)
    kept = np.ones(len(angle), dtype=np.bool_)
    slope = 0.0
    for _ in range(PASSES):  # single samples far off, which a diagnosis leaves out, decide nothing
        found = np.linalg.lstsq(terms[kept], angle[kept], rcond=None)[0]
        slope = abs(float(found[0]))
        misfit = np.abs(angle - terms @ found)
        kept = misfit <= max(WILD * robust_sigma(misfit), 1e-9 * np.ptp(angle[kept]))
    return slope if slope > 0 and math.isfinite(slope) else None


def explain(
    slope: float, drive: Drive, unit: str | None, side: Side | None, torque_nm: float
) -> Guess | None:
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
        The shaft where it is known; else one of those that bear the torque.
    torque_nm : float
        Largest magnitude of the torque [N m].

    Returns
    -------
    Guess or None
        None where the drive has no line.
    """
    found: list[tuple[float, str, Side, float]] = []
    both: tuple[Side, ...] = ("input", "output")
    able = [each for each in both if overload(torque_nm, drive, each) <= MOST_LOAD]
    sides = [side] if side is not None else able or both
    for shaft in sides:
        try:
            nominal = drive.nominal_line(shaft).compliance_deg_per_nm
        except DesignError:
            return None
        for name, degrees in ANGLE_UNITS.items() if unit is None else [("deg", 1.0)]:
            factor = slope * degrees / nominal
            found.append((abs(math.log(factor)), name, shaft, factor))
    found.sort()
    near = CLEAR_OF_BOTH if unit is None and len(sides) > 1 else CLEAR
    clear = found[0][0] < math.log(near) and (
        len(found) == 1 or found[1][0] - found[0][0] > math.log(CLEAR) / 2
    )
    return Guess(found[0][1], found[0][2], found[0][3], clear, len(sides))
