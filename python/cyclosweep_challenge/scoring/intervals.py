"""Intervals for shares and means, exact where that is possible."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

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


@lru_cache(maxsize=4096)
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
    interval = stats.binomtest(hits, count).proportion_ci(level, "exact")
    return Estimate(hits / count, float(interval.low), float(interval.high), count)


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


def _rms(table: NDArray[np.float64], axis: int = -1) -> NDArray[np.float64]:
    """Root mean square along an axis."""
    return np.asarray(np.sqrt(np.mean(table**2, axis=axis)))


def _late(table: NDArray[np.float64], axis: int = -1) -> NDArray[np.float64]:
    """95th percentile along an axis."""
    return np.asarray(np.quantile(table, 0.95, axis=axis))


STATISTICS: dict[str, Callable[..., Any]] = {
    "mean": np.mean,
    "median": np.median,
    "rms": _rms,
    "late": _late,
}
"""Summaries of a sample that have a bootstrap interval; ``late`` is the 95th percentile."""
BATCH = 200_000
"""Values of resamples that are held at a time."""


def bootstrapped(values: ArrayLike, statistic: str = "mean", draws: int = 2000) -> Estimate:
    """Summary of a sample with its 95 % interval by the percentile bootstrap.

    Parameters
    ----------
    values : array_like
        The sample; what is not finite is left out.
    statistic : {"mean", "median", "rms", "late"}
        Summary, of ``STATISTICS``.
    draws : int
        Resamples.
    """
    table = np.asarray(values, dtype=float)
    table = table[np.isfinite(table)]
    if table.size == 0:
        return NOTHING
    summary = STATISTICS[statistic]
    value = float(summary(table))
    if table.size == 1:
        return Estimate(value, value, value, 1)
    interval = stats.bootstrap(
        (table,),
        summary,
        vectorized=True,
        n_resamples=draws,
        batch=max(1, BATCH // table.size),
        method="percentile",
        rng=np.random.default_rng(12345),
    ).confidence_interval
    return Estimate(value, float(interval.low), float(interval.high), int(table.size))
