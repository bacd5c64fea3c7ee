"""Maxwell-slip elements of a friction: presliding distances, and shares of the friction limit."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

ELEMENTS = 14
"""Number of slip elements; the response no longer depends on it beyond about ten."""


@dataclass(frozen=True, slots=True)
class Elements:
    """Slip elements in parallel.

    Attributes
    ----------
    slip_deg : ndarray, shape (k,)
        Presliding distance of each element [deg].
    share : ndarray, shape (k,)
        Share of the friction limit that each carries; together one.
    """

    slip_deg: NDArray[np.float64]
    share: NDArray[np.float64]


@lru_cache(maxsize=256)
def spread_elements(slip_deg: float, scatter: float, skew: float = 0.0) -> Elements:
    """Elements at equally probable quantiles of a distribution of presliding distances.

    Between a lognormal one (no skew) and a power law up to a longest distance, as Segalman found
    for joints (J. Appl. Mech. 72, 2005), or its mirror image down to a shortest one.

    Parameters
    ----------
    slip_deg : float
        Median presliding distance [deg].
    scatter : float
        Standard deviation of its logarithm.
    skew : float
        1: a power law up to a longest distance; 0: lognormal; -1: the mirror image.

    Returns
    -------
    Elements
    """
    from scipy.special import ndtri

    share = (np.arange(ELEMENTS) + 0.5) / ELEMENTS
    tail = 1.0 + np.log(share) if skew > 0 else -1.0 - np.log1p(-share)
    quantile = (1.0 - abs(skew)) * ndtri(share) + abs(skew) * tail
    return Elements(slip_deg * np.exp(scatter * quantile), np.full(ELEMENTS, 1.0 / ELEMENTS))


def elements_of(shape: Mapping[str, float]) -> Elements:
    """Elements of a friction with ``slip_deg`` [deg], ``scatter`` and perhaps ``skew``."""
    return spread_elements(
        float(shape["slip_deg"]), float(shape["scatter"]), float(shape.get("skew", 0.0))
    )
