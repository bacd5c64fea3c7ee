"""Lubricant drag: a torque in proportion to the rate of twist."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.effects.base import Effect, Parameter, Shape
from cyclosweep.effects.history import Floats, History


class ViscousDrag(Effect):
    """Drag torque ``D (rate)^n`` against the motion, with n between 0.6 and 1."""

    name = "viscous_drag"
    physics = (
        "The lubricant shears as the drive twists and resists in proportion to the rate. "
        "The drive is twisted by what the drag leaves of the torque."
    )
    source = "Volbeda, MSc thesis 2024 (viscous 1.3 N m s/rev); Newton's law of viscosity"
    tell_tale = "torque in proportion to twist rate"
    family = "hysteresis"
    needs = ("time_s",)
    shape_parameters = (Parameter("power", "", "power of the rate", 0.5, 1.0),)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Newtonian and thinning drag."""
        return [{"power": 1.0}, {"power": 0.7}]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by a drag of 1 N m at 1 deg/s [deg]."""
        rate = history.twist_rate_deg_per_s
        drag = np.sign(rate) * np.abs(rate) ** shape["power"]
        return (-history.compliance_deg_per_nm * drag)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Drag torque at a rate of 1 deg/s."""
        return (Parameter("drag_nm", "N m", "drag torque at 1 deg/s", 0.0),)
