"""Which points no other point dominates, and a front of them that grows batch by batch."""

from __future__ import annotations

import bisect

import numpy as np
import numpy.typing as npt

__all__ = ["Front", "non_dominated"]

_Reals = npt.NDArray[np.float64]
_Flags = npt.NDArray[np.bool_]

_BLOCK = 2**22
"""Pairs of points compared at a time: 4 MB of flags."""
_GUARDS = 32
"""Points of the front that every new point meets first; they reject most of them."""
_SWEPT = 3
"""Objectives up to which all points are sorted and swept; with more they meet each other."""
_LEAST_WAITING = 20_000
"""New points that are gathered before they meet the whole front."""


def non_dominated(points: _Reals) -> _Flags:
    """Find the points that no other one dominates.

    Parameters
    ----------
    points : ndarray, shape (points, objectives)
        Objectives, less is better; no NaN.

    Returns
    -------
    ndarray of bool, shape (points,)
        True where no other point is at most as great in every objective and smaller in one.
        Equal points do not dominate each other.

    Examples
    --------
    >>> non_dominated(np.array([[1.0, 2.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]])).tolist()
    [True, True, False, True]
    """
    if len(points) == 0:
        return np.zeros(0, bool)
    if points.shape[1] == 1:
        return np.asarray(points[:, 0] == points[:, 0].min())
    unique, place = np.unique(points, axis=0, return_inverse=True)
    find = {2: _staircase, 3: _moving_staircase}.get(points.shape[1], _culled)
    flags = find(unique)
    return flags[place.reshape(-1)]


def _staircase(points: _Reals) -> _Flags:
    """Two objectives: unique points, sorted by the first, that lie below all before them."""
    second = points[:, 1]
    kept = np.ones(len(points), bool)
    kept[1:] = second[1:] < np.minimum.accumulate(second)[:-1]
    return kept


def _moving_staircase(points: _Reals) -> _Flags:
    """Three objectives: unique points, sorted by the first, against the others' staircase so far.

    Kung, Luccio and Preparata, J. ACM 22 (1975): a point is dominated when one before it is at most
    as great in the other two objectives.
    """
    flags = np.zeros(len(points), bool)
    # The second objective rises along the staircase, the third one falls.
    seconds: list[float] = []
    thirds: list[float] = []
    for k, (second, third) in enumerate(points[:, 1:].tolist()):
        place = bisect.bisect_right(seconds, second)
        if place and thirds[place - 1] <= third:
            continue
        flags[k] = True
        first = place
        while first and seconds[first - 1] == second:
            first -= 1
        last = place
        while last < len(thirds) and thirds[last] >= third:
            last += 1
        seconds[first:last] = [second]
        thirds[first:last] = [third]
    return flags


def _culled(points: _Reals) -> _Flags:
    """Four objectives and more: a point can only be dominated by one of a smaller rank sum."""
    ranks = sum(np.unique(column, return_inverse=True)[1] for column in points.T)
    order = np.argsort(ranks, kind="stable")
    flags = np.zeros(len(points), bool)
    kept = points[:0]
    size = 512
    for first in range(0, len(order), size):
        block = order[first : first + size]
        block = block[~_dominated(points[block], kept)]
        block = block[~_dominated(points[block], points[block])]
        flags[block] = True
        kept = np.concatenate([kept, points[block]])
    return flags


def _dominated(points: _Reals, others: _Reals) -> _Flags:
    """Which points any of ``others`` dominates."""
    flags = np.zeros(len(points), bool)
    size = max(1, _BLOCK // max(len(others), 1))
    for first in range(0, len(points) if len(others) else 0, size):
        block = points[first : first + size, None, :]
        not_above = np.ones((block.shape[0], len(others)), bool)
        below = np.zeros_like(not_above)
        for k in range(points.shape[1]):
            not_above &= others[:, k] <= block[:, :, k]
            below |= others[:, k] < block[:, :, k]
        flags[first : first + size] = (not_above & below).any(axis=1)
    return flags


class Front:
    """Points that no other one seen so far dominates, with the numbers of their rows.

    Memory follows the front, not what it has seen.

    Parameters
    ----------
    objectives : int
        Numbers of a point.
    """

    def __init__(self, objectives: int) -> None:
        self._points: _Reals = np.empty((0, objectives))
        self._rows = np.empty(0, np.uint64)
        self._guards = self._points
        self._waiting: list[tuple[_Reals, npt.NDArray[np.uint64]]] = []
        self._waiting_count = 0

    def add(self, points: _Reals, rows: npt.NDArray[np.uint64]) -> None:
        """Take in new points.

        Parameters
        ----------
        points : ndarray, shape (points, objectives)
            Objectives, less is better; no NaN.
        rows : ndarray of uint64, shape (points,)
            What identifies each.
        """
        for guard in self._guards:
            # Column by column: sums over short rows take ten times as long.
            not_below, above = np.ones(len(points), bool), np.zeros(len(points), bool)
            for column, least in zip(points.T, guard, strict=True):
                not_below &= column >= least
                above |= column > least
            left = np.flatnonzero(~(not_below & above))
            if len(left) < len(points):
                points, rows = points[left], rows[left]
        self._waiting.append((points, rows))
        self._waiting_count += len(rows)
        if len(self._guards) == 0 or self._waiting_count >= max(_LEAST_WAITING, len(self._rows)):
            self._merge()

    def result(self) -> tuple[_Reals, npt.NDArray[np.uint64]]:
        """Return the points of the front and their rows, in the order of the rows."""
        self._merge()
        order = np.argsort(self._rows, kind="stable")
        return self._points[order], self._rows[order]

    def _merge(self) -> None:
        if self._waiting_count == 0:
            return
        points = np.concatenate([points for points, _ in self._waiting])
        rows = np.concatenate([rows for _, rows in self._waiting])
        self._waiting, self._waiting_count = [], 0
        if points.shape[1] <= _SWEPT:
            points = np.concatenate([self._points, points])
            rows = np.concatenate([self._rows, rows])
            kept = non_dominated(points)
            self._points, self._rows = points[kept], rows[kept]
        else:
            kept = non_dominated(points)
            points, rows = points[kept], rows[kept]
            kept = ~_dominated(points, self._points)
            points, rows = points[kept], rows[kept]
            left = ~_dominated(self._points, points)
            self._points = np.concatenate([self._points[left], points])
            self._rows = np.concatenate([self._rows[left], rows])
        self._choose_guards()

    def _choose_guards(self) -> None:
        """Spread points of the front, those of small sums and those along the first objective."""
        points = self._points
        low, high = points.min(axis=0), points.max(axis=0)
        with np.errstate(invalid="ignore"):
            share = np.where(high > low, (points - low) / (high - low), 0.0).sum(axis=1)
        half = _GUARDS // 2
        best = np.argsort(share)[:half]
        along = np.argsort(points[:, 0])
        spread = along[np.linspace(0, len(along) - 1, min(half, len(along))).astype(int)]
        self._guards = np.unique(points[np.concatenate([best, spread])], axis=0)
