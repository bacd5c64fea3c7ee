"""Width of a simulated loop, in torque at equal angle."""

import numpy as np

from cyclosweep.simulation.effects.history import Flags, Floats, History, Ints

LEVELS = 48
"""Angles at which the width is read."""
ENDS = 0.05
"""Share of the range of the angle left out at either end, where the branches meet."""


def widest_nm(history: History, rows: Flags) -> float | None:
    """Largest difference of the torques of two branches in succession at one angle.

    Parameters
    ----------
    history : History
        All rows with the path of a simulation, n of them.
    rows : ndarray of bool, shape (n,)
        Rows that count.

    Returns
    -------
    float or None
        In N m; None where no angle is passed twice in a run.
    """
    if not np.any(rows):
        return None
    run = np.where(rows, history.run, -1)
    low, high = float(history.angle_deg[rows].min()), float(history.angle_deg[rows].max())
    inset = ENDS * (high - low)
    widths = [
        width
        for level in np.linspace(low + inset, high - inset, LEVELS)
        for width in _widths(history.applied_nm, history.angle_deg, run, float(level))
    ]
    return max(widths, default=None)


def _widths(torque: Floats, angle: Floats, run: Ints, level: float) -> list[float]:
    """Differences of the torques at which the same run passes an angle one way and back.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Path [N m, deg].
    run : ndarray of int, shape (n,)
        Run of each row, negative where it does not count.
    level : float
        The angle [deg].

    Returns
    -------
    list of float
        In N m.
    """
    above = angle > level
    before = np.flatnonzero(
        (above[1:] != above[:-1]) & (run[1:] == run[:-1]) & (run[1:] >= 0)
    )  # fmt: skip
    share = (level - angle[before]) / (angle[before + 1] - angle[before])
    crossed = torque[before] + share * (torque[before + 1] - torque[before])
    one_run = run[before][1:] == run[before][:-1]
    return [float(width) for width in np.abs(np.diff(crossed))[one_run]]
