"""Play, compliance and friction of each run by straight lines, without a model of the drive."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording

Floats = NDArray[np.float64]

LINE_SHARES = (0.2, 0.8)
"""Shares of the largest torque between which a flank is taken as straight: above the soft start of
the contacts, below the turning point."""
ANGLE_BINS = 120
"""Bins of the angle in which rising and falling branches are compared."""
LEAST_BINS = 4
"""Fewest bins of a flank through which a line is laid."""
ROUNDING = 1e-9
"""Share of the largest torque below which the loop's width is an error of rounding."""


@dataclass(frozen=True, slots=True)
class LoopLines:
    """What straight lines through the middle of a loop say of one run.

    Attributes
    ----------
    run : int
        The run.
    play_deg : float
        Whole play: distance of both lines at zero torque [deg].
    compliance_deg_per_nm : float
        Mean slope of both lines [deg/(N m)].
    friction_nm : float
        Half the width of the loop in torque at equal angle, on the same parts of both flanks
        [N m]. Below them friction still builds up in the first loading from zero.
    """

    run: int
    play_deg: float
    compliance_deg_per_nm: float
    friction_nm: float


def straight_lines(recording: Recording) -> list[LoopLines]:
    """Lay straight lines through the middle of the loop of each run that counts.

    At equal angle friction adds to the torque of the rising branch what it takes from that of the
    falling one: their mean is the elastic torque, half their difference the friction.

    Parameters
    ----------
    recording : Recording
        With an angle, loaded in both directions.

    Returns
    -------
    list of LoopLines
        A row for each run that shows both branches on both flanks; conditioning runs are left out.
    """
    if recording.angle_deg is None:
        return []
    found = []
    for run in recording.runs:
        if run in recording.conditioning_runs:
            continue
        rows = (recording.run == run) & recording.counts
        lines = _of_run(run, recording.torque_nm[rows], recording.angle_deg[rows])
        if lines is not None:
            found.append(lines)
    return found


def friction_of_all(recording: Recording) -> float | None:
    """Read the friction from all runs that count taken together, where no single one suffices.

    Parameters
    ----------
    recording : Recording
        With an angle, loaded in both directions.

    Returns
    -------
    float or None
        Half the width of the loop in torque at equal angle [N m]; None where the readings are too
        few, or a branch or a flank is missing.
    """
    if recording.angle_deg is None:
        return None
    rows = recording.counts & ~np.isin(recording.run, list(recording.conditioning_runs))
    lines = _of_run(0, recording.torque_nm[rows], recording.angle_deg[rows])
    return None if lines is None else lines.friction_nm


def _of_run(run: int, torque: Floats, angle: Floats) -> LoopLines | None:
    """Read one run; None where a branch or a flank is missing.

    Parameters
    ----------
    run : int
        Its number.
    torque, angle : ndarray of float, shape (n,)
        Its samples [N m, deg].

    Returns
    -------
    LoopLines or None
    """
    if len(torque) < 8 or np.ptp(angle) <= 0:
        return None
    width = max(1, len(torque) // 100)
    smooth = np.convolve(np.pad(torque, width, mode="edge"), np.ones(2 * width + 1), "valid")
    rising = np.gradient(smooth) > 0
    edges = np.linspace(angle.min(), angle.max(), min(ANGLE_BINS, len(torque) // 4) + 1)
    place = np.clip(np.searchsorted(edges, angle, side="right") - 1, 0, len(edges) - 2)
    torques: list[Floats] = []
    angles: list[Floats] = []
    for part in (rising, ~rising):
        count = np.bincount(place[part], minlength=len(edges) - 1)
        for mean, values in ((torques, torque), (angles, angle)):
            total = np.bincount(place[part], values[part], minlength=len(edges) - 1)
            mean.append(np.where(count > 0, total / np.maximum(count, 1), np.nan))
    (up, down), (up_deg, down_deg) = torques, angles
    middle, half = 0.5 * (up + down), 0.5 * (up - down)
    # Where the readings of a bin lie, not its middle: few of them lie about it evenly.
    centre, apart = 0.5 * (up_deg + down_deg), 0.5 * (up_deg - down_deg)
    largest = np.nanmax(np.abs(middle)) if np.isfinite(middle).any() else 0.0
    low, high = (share * largest for share in LINE_SHARES)
    ends, slopes, flanks = [], [], np.zeros(len(middle), dtype=bool)
    for side in (-1.0, 1.0):
        load = side * middle
        on = (load > low) & (load < high)
        if np.count_nonzero(on) < LEAST_BINS:
            return None
        slope, end = np.polyfit(middle[on], centre[on], 1)
        ends.append(float(end))
        slopes.append(float(slope))
        flanks |= on
        half[on] -= apart[on] / slope
    friction = float(np.mean(half[flanks]))
    if abs(friction) < ROUNDING * largest:
        friction = 0.0
    return LoopLines(run, ends[1] - ends[0], float(np.mean(slopes)), friction)
