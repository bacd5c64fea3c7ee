"""Autocorrelated noise beside a white part, as a reading has whose zero wanders slowly."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.optimize import brentq, minimize_scalar

from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.simulation.effects.history import Floats

LARGEST = 0.998
"""Largest autocorrelation that is tried."""
MUCH_LIKELIER = 3.0
"""Log likelihood by which two parts must be ahead of one [nat]."""
SHARES = (0.3, 0.6, 0.85, 0.95)
FIRST = ((0.4, 0.15), *((near, share) for near in (0.7, 0.9, 0.97, 0.99) for share in SHARES))
"""Ways from the autocorrelation of one part to one, and white shares, of which one has to be
likelier than one part alone before the likeliest are looked for."""
LEAST_WHITE = 0.2
"""Share of the variance that a white part of any size has at least. Less beside something slow is
what an effect leaves that no shape holds."""
MOST_SLOWER = 4.0
"""Largest variance of the slow part beside it, in those of the likeliest one: of a few of its waves
it is hardly known, and one far larger than what is seen would hide every effect."""
LEAST_ROWS = 100
"""Rows below which two parts of the noise are not told apart."""
MOST_TIMES = 300.0
"""Largest variance that is tried, in variances of a known white part."""
LOG_ODDS = 7.0
"""Largest and, negative, least logarithm of the odds of a white part that are tried."""

Best = Callable[[float], tuple[float, float]]
"""Largest log likelihood [nat] at an autocorrelation, and the share of the white part there."""


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
    if not _can_be_told(rough):
        return None
    rows = np.column_stack([basis, left])

    def best(correlation: float) -> tuple[float, float]:
        return _best_of_known(rows, rough, correlation, white_deg**2)

    return _with_white_share(rough, best, _of_one_part(rows, rough) + least_gain)


def noise_with_free_white_part(left: Floats, basis: Floats, rough: Noise) -> Noise | None:
    """Noise of a white part of any size beside a correlated one; None where that is no likelier.

    A sensor's noise is white as a rule, and its zero wanders slowly. A first-order autoregression
    has one autocorrelation for both, too low for the slow part, which then looks like an effect.

    Parameters
    ----------
    left : ndarray, shape (n,)
        What the basis leaves of the twist, without outliers [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    rough : Noise
        Estimate without a white part.

    Returns
    -------
    Noise or None
        ``rough`` with the share of the white part and the autocorrelation of the rest.
    """
    if not _can_be_told(rough):
        return None
    rows = np.column_stack([basis, left])
    single = rough.best_correlation
    one = _of_one_part(rows, rough)
    tried = (
        replace(rough, correlation=single + way * (1.0 - single), white_share=share)
        for way, share in FIRST
    )
    if not any(_restricted(rows, noise)[0] > one for noise in tried):
        return None
    found = _with_white_share(
        rough,
        lambda rho: _best_of_any(rows, rough, rho),
        one + MUCH_LIKELIER,
        MOST_SLOWER,
    )
    return found if found is not None and found.likely_white_share > LEAST_WHITE else None


def _of_one_part(rows: Floats, rough: Noise) -> float:
    """Restricted log likelihood of noise without a white part.

    Parameters
    ----------
    rows : ndarray, shape (n, k + 1)
        Columns of the model and what they leave [deg].
    rough : Noise
        Its estimate.

    Returns
    -------
    float
        In nat.
    """
    return _restricted(rows, replace(rough, correlation=rough.best_correlation))[0]


def _can_be_told(noise: Noise) -> bool:
    """Whether two parts of a noise can be told apart."""
    return len(noise.gap) >= LEAST_ROWS and bool(np.any(noise.gap > 0))


def _with_white_share(
    rough: Noise,
    best_at: Best,
    least: float,
    most_times: float = np.inf,
) -> Noise | None:
    """Noise of the likeliest autocorrelation, and of an upper one; None where it gains too little.

    Parameters
    ----------
    rough : Noise
        Estimate without a white part.
    best_at : callable
        What is reached at an autocorrelation.
    least : float
        Log likelihood that must be reached [nat].
    most_times : float
        Largest variance of the part that correlates, in those of the likeliest autocorrelation.

    Returns
    -------
    Noise or None
    """
    found: dict[float, tuple[float, float]] = {}

    def value(correlation: float) -> float:
        if correlation not in found:
            found[correlation] = best_at(correlation)
        return found[correlation][0]

    peak = minimize_scalar(
        lambda a: -value(float(np.tanh(a))),
        bounds=(0.0, np.arctanh(LARGEST)),
        method="bounded",
        options={"xatol": 0.02},
    )
    best = float(np.tanh(peak.x))
    if value(best) < least:
        return None
    # The higher it is, the dearer an underestimate.
    allowed = value(best) - (1.0 + 2.0 * best**2)
    upper = min(LARGEST, float(np.sqrt(1.0 - (1.0 - best**2) / most_times)))
    if value(upper) < allowed:
        upper = float(brentq(lambda rho: value(float(rho)) - allowed, best, upper, xtol=5e-4))
        value(upper)
    return replace(rough, correlation=upper, best_correlation=best, white_share=found[upper][1])


def _best_of_any(rows: Floats, rough: Noise, correlation: float) -> tuple[float, float]:
    """Largest restricted log likelihood [nat] at an autocorrelation, and the white share there.

    Parameters
    ----------
    rows : ndarray, shape (n, k + 1)
        Columns of the model and what they leave [deg].
    rough : Noise
        Says how steps from row to row count.
    correlation : float
        Of the part that is not white.

    Returns
    -------
    value, share : float
    """

    def share(log_odds: float) -> float:
        return float(1.0 / (1.0 + np.exp(-log_odds)))

    def loss(log_odds: float) -> float:
        noise = replace(rough, correlation=correlation, white_share=share(log_odds))
        return -_restricted(rows, noise)[0]

    least = minimize_scalar(
        loss, bounds=(-LOG_ODDS, LOG_ODDS), method="bounded", options={"xatol": 0.2}
    )
    return -float(least.fun), share(least.x)


def _best_of_known(
    rows: Floats, rough: Noise, correlation: float, white: float
) -> tuple[float, float]:
    """The same where the variance of the white part is known.

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
    value, share : float
    """

    def loss(log_times: float) -> float:
        times = float(np.exp(log_times))
        noise = replace(rough, correlation=correlation, white_share=1.0 / times)
        return -_restricted(rows, noise, white * times)[0]

    least = minimize_scalar(
        loss, bounds=(0.02, np.log(MOST_TIMES)), method="bounded", options={"xatol": 0.02}
    )
    return -float(least.fun), float(np.exp(-least.x))


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
