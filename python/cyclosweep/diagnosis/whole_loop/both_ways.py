"""Whether a staircase is the same with rising as with falling torque, at the same positions.

A torque that pulsates with the position, as of motor poles, and a transmission error push alike in
both directions; friction that pulsates with the position holds back in both, so that it pushes
oppositely. The torque is compared at equal angle: at equal torque each direction would stand still
before its own steps, and the same staircase would look different.
"""

import itertools

import numpy as np
from scipy import stats

from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.recording.structure import turning_points
from cyclosweep.simulation.effects.history import Floats, Ints

CELLS = 400
"""Cells over the range of the angle in which the torque is averaged: a staircase has up to forty
steps there."""
TREND = 16.0
"""Range of the angle over the width of the local line that is taken out (one standard deviation):
what is left are steps of up to a quarter of the range."""
TURN = 0.2
"""Share of the range of the torque from which a change of direction is one of the programme."""
FEWEST_CELLS = 60
"""Cells that both directions pass below which nothing is said."""
ALIKE = 0.4
"""Correlation from which both directions are said to be alike, and below minus which opposite."""


def direction_correlation(problem: Problem) -> float | None:
    """Correlation of ranks between rising and falling torque at equal angle, less each's trend.

    Parameters
    ----------
    problem : Problem
        The prepared recording; all rows that count are compared, kept ones too.

    Returns
    -------
    float or None
        Over all pairs of directions within a run; None where they pass too few places together.
    """
    rows = problem.whole_fitted | problem.whole_held_out
    torque, angle = problem.history.applied_nm, problem.angle_deg
    width, whole = float(np.ptp(angle[rows])) / CELLS, float(np.ptp(torque[rows]))
    first: list[Floats] = []
    second: list[Floats] = []
    for run in np.unique(problem.history.run[rows]):
        index = np.flatnonzero(problem.history.run == run)
        legs = [leg[rows[leg]] for leg in legs_of(torque, index, whole)]
        profiles = [profile(torque[leg], angle[leg], width, CELLS / TREND) for leg in legs]
        for (cells, one), (others, other) in itertools.pairwise(profiles):
            _, here, there = np.intersect1d(cells, others, return_indices=True)
            first.append(one[here])
            second.append(other[there])
    if sum(map(len, first)) < FEWEST_CELLS:
        return None
    # By ranks: what is left of a reversal is a few cells of any size.
    return float(stats.spearmanr(np.concatenate(first), np.concatenate(second)).statistic)


def legs_of(torque: Floats, index: Ints, range_nm: float) -> list[Ints]:
    """Rows of a run from each of its turning points to the next.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        Torque of the whole recording [N m].
    index : ndarray of int
        Rows of the run.
    range_nm : float
        Range of the torque, a share of which makes a turn [N m].

    Returns
    -------
    list of ndarray of int
    """
    ends = turning_points(torque[index], TURN * range_nm)
    ends = np.unique(np.r_[0, ends, len(index) - 1])
    return [index[a + 1 : b + 1] for a, b in itertools.pairwise(ends)]


def in_words(correlation: float | None) -> str:
    """Sentence on what a staircase can be, by the correlation of the two directions."""
    if correlation is None:
        return ""
    alike = f"(correlation of the torque at equal angle {correlation:.2f})"
    if correlation >= ALIKE:
        return (
            f" They are alike with rising and with falling torque {alike}, as from a torque that "
            "pulsates with the position or from a transmission error."
        )
    if correlation <= -ALIKE:
        return (
            f" They are opposite with rising and with falling torque {alike}, as from friction "
            "that pulsates with the position."
        )
    return (
        f" With rising torque they are others than with falling {alike}: neither a transmission "
        "error nor friction that pulsates with the position makes them alone."
    )


def profile(torque: Floats, angle: Floats, width: float, trend: float) -> tuple[Ints, Floats]:
    """Torque over angle less a local line.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        Torque of one direction [N m].
    angle : ndarray, shape (n,)
        Angle [deg].
    width : float
        Width of a cell [deg].
    trend : float
        Width of the local line in cells, one standard deviation.

    Returns
    -------
    cell : ndarray of int, shape (k,)
    torque : ndarray, shape (k,)
        In N m.
    """
    if len(angle) == 0 or width <= 0.0:
        return np.zeros(0, np.int64), np.zeros(0)
    cell, which = np.unique(np.floor(angle / width).astype(np.int64), return_inverse=True)
    mean = np.bincount(which, torque) / np.bincount(which)
    away = (cell[None, :] - cell[:, None]) / trend
    weight = np.exp(-0.5 * away**2)
    sums = [np.sum(weight * away**k, axis=1) for k in range(3)]
    level, slope = weight @ mean, (weight * away) @ mean
    room = np.maximum(sums[0] * sums[2] - sums[1] ** 2, 1e-9 * sums[0] ** 2)
    return cell, np.asarray(mean - (sums[2] * level - sums[1] * slope) / room)
