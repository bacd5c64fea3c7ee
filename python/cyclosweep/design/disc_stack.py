"""Where the discs of a drive stand along its axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations

__all__ = ["overlaps"]


def overlaps(middles_mm: Sequence[float], width_mm: float) -> Iterator[tuple[int, int, float]]:
    """Find discs that stand in one another.

    Parameters
    ----------
    middles_mm : sequence of float
        Middle of each disc along the axis [mm].
    width_mm : float
        Width of a disc [mm].

    Yields
    ------
    first, second : int
        Numbers of two discs, from 1.
    apart_mm : float
        Distance of their middles, less than the width [mm].
    """
    for (first, here), (second, there) in combinations(enumerate(middles_mm, 1), 2):
        apart = abs(there - here)
        if apart < width_mm:
            yield first, second, apart
