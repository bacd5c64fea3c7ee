"""Side load or misalignment: the response differs between the directions."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History

STOPS = (0.06, 0.5)
"""Least and largest load of a stop over the largest load."""
LEAST_OTHER = 0.1
"""Load of the less loaded direction over that of the other, from which the two can be compared:
below it, an even curve and an odd one differ on a tenth of the range."""


class LoadAsymmetry(Effect):
    """Twist even in torque: one direction is softer than the other.

    It is ``a |T|^p``, or with `limit_nm` ``a tanh(|T|/T0)`` where what yields comes to a stop, or
    with two `orders` ``a |T| + b T^2``, the beginning of any even curve.
    """

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
    shape_parameters = (
        Parameter("power", "", "power of the load", 0.4, 3.0),
        Parameter("limit_nm", "N m", "load at which what yields comes to a stop", 1e-6, 1e6, True),
    )
    forms = (ShapeForm(("power",)), ShapeForm(("limit_nm",)), ShapeForm(("orders",)))

    def untestable(self, history: History) -> str | None:
        """Need loads in both directions."""
        ends = max(history.applied_nm.max(), 0.0), max(-history.applied_nm.min(), 0.0)
        one_flank = np.all(history.side > 0) or np.all(history.side < 0)
        if one_flank or min(ends) < LEAST_OTHER * max(ends):
            return (
                "one direction was loaded to less than a tenth of the other, so the two cannot be "
                "compared"
            )
        return super().untestable(history)

    def shapes(self, history: History) -> Sequence[Shape]:
        """From a square root to a square of the load, and four loads of a stop."""
        powers: list[Shape] = [{"power": float(power)} for power in np.linspace(0.6, 2.0, 8)]
        stops = history.largest_torque_nm * np.geomspace(*STOPS, 4)
        return [*powers, *({"limit_nm": float(stop)} for stop in stops), {"orders": 2.0}]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep a stop below the largest load."""
        if parameter.name != "limit_nm":
            return super().shape_bounds(parameter, history)
        least, most = (share * history.largest_torque_nm for share in STOPS)
        return replace(parameter, lower=0.5 * least, upper=most)

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Loops usually show a difference of the directions; see `Effect.usual_start`."""
        return {"power": 1.0}, 1e-3

    def columns(self, history: History, shape: Shape) -> Floats:
        """Even twist, one at a load of 10 N m [deg]; with a stop, one far beyond it."""
        if "orders" in shape:
            load = history.load_nm / 10.0
            return np.column_stack([load, load**2])
        if "limit_nm" in shape:
            return np.tanh(history.load_nm / shape["limit_nm"])[:, None]
        return ((history.load_nm / 10.0) ** shape["power"])[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Even twist at 10 N m, in two parts where it has two orders, or at the stop."""
        if "orders" in shape:
            parts = ("in proportion to the load", "with the square of the load")
            return tuple(
                Parameter(f"even_twist_{k}_deg", "deg", f"half of the difference at 10 N m {part}")
                for k, part in enumerate(parts, 1)
            )
        if "limit_nm" in shape:
            return (Parameter("even_twist_deg", "deg", "difference of the directions, half"),)
        return (Parameter("even_twist_deg", "deg", "difference of the directions at 10 N m, half"),)
