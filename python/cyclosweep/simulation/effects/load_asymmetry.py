"""Side load or misalignment: the response differs between the directions."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History


class LoadAsymmetry(Effect):
    """Twist even in torque, ``a |T|^p``: one direction is softer than the other."""

    name = "load_asymmetry"
    physics = (
        "A side load (a hanging weight, a misaligned coupling) adds to the tooth forces in one "
        "direction and takes from them in the other. One direction is softer."
    )
    source = "Kumar et al. 2016 (side load of the hanging weight)"
    tell_tale = "even in torque: differs between directions"
    shown_by = "loading in both directions"
    family = "even curve"
    elastic = True
    dense = True
    shape_parameters = (Parameter("power", "", "power of the load", 0.4, 3.0),)
    forms = (ShapeForm(("power",)),)

    def untestable(self, history: History) -> str | None:
        """Need both directions."""
        if np.all(history.side > 0) or np.all(history.side < 0):
            return "only one direction was loaded, so the two cannot be compared"
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """From a square root to a square of the load."""
        return [{"power": float(power)} for power in np.linspace(0.6, 2.0, 8)]

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Loops usually show a difference of the directions; see `Effect.usual_start`."""
        return {"power": 1.0}, 1e-3

    def columns(self, history: History, shape: Shape) -> Floats:
        """Even twist, one at a load of 10 N m [deg]."""
        return ((history.load_nm / 10.0) ** shape["power"])[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Even twist at 10 N m."""
        return (Parameter("even_twist_deg", "deg", "difference of the directions at 10 N m, half"),)
