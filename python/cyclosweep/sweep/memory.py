"""Memory of tables that are gone, kept for the next ones.

The operating system clears every page before it hands it out; for a table of the published model
that takes nearly half of the time. A block goes back to the pool when the last view of it is gone,
whoever holds it: the frame, a column, an array made from one.
"""

from __future__ import annotations

import weakref
from collections import deque

import numpy as np
import numpy.typing as npt

__all__ = ["MOST_KEPT", "take"]

MOST_KEPT = 2**29
"""Most bytes kept for later: a table of a million variants with every column, and its inputs."""

_LEAST = 2**20
"""Bytes below which the allocator of NumPy keeps memory by itself."""

_free: deque[npt.NDArray[np.float64]] = deque()


def take(count: int) -> npt.NDArray[np.float64]:
    """Memory for some numbers, whatever is in it.

    Parameters
    ----------
    count : int
        How many.

    Returns
    -------
    ndarray, shape (count,)
    """
    if 8 * count < _LEAST:
        return np.empty(count)
    block = _kept(count)
    if block is None:
        # NumPy asks for huge pages.
        block = np.empty(count)
    # An array whose memory is not an array's: every view of it keeps it, and it alone.
    lent = np.frombuffer(block.data)[:count].view()
    owner = lent.base
    assert owner is not None
    weakref.finalize(owner, _give_back, block).atexit = False
    return lent


def _kept(count: int) -> npt.NDArray[np.float64] | None:
    """A free block that is large enough and at most twice as large; taken out of the pool."""
    for _ in range(len(_free)):
        try:
            block = _free.popleft()
        except IndexError:
            return None
        if count <= block.size <= 2 * count:
            return block
        _free.append(block)
    return None


def _give_back(block: npt.NDArray[np.float64]) -> None:
    """Keep a block; the oldest ones go when there are too many."""
    if block.nbytes > MOST_KEPT:
        return
    _free.append(block)
    while sum(kept.nbytes for kept in tuple(_free)) > MOST_KEPT:
        try:
            _free.popleft()
        except IndexError:
            return
