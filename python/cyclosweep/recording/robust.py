"""Sizes of noise that a few readings far off hardly change."""

import numpy as np

from cyclosweep.recording.samples import Floats

MAD_TO_SIGMA = 1.4826
"""Standard deviation of normal noise over the median of its absolute values."""


def robust_sigma(noise: Floats) -> float:
    """Standard deviation of noise about zero, by the median of its absolute values.

    Parameters
    ----------
    noise : ndarray, shape (n,)
        At least one value.

    Returns
    -------
    float
        In the unit of the values.
    """
    return MAD_TO_SIGMA * float(np.median(np.abs(noise)))


def sigma_by_second_differences(readings: Floats) -> float:
    """Standard deviation of independent noise that rides on a smooth course.

    Parameters
    ----------
    readings : ndarray, shape (n,)
        Readings in the order in which they were taken, at least three.

    Returns
    -------
    float
        In the unit of the readings; second differences of independent noise have six times its
        variance.
    """
    return robust_sigma(np.diff(readings, 2)) / float(np.sqrt(6.0))


def rounding_sigma(step: float) -> float:
    """Standard deviation of what rounding to steps changes, in the unit of the step."""
    return step / float(np.sqrt(12.0))
