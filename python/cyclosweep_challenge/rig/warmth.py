"""Warming of the drive: clearance or datum follow the temperature, late."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]

REFERENCE_C = 20.0


@dataclass(frozen=True)
class Warmth:
    """How one specimen answers to its housing's temperature.

    Attributes
    ----------
    lag_s : float
        Time in which the inside follows the housing [s].
    in_clearance : bool
        Whether the free play changes instead of the datum.
    """

    lag_s: float
    in_clearance: bool

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Warmth:
        """Draw a lag of up to two minutes and what the warmth acts on."""
        return cls(float(rng.uniform(0.0, 120.0)), bool(rng.random() < 0.4))

    def offset(self, programme: Programme, side: Array, per_ten_k_deg: float) -> Array:
        """Angle added to every sample [deg]; ``per_ten_k_deg`` is its change over 10 K [deg]."""
        inside = programme.temperature_c.copy()
        lapse = np.diff(programme.time_s)
        for k in range(1, inside.size):
            decay = np.exp(-lapse[k - 1] / self.lag_s) if self.lag_s > 0.0 else 0.0
            inside[k] += (inside[k - 1] - inside[k]) * decay
        shift = per_ten_k_deg * (inside - REFERENCE_C) / 10.0
        return shift * side if self.in_clearance else shift
