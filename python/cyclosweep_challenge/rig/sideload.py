"""Side load of the hanging weight: a turn of the input that is even in torque."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SideLoad:
    """Bearing that gives way under the weight.

    Attributes
    ----------
    exponent : float
        Power of the weight in the bearing's deflection [-].
    """

    exponent: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> SideLoad:
        """Draw a bearing between a line contact and a tilting one."""
        return cls(float(rng.uniform(0.9, 1.6)))

    def turn(self, torque_nm: Array, size_deg: float) -> Array:
        """Angle added [deg], even in torque; ``size_deg`` at rated torque."""
        return size_deg * (np.abs(torque_nm) / RATED_INPUT_TORQUE_NM) ** self.exponent
