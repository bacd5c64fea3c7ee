"""What one row says of the mean: its score under heavy tails and on a coarse dial."""

import numpy as np
from scipy.special import ndtr

from cyclosweep.recording.robust import rounding_sigma
from cyclosweep.simulation.effects.history import Floats


def with_rounding(sigma_deg: float, step_deg: float) -> float:
    """Standard deviation of noise and of rounding to steps together [deg].

    Parameters
    ----------
    sigma_deg : float
        Standard deviation before rounding [deg].
    step_deg : float
        Step of the reading; zero: not rounded [deg].

    Returns
    -------
    float
    """
    return float(np.hypot(sigma_deg, rounding_sigma(step_deg)))


def _squared_scale(tail: float) -> float:
    """Square of the scale at which Student's distribution of this tail has unit variance."""
    return (tail - 2.0) / tail if tail > 2.05 else 0.09


def student_score(white: Floats, tail: float) -> tuple[Floats, Floats]:
    """Score of rows of unit variance under Student's distribution, and its slope.

    Parameters
    ----------
    white : ndarray, shape (n,)
    tail : float
        Degrees of freedom of the distribution.

    Returns
    -------
    score, slope : ndarray, shape (n,)
    """
    scale2 = _squared_scale(tail)
    spread = tail * scale2 + white**2
    score = (tail + 1.0) * white / spread
    return score, (tail + 1.0) * (tail * scale2 - white**2) / spread**2


def student_deviance(white: Floats, tail: float) -> tuple[Floats, Floats]:
    """Signed root of twice the loss of log likelihood under Student's distribution, and its slope.

    Near zero it is like the score; far off it goes on growing.

    Parameters
    ----------
    white : ndarray, shape (n,)
        Rows of unit variance.
    tail : float
        Degrees of freedom of the distribution.

    Returns
    -------
    deviance, slope : ndarray, shape (n,)
    """
    scale2 = _squared_scale(tail)
    root = np.sqrt((tail + 1.0) * np.log1p(white**2 / (tail * scale2)))
    score = student_score(white, tail)[0]
    slope = np.divide(np.abs(score), root, out=np.ones_like(root), where=root > 1e-12)
    return np.sign(white) * root, slope


def interval_score(angle: Floats, mean: Floats, sigma: float, step: float) -> tuple[Floats, Floats]:
    """Score and expected information of the mean of a reading rounded to a step.

    Parameters
    ----------
    angle, mean : ndarray, shape (n,)
        Reading and mean [deg].
    sigma : float
        Standard deviation before rounding [deg].
    step : float
        Step of the reading [deg].

    Returns
    -------
    score : ndarray, shape (n,)
        Derivative of the log likelihood by the mean [1/deg].
    information : ndarray, shape (n,)
        Mean square of the score [1/deg^2].
    """
    centre = angle - mean
    score = bin_score(centre, sigma, step)[0]
    nearest = mean - np.round((mean - angle) / step) * step - angle
    information = np.zeros_like(mean)
    for k in (-2, -1, 0, 1, 2):
        value, probability = bin_score(-nearest + k * step, sigma, step)
        information += value**2 * probability
    return score, information


def bin_score(centre: Floats, sigma: float, step: float) -> tuple[Floats, Floats]:
    """Derivative of the log-probability of a bin by the mean, and the probability itself.

    Parameters
    ----------
    centre : ndarray, shape (n,)
        Centre of the bin less the mean [deg].
    sigma : float
        Standard deviation [deg].
    step : float
        Width of the bin [deg].

    Returns
    -------
    score : ndarray, shape (n,)
        In 1/deg.
    probability : ndarray, shape (n,)
    """
    low, high = (centre - step / 2) / sigma, (centre + step / 2) / sigma
    flip = low > 0
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    probability = ndtr(high) - ndtr(low)
    density = np.exp(-0.5 * low**2) - np.exp(-0.5 * high**2)
    safe = np.maximum(probability, 1e-300)
    score = density / np.sqrt(2 * np.pi) / safe / sigma
    # Far in the tail the ratio tends to the distance of the nearer edge.
    score = np.where(probability < 1e-280, high / sigma, score)
    return np.where(flip, -score, score), probability
