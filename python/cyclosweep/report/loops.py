"""Figures of a loop in the language of gear tests: lost motion, hysteresis loss, energy, stiffness.

Definitions: lost motion is the mid-width angle of the loop between +3 % and -3 % of rated torque,
hysteresis loss the angle between the two branches at zero torque, torsional stiffness the slope
between 50 % and 100 % of rated torque (or of the largest torque, where the test stayed below the
rated one).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording

Floats = NDArray[np.float64]

LOST_MOTION_SHARE = 0.03
"""Share of rated torque at which lost motion is taken."""

_REACH = 0.1
"""Share of the largest torque over which a branch is extended beyond its end."""

_NEAR = 6
"""Samples of a branch nearest to a torque that tell its angle there."""


@dataclass(frozen=True, slots=True)
class LoopFigures:
    """Figures of the loops of one recording; None where it does not show them.

    Attributes
    ----------
    lost_motion_deg : float or None
        Mid-width angle between +3 % and -3 % of rated torque [deg].
    hysteresis_loss_deg : float or None
        Gap between the branches at zero torque, mean of both sides [deg].
    stiffness_nm_per_deg : float or None
        Slope of the loading branches between half and full torque [N m/deg].
    energy_j : dict of int to float
        Energy lost in one cycle, by run [J].
    extrapolated : bool
        The smallest torque lies above 3 % of the rated one, so that lost motion and hysteresis
        loss are straight-line extensions.
    stiffness_range_nm : (float, float)
        Torques between which the slope was taken [N m].
    """

    lost_motion_deg: float | None
    hysteresis_loss_deg: float | None
    stiffness_nm_per_deg: float | None
    energy_j: dict[int, float]
    extrapolated: bool
    stiffness_range_nm: tuple[float, float]


def loop_figures(
    recording: Recording, angle_deg: Floats, rated_torque_nm: float | None
) -> LoopFigures:
    """Figures of a measured or a simulated angle over the torque of a recording.

    Parameters
    ----------
    recording : Recording
        Load history and its structure.
    angle_deg : ndarray of float, shape (n,)
        Measured or predicted angle [deg].
    rated_torque_nm : float or None
        Rated torque at the measured shaft [N m]; None takes the largest torque.
    """
    torque = recording.torque_nm
    largest = float(np.abs(torque).max(initial=0.0))
    rated = rated_torque_nm or largest
    level = LOST_MOTION_SHARE * rated
    at_level, at_zero = _angles_at(recording, angle_deg, level), _angles_at(recording, angle_deg, 0)
    middle = {sign: np.mean(list(sides.values())) for sign, sides in at_level.items() if sides}
    gaps = [
        round(abs(sides["unloading"] - sides["loading"]), 9)
        for sides in at_zero.values()
        if len(sides) == 2
    ]
    top = min(rated, largest)
    loading = recording.structure.loading & (np.abs(torque) >= 0.5 * top)
    loading &= np.abs(torque) <= top * 1.001
    return LoopFigures(
        lost_motion_deg=float(middle[1] - middle[-1]) if len(middle) == 2 else None,
        hysteresis_loss_deg=float(np.mean(gaps)) if gaps else None,
        stiffness_nm_per_deg=_slope(torque, angle_deg, loading),
        energy_j=_energy(recording, angle_deg),
        extrapolated=float(np.abs(torque).min(initial=np.inf)) > level,
        stiffness_range_nm=(0.5 * top, top),
    )


def _angles_at(recording: Recording, angle: Floats, level: float) -> dict[int, dict[str, float]]:
    """Mean angle of the branches at a torque, by side of the dead zone and by direction."""
    found: dict[int, dict[str, list[float]]] = {1: {}, -1: {}}
    conditioning = set(recording.conditioning_runs)
    largest = float(np.abs(recording.torque_nm).max(initial=0.0))
    for branch in recording.structure.branches:
        if branch.run in conditioning:
            continue
        torque = recording.torque_nm[branch.start : branch.stop]
        twist = angle[branch.start : branch.stop]
        sign = 1 if np.sum(torque) > 0 else -1
        same = torque * sign > 0
        near = np.argsort(np.abs(torque[same] - sign * level), kind="stable")[:_NEAR]
        if len(near) < 3 or np.ptp(torque[same][near]) == 0:
            continue
        if np.abs(torque[same][near]).min() > level + _REACH * largest:
            continue  # an inner loop that stays away from there
        line = np.polynomial.Polynomial.fit(torque[same][near], twist[same][near], 1)
        found[sign].setdefault(branch.direction, []).append(float(line(sign * level)))
    return {
        sign: {direction: float(np.mean(angles)) for direction, angles in sides.items()}
        for sign, sides in found.items()
    }


def _slope(torque: Floats, angle: Floats, chosen: NDArray[np.bool_]) -> float | None:
    """Mean slope of torque over angle of both sides [N m/deg]."""
    slopes = []
    for side in (torque > 0, torque < 0):
        rows = chosen & side
        if np.count_nonzero(rows) >= 3 and np.ptp(torque[rows]) > 0:
            t, a = torque[rows], angle[rows]
            compliance = np.cov(t, a)[0, 1] / np.var(t, ddof=1)
            if compliance > 0:
                slopes.append(1.0 / compliance)
    return float(np.mean(slopes)) if slopes else None


def dead_zone_crossings(torque: Floats, angle: Floats) -> NDArray[np.bool_]:
    """Steps over which torque changes its sign and the angle jumps: the dead zone, not recorded.

    Parameters
    ----------
    torque, angle : ndarray of float, shape (n,)
        Torque, and measured or predicted angle, in any unit.

    Returns
    -------
    ndarray of bool, shape (n - 1,)
        For the step from each sample to the next.
    """
    far = np.abs(np.diff(angle)) > 0.1 * np.ptp(angle) if len(angle) else np.zeros(0, dtype=bool)
    crossings: NDArray[np.bool_] = far & (torque[1:] * torque[:-1] <= 0)
    return crossings


def _energy(recording: Recording, angle: Floats) -> dict[int, float]:
    """Area of each run's loop [J], for runs that come back to where they began.

    A dead zone that was not recorded is crossed at zero torque; from its last sample to there the
    shaft goes along the elastic line.
    """
    areas = {}
    twist = np.radians(angle)
    slope = _slope(recording.torque_nm, angle, recording.structure.loading)
    compliance = np.radians(1.0 / slope) if slope else 0.0
    for run in recording.runs:
        rows = np.flatnonzero(recording.run == run)
        torque, theta = recording.torque_nm[rows], twist[rows]
        span = float(np.ptp(torque))
        if len(rows) < 8 or span == 0 or abs(torque[-1] - torque[0]) > 0.1 * span:
            continue
        torque, theta = np.r_[torque, torque[0]], np.r_[theta, theta[0]]
        step = 0.5 * (torque[1:] + torque[:-1]) * np.diff(theta)
        crossing = dead_zone_crossings(torque, theta)
        step[crossing] = 0.5 * compliance * (torque[1:] ** 2 - torque[:-1] ** 2)[crossing]
        area = abs(float(step.sum()))
        rounding = 1e-9 * span * float(np.ptp(theta))  # of a line gone forth and back
        areas[run] = area if area > rounding else 0.0
    return areas
