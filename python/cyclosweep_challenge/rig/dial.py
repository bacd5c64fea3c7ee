"""The dial: eccentric mounting and reading to whole divisions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Dial:
    """Mounting of the angle sensor.

    Attributes
    ----------
    clocking_deg : float
        Direction in which its centre is displaced [deg].
    """

    clocking_deg: float

    @classmethod
    def draw(cls, rng: np.random.Generator) -> Dial:
        """Draw a direction."""
        return cls(float(rng.uniform(0.0, 360.0)))

    def indicated(self, angle_deg: Array, error_deg: float) -> Array:
        """Angle seen by a dial displaced so that it errs by at most ``error_deg`` [deg].

        The line of sight from the displaced centre, exact for any displacement.
        """
        if error_deg == 0.0:
            return angle_deg
        displacement = np.sin(np.deg2rad(error_deg))
        from_centre = np.deg2rad(angle_deg - self.clocking_deg)
        seen = np.arctan2(
            displacement * np.sin(from_centre), 1.0 - displacement * np.cos(from_centre)
        )
        return np.asarray(angle_deg + np.rad2deg(seen))


def divided(angle_deg: Array, division_deg: float) -> Array:
    """Angle rounded to the dial's divisions [deg]; unchanged for a division of zero."""
    if division_deg <= 0.0:
        return angle_deg
    return np.round(angle_deg / division_deg) * division_deg
