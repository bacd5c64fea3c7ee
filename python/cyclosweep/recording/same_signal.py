"""Whether two columns of a file are one signal in two units, or two sensors."""

import numpy as np

from cyclosweep.recording.roles import Named
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.units import find_unit

__all__ = ["same_signal"]

SAME_SIGNAL = 0.999999
"""Correlation beyond which two columns may be one signal in two units."""

SAME_READING = 2e-3
"""Largest distance of their readings then, over the range: both are rounded."""


def same_signal(first: Named, other: Named, numbers: dict[str, Floats]) -> bool:
    """Whether two columns are one signal, which their units tell apart if anything does.

    Two sensors of one torque may follow each other as closely; their readings differ by a gain or
    a zero.

    Parameters
    ----------
    first, other : Named
        The columns.
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.

    Returns
    -------
    bool
    """
    a, b = (_canonical(n, numbers[n.column]) for n in (first, other))
    known = np.isfinite(a) & np.isfinite(b)
    if known.sum() < 3 or not np.ptp(a[known]) or not np.ptp(b[known]):
        return False
    if abs(float(np.corrcoef(a[known], b[known])[0, 1])) <= SAME_SIGNAL:
        return False
    apart = a[known] - b[known]
    if first.role == "time_s":  # whose zero means nothing
        apart = apart - np.median(apart)
    return float(np.abs(apart).max()) <= SAME_READING * float(np.ptp(a[known]))


def _canonical(named: Named, values: Floats) -> Floats:
    """Readings in the canonical unit.

    Parameters
    ----------
    named : Named
        What name and unit of their column say.
    values : ndarray of float, shape (rows,)
        In the file's unit.

    Returns
    -------
    ndarray of float, shape (rows,)
        As they are where no unit is known.
    """
    unit = None if named.unit is None else find_unit(named.unit, named.role)
    return values if unit is None else values * unit.factor + unit.offset
