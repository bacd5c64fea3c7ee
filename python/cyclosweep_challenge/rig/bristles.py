"""Friction as some forty bristles, each dragged along by the shaft until it slips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

COUNT = 40


@dataclass(frozen=True)
class Bristles:
    """A bundle of Jenkins elements whose slip distances follow Segalman's power law.

    Attributes
    ----------
    share : array, shape (COUNT,)
        Share of the bundle's friction carried by each bristle; sums to one [-].
    slip_distance_deg : array, shape (COUNT,)
        Input angle a bristle bends before it slips [deg].

    Notes
    -----
    The density of slip distances is proportional to ``distance**chi`` up to the macro-slip
    distance; all bristles are about equally stiff, so that the share of one is proportional
    to its slip distance [1]_.

    References
    ----------
    .. [1] D. J. Segalman, "A four-parameter Iwan model for lap-type joints," J. Appl. Mech.,
       vol. 72, no. 5, pp. 752-760, 2005, doi: 10.1115/1.1989354.
    """

    share: Array
    slip_distance_deg: Array

    @classmethod
    def draw(cls, rng: np.random.Generator, shortest: float, longest: float) -> Bristles:
        """Draw a bundle of exponent chi in -0.7..0.3; macro-slip between two angles [deg]."""
        chi = rng.uniform(-0.7, 0.3)
        longest = np.exp(rng.uniform(np.log(shortest), np.log(longest)))
        rank = (np.arange(COUNT) + rng.uniform(0.1, 0.9, COUNT)) / COUNT
        distance = longest * rank ** (1.0 / (chi + 1.0))
        distance = np.maximum(distance, 0.01 * longest)
        share = distance * np.exp(rng.normal(0.0, 0.25, COUNT))
        return cls(share / share.sum(), distance)
