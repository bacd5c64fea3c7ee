"""Whether what a flexible model leaves is as large everywhere, and white once it is whitened."""

import numpy as np

from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Floats

LOUDEST = 2
"""Loudest stretches that do not count: readings far off, as two within the play, are no model error
of all the rest."""
RIDING = -0.35
"""Correlation of neighbouring whitened rows below which what is left is white noise that rides on
something else, such as a zero that jumps. Whitening leaves none of an autoregression, and nearly
-1/2 of white noise beside something much slower. Of 515 recordings with nothing missing and an
autocorrelation of 0.9 to 0.99, none of over a hundred rows went below -0.30."""
SLOW = 0.8
"""Autocorrelation from which the correlation of whitened neighbours is compared with `RIDING`."""
FEWEST_ROWS = 100
"""Rows from which that correlation is known well enough, to 0.1."""
STRETCHES = 40
"""Stretches whose sizes are compared."""


def unsteadiness(white: Floats, *, loud_only: bool = False) -> float:
    """Scatter of the size of most stretches over that of steady noise; zero for few rows.

    Parameters
    ----------
    white : ndarray, shape (n,)
        Whitened residual.
    loud_only : bool
        Only stretches louder than the median count, as where a dial hides the noise of readings
        at a held torque.

    Returns
    -------
    float
    """
    length = len(white) // STRETCHES
    if length < 5:
        return 0.0
    size = np.abs(white[: STRETCHES * length].reshape(STRETCHES, length)).mean(axis=1)
    expected = np.sqrt((np.pi / 2.0 - 1.0) / length)
    log_size = np.log(np.maximum(np.sort(size)[:-LOUDEST], 1e-300))
    scatter = np.std(log_size)
    if loud_only:
        louder = np.maximum(log_size - np.median(log_size), 0.0)
        scatter = np.sqrt(2.0 * np.mean(louder**2))
    return float(scatter / expected)


def rides(noise: Noise, white: Floats) -> bool:
    """Whether what is left is white noise that rides on something much slower and larger.

    Parameters
    ----------
    noise : Noise
        What is left, described as noise.
    white : ndarray, shape (n,)
        The same, whitened by it.

    Returns
    -------
    bool
    """
    known = noise.best_correlation > SLOW and len(white) >= FEWEST_ROWS
    return known and _neighbours(white, noise.gap) < RIDING


def _neighbours(white: Floats, gap: Floats) -> float:
    """Correlation of neighbouring whitened rows; a few that are far off count as three sizes.

    Parameters
    ----------
    white : ndarray, shape (n,)
        Whitened residual.
    gap : ndarray, shape (n,)
        Steps since the row before, zero where unrelated.

    Returns
    -------
    float
    """
    limit = 3.0 * robust_sigma(white)
    clipped = np.clip(white, -limit, limit)
    near = np.flatnonzero(gap > 0)
    total = float(clipped @ clipped)
    return float(clipped[near] @ clipped[near - 1]) / total if total > 0 else 0.0
