"""Lubricant drag: a torque in proportion to the rate of twist."""

from collections.abc import Sequence

import numpy as np

import cyclosweep._core as _core
from cyclosweep.effects.base import Effect, Parameter, Shape
from cyclosweep.effects.history import Floats, History


class ViscousDrag(Effect):
    """Drag torque ``D (rate)^n`` against the motion, with n between 0.5 and 1.

    The rate is that of the twist itself, which lags behind the torque:
    ``T = theta/C + D dtheta/dt`` has the time constant ``D C``. It shows at reversals only, so it
    is a parameter of its own, of a few samples at most.
    """

    name = "viscous_drag"
    physics = (
        "The lubricant shears as the drive twists and resists in proportion to the rate. "
        "The drive is twisted by what the drag leaves of the torque."
    )
    source = "Volbeda, MSc thesis 2024 (viscous 1.3 N m s/rev); Newton's law of viscosity"
    tell_tale = "torque in proportion to twist rate"
    family = "hysteresis"
    needs = ("time_s",)
    shape_parameters = (
        Parameter("power", "", "power of the rate", 0.5, 1.0),
        Parameter("lag_s", "s", "time by which the twist lags", 1e-9, 1e9, logarithmic=True),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Newtonian and thinning drag, with lags about the time between samples."""
        step = history.telling_step_s
        if not step > 0:
            return []
        return [
            {"power": power, "lag_s": share * step}
            for power, share in ((1.0, 0.1), (1.0, 0.4), (1.0, 1.6), (0.7, 0.1))
        ]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist taken away by a drag of 1 N m at 1 deg/s [deg]."""
        lag, compliance = float(shape["lag_s"]), history.compliance_deg_per_nm
        carried = _core.dragged(history.elastic_nm, history.lapse_s, history.restart, lag)
        rate = compliance * (history.elastic_nm - carried) / lag
        drag = np.sign(rate) * np.abs(rate) ** shape["power"]
        return (-compliance * drag)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Drag torque at a rate of 1 deg/s."""
        return (Parameter("drag_nm", "N m", "drag torque at 1 deg/s", 0.0),)
