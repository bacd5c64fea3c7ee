"""Fewer samples for display, extremes kept."""

import numpy as np
from numpy.typing import NDArray

DISPLAY_LIMIT = 5000
"""Most samples that a figure draws."""


def thin(n: int, key: NDArray[np.float64], limit: int = DISPLAY_LIMIT) -> NDArray[np.int64]:
    """Choose samples to draw: of every stretch the one with the least and the largest `key`.

    Parameters
    ----------
    n : int
        Number of samples.
    key : ndarray of float, shape (n,)
        Signal whose extremes must survive, such as the residual.
    limit : int
        Most samples to keep.

    Returns
    -------
    ndarray of int
        Indices in rising order; all of them where `n` is within the limit.

    Examples
    --------
    >>> thin(9, np.array([0.0, 0, 0, 7, 0, 0, 0, -3, 0]), limit=4).tolist()
    [0, 3, 7, 8]
    """
    if n <= limit:
        return np.arange(n)
    edges = np.linspace(0, n, limit // 2 + 1).astype(np.int64)
    starts = edges[:-1]
    label = np.repeat(np.arange(len(starts)), np.diff(edges))
    order = np.lexsort((key, label))
    return np.unique(np.r_[order[starts], order[edges[1:] - 1]])
