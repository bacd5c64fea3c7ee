"""The flange joint: bolts of scattered preload that let go one by one above a load."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Joint:
    """Preloaded joint in series with the shaft.

    Attributes
    ----------
    separation_nm : array, shape (B,)
        Input torque at which each bolt's preload is used up [N m].
    """

    separation_nm: Array

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Joint:
        """Draw a joint that starts to open between 1.7 and 3 times rated torque."""
        centre = rng.uniform(1.7, 3.0) * RATED_INPUT_TORQUE_NM
        return cls(np.sort(centre * (1.0 + rng.normal(0.0, 0.08, 6))))

    def twist(self, torque_nm: Array, opening_deg: float) -> Array:
        """Twist of the opened joint [deg] for a transmitted torque not below zero [N m].

        ``opening_deg`` is the added twist per rated torque once every bolt has let go [deg].
        """
        over = np.maximum(torque_nm[..., None] - self.separation_nm, 0.0)
        return np.asarray(opening_deg * over.mean(axis=-1) / RATED_INPUT_TORQUE_NM)
