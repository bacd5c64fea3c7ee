"""Intervals for shares and means, exact where that is possible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import stats


@dataclass(frozen=True)
class Estimate:
    """A figure with its 95 % interval.

    Attributes
    ----------
    value, low, high : float
        Estimate and bounds; not-a-number where there is nothing to estimate from.
    count : int
        Cases it rests on.
    """

    value: float
    low: float
    high: float
    count: int


NOTHING = Estimate(float("nan"), float("nan"), float("nan"), 0)


def share(hits: int, count: int, level: float = 0.95) -> Estimate:
    """Share with its exact two-sided interval [1]_.

    References
    ----------
    .. [1] C. J. Clopper and E. S. Pearson, "The use of confidence or fiducial limits illustrated
       in the case of the binomial," Biometrika, vol. 26, no. 4, pp. 404-413, 1934,
       doi: 10.1093/biomet/26.4.404.

    Examples
    --------
    >>> share(0, 1000).high < 0.0037
    True
    """
    if count == 0:
        return NOTHING
    tail = 0.5 * (1.0 - level)
    low = 0.0 if hits == 0 else float(stats.beta.ppf(tail, hits, count - hits + 1))
    high = 1.0 if hits == count else float(stats.beta.isf(tail, hits + 1, count - hits))
    return Estimate(hits / count, low, high, count)


def share_of(flags: ArrayLike) -> Estimate:
    """Share of true flags with its exact interval."""
    table = np.asarray(flags, dtype=bool)
    return share(int(table.sum()), int(table.size))


def together(estimates: Sequence[Estimate]) -> Estimate:
    """Mean of independent estimates of one quantity, each weighted by its precision.

    The variance of each is read from its 95 % interval, as if that were symmetric and normal.

    Examples
    --------
    >>> both = together([Estimate(0.1, 0.0, 0.2, 50), Estimate(0.2, 0.1, 0.3, 50)])
    >>> round(both.value, 3), round(both.low, 3), both.count
    (0.15, 0.079, 100)
    """
    weights = np.array([max(e.high - e.low, 1e-9) ** -2 for e in estimates])
    value = float(np.average([e.value for e in estimates], weights=weights))
    half = 0.5 / float(np.sqrt(weights.sum()))
    return Estimate(value, value - half, value + half, sum(e.count for e in estimates))


def _summary(table: NDArray[np.float64], statistic: str) -> float:
    """Mean, median, root mean square or 95th percentile of a sample."""
    if statistic == "late":
        return float(np.quantile(table, 0.95))
    if statistic == "rms":
        return float(np.sqrt(np.mean(table**2)))
    return float(np.median(table) if statistic == "median" else np.mean(table))


def bootstrapped(values: ArrayLike, statistic: str = "mean", draws: int = 2000) -> Estimate:
    """Mean, median, rms or 95th percentile ("late") with a percentile bootstrap interval."""
    table = np.asarray(values, dtype=float)
    table = table[np.isfinite(table)]
    if table.size == 0:
        return NOTHING
    value = _summary(table, statistic)
    rng = np.random.default_rng(12345)
    drawn = [
        _summary(table[rng.integers(0, table.size, table.size)], statistic)
        for _ in range(draws if table.size > 1 else 1)
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Estimate(value, float(low), float(high), int(table.size))
