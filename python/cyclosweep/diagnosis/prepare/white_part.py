"""Autocorrelated noise beside a white part of known size, as the rounding of a dial has."""

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.simulation.effects.history import Floats

LARGEST = 0.998
"""Largest autocorrelation that is tried."""
MUCH_LIKELIER = 3.0
"""Log likelihood by which rounding beside correlated noise must be ahead of none [nat]; rounding is
white nearly, and not always."""
LEAST_ROWS = 100
"""Rows below which two parts of the noise are not told apart."""
MOST_TIMES = 300.0
"""Largest variance that is tried, in variances of the white part."""


def noise_with_white_part(
    left: Floats, basis: Floats, rough: Noise, white_deg: float, least_gain: float = MUCH_LIKELIER
) -> Noise | None:
    """Noise of a known white part beside a correlated one; None where that is no likelier.

    Rounding of a dial and noise of the torque are new in every row. Taken as part of a first-order
    autoregression they lower the estimated autocorrelation of all, and slow noise then looks like
    an effect. Their variance is known (that of rounding is a twelfth of the squared step), so that
    nothing else can be taken for them.

    Parameters
    ----------
    left : ndarray, shape (n,)
        What the basis leaves of the twist, without outliers [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    rough : Noise
        Estimate without a white part.
    white_deg : float
        Standard deviation of the white part [deg].
    least_gain : float
        Log likelihood by which it must be ahead of none [nat].

    Returns
    -------
    Noise or None
        ``rough`` with the share of the white part and the autocorrelation of the rest.
    """
    if len(left) < LEAST_ROWS or not np.any(rough.gap > 0):
        return None
    rows = np.column_stack([basis, left])
    white = white_deg**2
    found: dict[float, tuple[float, float]] = {}

    def value(correlation: float) -> float:
        found[correlation] = _best_variance(rows, rough, correlation, white)
        return found[correlation][0]

    peak = minimize_scalar(
        lambda a: -value(float(np.tanh(a))),
        bounds=(0.0, np.arctanh(LARGEST)),
        method="bounded",
        options={"xatol": 0.02},
    )
    best = float(np.tanh(peak.x))
    plain = replace(rough, correlation=rough.best_correlation)
    if value(best) < _restricted(rows, plain)[0] + least_gain:
        return None
    # The higher it is, the dearer an underestimate.
    allowed = value(best) - (1.0 + 2.0 * best**2)
    upper = LARGEST
    if value(LARGEST) < allowed:
        upper = float(brentq(lambda rho: value(float(rho)) - allowed, best, LARGEST, xtol=5e-4))
        value(upper)
    share = white / found[upper][1]
    return replace(rough, correlation=upper, best_correlation=best, white_share=share)


def _best_variance(
    rows: Floats, rough: Noise, correlation: float, white: float
) -> tuple[float, float]:
    """Largest restricted log likelihood [nat] at an autocorrelation, and the variance there.

    Parameters
    ----------
    rows : ndarray, shape (n, k + 1)
        Columns of the model and what they leave [deg].
    rough : Noise
        Says how steps from row to row count.
    correlation : float
        Of the part that is not white.
    white : float
        Variance of the white part [deg^2].

    Returns
    -------
    value, variance : float
        In nat and deg^2.
    """

    def loss(log_times: float) -> float:
        times = float(np.exp(log_times))
        noise = replace(rough, correlation=correlation, white_share=1.0 / times)
        return -_restricted(rows, noise, white * times)[0]

    least = minimize_scalar(
        loss, bounds=(0.02, np.log(MOST_TIMES)), method="bounded", options={"xatol": 0.02}
    )
    return -float(least.fun), white * float(np.exp(least.x))


def _restricted(rows: Floats, noise: Noise, variance: float | None = None) -> tuple[float, float]:
    """Restricted log likelihood [nat] of a variance of the noise, and the variance [deg^2].

    Parameters
    ----------
    rows : ndarray, shape (n, k + 1)
        Columns of the model and what they leave [deg].
    noise : Noise
        Correlation and white share.
    variance : float, optional
        Of a row [deg^2]; default: the likeliest.

    Returns
    -------
    value, variance : float
    """
    white = noise.whiten(rows)
    gram = white.T @ white
    inner, edge = gram[:-1, :-1], gram[:-1, -1]
    rest = max(float(gram[-1, -1] - edge @ np.linalg.solve(inner, edge)), 1e-300)
    freedom = len(rows) - len(edge)
    size = rest / freedom if variance is None else variance
    spread = noise.log_determinant + float(np.linalg.slogdet(inner)[1])
    return -0.5 * (spread + freedom * float(np.log(size)) + rest / size), size
