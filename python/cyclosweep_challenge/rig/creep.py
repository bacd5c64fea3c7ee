"""Delayed elasticity: a chain of Kelvin-Voigt cells integrated in time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CreepChain:
    """Cells in series, each a spring beside a dashpot.

    Attributes
    ----------
    retardation_s : array, shape (K,)
        Time in which a cell follows its load [s].
    share : array, shape (K,)
        Share of the final delayed twist in each cell; sums to one [-].
    """

    retardation_s: Array
    share: Array

    @classmethod
    def draw(cls, rng: np.random.Generator) -> CreepChain:
        """Draw five cells between some seconds and a quarter of an hour."""
        shortest = np.exp(rng.uniform(np.log(6.0), np.log(30.0)))
        longest = np.exp(rng.uniform(np.log(150.0), np.log(900.0)))
        return cls(np.geomspace(shortest, longest, 5), rng.dirichlet(np.full(5, 1.5)))

    def step(self, lapse_s: float, final_deg: float) -> tuple[Array, Array, Array]:
        """Return what carries one step: decay, and weights of the loads at its two ends.

        The load is taken as linear in time over the step, for which the cell's equation has
        this exact solution. ``final_deg`` is the delayed twist at rated torque [deg]; the
        weights are in deg/(N m).
        """
        ratio = max(lapse_s, 1e-9) / self.retardation_s
        decay = np.exp(-ratio)
        settled = -np.expm1(-ratio) / ratio
        size = final_deg * self.share / RATED_INPUT_TORQUE_NM
        return decay, size * (settled - decay), size * (1.0 - settled)
