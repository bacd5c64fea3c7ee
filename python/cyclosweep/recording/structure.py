"""How a load history is made up: runs, branches, reversals, holds, dead-zone samples."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording.samples import Floats, Ints, Samples

Direction = Literal["loading", "unloading"]

REVERSAL_SHARE = 0.05
"""A change of direction counts once the torque has gone back by this share of its range."""

HOLD_SAMPLES = 5
"""Fewest samples at one torque that count as a hold."""

DEAD_ZONE_SHARE = 0.005
"""Torque below this share of the largest leaves the twist undetermined."""


@dataclass(frozen=True, slots=True)
class Branch:
    """Samples over which the magnitude of torque goes one way.

    Attributes
    ----------
    run : int
        Run they belong to.
    start, stop : int
        First sample, and the one after the last.
    direction : {"loading", "unloading"}
        Whether the magnitude of torque grows.
    torque_from_nm, torque_to_nm : float
        Torque of the first and of the last sample [N m].
    """

    run: int
    start: int
    stop: int
    direction: Direction
    torque_from_nm: float
    torque_to_nm: float


@dataclass(frozen=True, slots=True)
class Hold:
    """Samples at one torque.

    Attributes
    ----------
    run : int
        Run they belong to.
    start, stop : int
        First sample, and the one after the last.
    torque_nm : float
        The torque [N m].
    duration_s : float or None
        How long it was held [s]; None without a clock.
    """

    run: int
    start: int
    stop: int
    torque_nm: float
    duration_s: float | None


@dataclass(frozen=True, eq=False, slots=True)
class Structure:
    """Structure of a load history.

    Attributes
    ----------
    branches : tuple of Branch
        In the order recorded; every sample belongs to one.
    holds : tuple of Hold
        Plateaus of torque.
    reversals : ndarray of int
        Samples at which the torque turns back.
    sense : ndarray of int8, shape (n,)
        +1 where torque rises, -1 where it falls.
    loading : ndarray of bool, shape (n,)
        Whether the magnitude of torque grows.
    dead_zone : ndarray of bool, shape (n,)
        Torque so small that the twist is not determined.
    """

    branches: tuple[Branch, ...]
    holds: tuple[Hold, ...]
    reversals: Ints
    sense: NDArray[np.int8]
    loading: NDArray[np.bool_]
    dead_zone: NDArray[np.bool_]


def find_structure(recording: Samples) -> Structure:
    """Split a load history into branches, holds and reversals, each within a run."""
    torque, run = recording.torque_nm, recording.run
    n = len(torque)
    sense = np.ones(n, dtype=np.int8)
    loading = np.ones(n, dtype=bool)
    largest = float(np.abs(torque).max(initial=0.0))
    threshold = REVERSAL_SHARE * float(np.ptp(torque)) if n else 0.0
    reversals: list[int] = []
    branches: list[Branch] = []
    holds: list[Hold] = []
    for start, stop in spans_of_runs(run):
        part = torque[start:stop]
        turns = turning_points(part, threshold)
        reversals += (turns + start).tolist()
        bounds = [0, *(turns + 1), len(part)]
        for a, b in pairwise(start + np.array(bounds)):
            rising = torque[b - 1] >= torque[max(a - 1, start)]
            sense[a:b] = 1 if rising else -1
            crossing = a + _zero_crossing(torque[a:b], rising)
            loading[a:crossing], loading[crossing:b] = False, True
        holds += _holds(recording, start, stop)
    cuts = np.flatnonzero((np.diff(loading) != 0) | (np.diff(run) != 0)) + 1
    for a, b in pairwise([0, *cuts, n]):
        if b > a:
            direction: Direction = "loading" if loading[a] else "unloading"
            ends = float(torque[a]), float(torque[b - 1])
            branches.append(Branch(int(run[a]), int(a), int(b), direction, *ends))
    return Structure(
        tuple(branches),
        tuple(holds),
        np.array(reversals, dtype=np.int64),
        sense,
        loading,
        np.abs(torque) <= DEAD_ZONE_SHARE * largest,
    )


def spans_of_runs(run: Ints) -> list[tuple[int, int]]:
    """First row of each run, and the first one after it; none of no rows."""
    starts = np.flatnonzero(np.diff(run, prepend=run[:1] - 1)).tolist()
    return list(pairwise([*starts, len(run)]))


def turning_points(values: Floats, threshold: float) -> Ints:
    """Find the extremes between which a signal goes at least `threshold` one way.

    Smaller changes of direction, as noise makes them, are passed over, as in rainflow counting.

    Parameters
    ----------
    values : ndarray of float, shape (n,)
        The signal.
    threshold : float
        Least way back that counts as a change of direction [unit of the signal].

    Returns
    -------
    ndarray of int, shape (k,)
        Indices of the extremes; the first and the last sample are none.

    Examples
    --------
    >>> turning_points(np.array([0.0, 5.0, 4.9, 9.0, 1.0, 1.1, 6.0]), 0.5)
    array([3, 4])
    """
    if len(values) < 3:
        return np.zeros(0, dtype=np.int64)
    moving = np.flatnonzero(np.r_[True, np.diff(values) != 0])
    slope = np.sign(np.diff(values[moving]))
    inner = moving[1:-1][slope[1:] != slope[:-1]]
    candidates = [0, *inner.tolist(), len(values) - 1]
    turns: list[int] = []
    high = low = candidates[0]
    direction = 0
    for index in candidates:
        value = values[index]
        if value > values[high]:
            high = index
        if value < values[low]:
            low = index
        if direction >= 0 and values[high] - value > threshold:
            if direction > 0 or high > low:
                turns.append(high)
            direction, low, high = -1, index, index
        elif direction <= 0 and value - values[low] > threshold:
            if direction < 0 or low > high:
                turns.append(low)
            direction, low, high = 1, index, index
    return np.array([turn for turn in turns if turn > 0], dtype=np.int64)


def _zero_crossing(torque: Floats, rising: bool) -> int:
    """Find the sample from which the magnitude of torque grows.

    The sum of torque turns there, which noise around zero does not shift.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque between two changes of direction [N m].
    rising : bool
        Whether it rises.

    Returns
    -------
    int
        Index into `torque`.
    """
    total = np.cumsum(torque if rising else -torque)
    lowest = int(np.argmin(total))
    return lowest + 1 if total[lowest] < 0 else 0


def _holds(recording: Samples, start: int, stop: int) -> list[Hold]:
    """Find plateaus of at least `HOLD_SAMPLES` samples of equal torque within one run.

    Parameters
    ----------
    recording : Samples
        The samples.
    start, stop : int
        First sample of the run, and the one after its last.

    Returns
    -------
    list of Hold
    """
    torque = recording.torque_nm[start:stop]
    edges = np.flatnonzero(np.r_[True, np.diff(torque) != 0])
    ends = np.r_[edges[1:], len(torque)]
    long = ends - edges >= HOLD_SAMPLES
    time = recording.time_s
    return [
        Hold(
            int(recording.run[start]),
            start + int(a),
            start + int(b),
            float(torque[a]),
            None if time is None else float(time[start + b - 1] - time[start + a]),
        )
        for a, b in zip(edges[long], ends[long], strict=True)
    ]
