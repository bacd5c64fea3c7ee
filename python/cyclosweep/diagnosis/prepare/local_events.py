"""Stretches of a few runs that are far off everything else: events, which are no noise.

A joint that slips once, a cable that catches or a glitch of the reading moves a few dozen rows of
one run by many times the noise. Taken for noise, they make it look large, slow and heavy-tailed,
and hide both themselves and all the rest.
"""

import numpy as np

from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Flags, Floats, Ints

BLOCK = 8
"""Consecutive rows whose median is compared: fewer than half of them may be outliers by chance."""
FAR = 8.0
"""Medians of blocks are far off beyond this many of their own standard deviations."""
EDGE = 4.0
"""The same for the blocks beside them, which hold an end of the event."""
FEWEST_RUNS = 4
"""Runs from which those that are like each other tell which one is not."""
MOST_RUNS = 0.25
"""Share of the runs up to which a departure is an event rather than physics of every run."""
MOST_ROWS = 0.1
"""The same of the rows."""
ROUNDS = 4
"""Times the basis is fitted again to the rows that are left."""


def event_rows(angle: Floats, basis: Floats, run: Ints) -> Flags:
    """Rows of events.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Columns flexible enough to leave hardly anything but noise and events.
    run : ndarray of int, shape (n,)
        Run of each row; rows of one run follow each other.

    Returns
    -------
    ndarray of bool, shape (n,)
        None where departures are spread over more runs or rows than events can be.
    """
    none = np.zeros(len(angle), dtype=bool)
    if len(np.unique(run)) < FEWEST_RUNS:
        return none
    block = _blocks(run)
    left = angle - basis @ (basis.T @ angle)
    found = none
    for _ in range(ROUNDS if basis.shape[1] else 1):
        median = _medians(left, block)
        apart = np.abs(median - np.median(median))
        apart /= max(robust_sigma(apart), 1e-300)
        far = apart > FAR
        beside = np.r_[far[1:], False] | np.r_[False, far[:-1]]
        now = (far | (beside & (apart > EDGE)))[block]
        if np.array_equal(now, found):
            break
        found = now
        if not found.any() or np.mean(found) > MOST_ROWS:
            return none
        if len(np.unique(run[found])) > MOST_RUNS * len(np.unique(run)):
            return none
        kept = ~found
        left = angle - basis @ np.linalg.lstsq(basis[kept], angle[kept], rcond=1e-6)[0]
    return found


def _blocks(run: Ints) -> Ints:
    """Number of the block of each row; no block holds rows of two runs.

    Parameters
    ----------
    run : ndarray of int, shape (n,)
        Run of each row.

    Returns
    -------
    ndarray of int, shape (n,)
    """
    begins = np.flatnonzero(np.r_[True, np.diff(run) != 0])
    place = np.arange(len(run)) - np.repeat(begins, np.diff(np.r_[begins, len(run)]))
    new = place % BLOCK == 0
    return np.cumsum(new) - 1


def _medians(left: Floats, block: Ints) -> Floats:
    """Median of each block.

    Parameters
    ----------
    left : ndarray, shape (n,)
        What the basis leaves [deg].
    block : ndarray of int, shape (n,)
        Number of the block of each row.

    Returns
    -------
    ndarray, shape (blocks,)
        In deg.
    """
    ends = np.flatnonzero(np.diff(block)) + 1
    return np.array([np.median(part) for part in np.split(left, ends)])
