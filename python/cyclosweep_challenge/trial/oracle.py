"""Test that knows the signature of the effect; the reference for the power of other tests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]


def oracle_statistic(
    direction: Array,
    clean_deg: Array,
    read_deg: Array,
    programme: Programme,
    noise: Noise,
    compliance_deg_per_nm: float,
) -> float:
    """Score statistic along a known signature: standard normal with nothing missing, mean d else.

    Parameters
    ----------
    direction : array, shape (N,)
        Whitened, projected signature of unit norm.
    clean_deg, read_deg : array, shape (N,)
        True angle without the effect, and the reading [deg].
    programme, noise, compliance_deg_per_nm
        What was recorded, the true noise and the specimen's compliance [deg/(N m)].
    """
    score = noise.score(clean_deg, read_deg, programme, compliance_deg_per_nm)
    return float(direction @ score / np.sqrt(noise.information()))


def oracle_power(d: Array | float, level: float = 0.01) -> Array:
    """Power of the two-sided test that knows the signature but not its sign [-].

    Examples
    --------
    >>> round(float(oracle_power(3.86)), 2)
    0.9
    """
    bound = stats.norm.isf(0.5 * level)
    shifted = np.asarray(d, dtype=float)
    return np.asarray(stats.norm.sf(bound - shifted) + stats.norm.cdf(-bound - shifted))


def oracle_d(power: float = 0.9, level: float = 0.01) -> float:
    """Signal-to-noise at which that test reaches a power [-]."""
    return float(stats.norm.isf(0.5 * level) + stats.norm.ppf(power))
