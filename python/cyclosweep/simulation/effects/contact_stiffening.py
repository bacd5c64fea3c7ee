"""Hertzian contacts: the compliance falls smoothly as the load grows."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History


class ContactStiffening(Effect):
    """Extra compliance ``dC/(1 + |T|/T0)`` or a Hertzian power of the load, alike on both flanks.

    `turn_nm` is the load at which half of the extra compliance is gone; a Hertzian contact
    (``T**(2/3)``) lies within the range of shapes after calibration of the linear part. A contact
    is stiff long before the largest load, so `turn_nm` stays below a quarter of it.
    """

    name = "contact_stiffening"
    physics = (
        "Contacts of rollers, pins and disc grow under load, so they are soft near zero load and "
        "stiffen smoothly (Hertz). The rest of the drive stays linear."
    )
    source = "Johnson, Contact Mechanics, 1985, ch. 4 (Hertz)"
    tell_tale = "steep near zero load, flatter above; both directions alike"
    shown_by = "more samples at small load"
    family = "smooth odd curve"
    elastic = True
    dense = True
    shape_parameters = (
        Parameter("turn_nm", "N m", "load that halves the extra compliance", 1e-6, 1e6, True),
    )
    forms = (ShapeForm(("turn_nm",)), ShapeForm(("power",)))

    def shapes(self, history: History) -> Sequence[Shape]:
        """Power laws around that of Hertz, and turning loads up to a quarter of the largest."""
        top = history.largest_torque_nm
        powers: list[Shape] = [{"power": float(p)} for p in np.linspace(1 / 2, 5 / 6, 7)]
        return powers + [{"turn_nm": float(t) * top} for t in np.geomspace(0.02, 0.25, 7)]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep the turning load to a quarter of the largest load."""
        top = history.largest_torque_nm
        return replace(parameter, lower=1e-3 * top, upper=0.25 * top)

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Loops usually show contacts that stiffen; see `Effect.usual_start`."""
        compliance = history.largest_twist_deg / history.largest_torque_nm
        return {"turn_nm": 0.1 * history.largest_torque_nm}, 0.3 * compliance

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist by contacts for a unit of extra compliance [deg]."""
        load = history.load_nm
        if "power" in shape:
            curve = load ** shape["power"]
        else:
            curve = shape["turn_nm"] * np.log1p(load / shape["turn_nm"])
        return (history.side * curve)[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Extra compliance at zero load, or the factor of the power law."""
        if "power" in shape:
            unit = f"deg/(N m)^{shape['power']:.3g}"
            return (Parameter("contact_twist", unit, "twist of the contacts at 1 N m", 0.0),)
        return (Parameter("extra_compliance", "deg/(N m)", "compliance lost under load", 0.0),)
