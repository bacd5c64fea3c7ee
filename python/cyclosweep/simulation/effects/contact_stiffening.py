"""Hertzian contacts: the compliance falls smoothly as the load grows."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History

LOADS = {"turn_nm": (0.02, 0.25, 7), "squeeze_nm": (0.05, 0.35, 4), "cubic_nm": (0.5, 2.0, 3)}
"""Loads of the laws over the largest load: the least and most that are looked for, and how many."""

POWERS = (0.5, 0.9, 9)
"""Powers of the load: 2/3 is a point contact (Hertz), 0.9 a roller (Palmgren)."""

BOUNDS = {
    "turn_nm": (1e-3, LOADS["turn_nm"][1]),
    "squeeze_nm": (1e-3, LOADS["squeeze_nm"][1]),
    "cubic_nm": LOADS["cubic_nm"][:2],
    "knee_nm": (1e-3, 0.5),
}
"""Loads of the laws over the largest load, within which they are fitted."""
DECAY = (0.1, 8.0)
"""Powers within which a compliance that falls by a power of the load is fitted."""
AS_EXPONENTIAL = 5.0
"""Power at which such a compliance is nearly an exponential of the load."""


def _fallen(load: Floats, knee: float, decay: float) -> Floats:
    """Twist of a compliance that falls by a power of the load [deg]."""
    rest = 1.0 - decay
    grown = np.log1p(load / knee)
    return np.asarray(knee * (grown if abs(rest) < 1e-6 else np.expm1(rest * grown) / rest))


def _cubic(load: Floats, value: float) -> Floats:
    """Twist of a cubic spring: the real root of x + x^3 = load over the law's, in closed form."""
    turn = np.arcsinh(1.5 * np.sqrt(3.0) * load / value)
    return np.asarray(value * (2.0 / np.sqrt(3.0)) * np.sinh(turn / 3.0))


CURVES: dict[str, Callable[[Floats, float], Floats]] = {
    "turn_nm": lambda load, value: value * np.log1p(load / value),
    "power": lambda load, value: load**value,
    "squeeze_nm": lambda load, value: -value * np.expm1(-load / value),
    "cubic_nm": _cubic,
}
"""Twist for a unit of extra compliance by the laws of one parameter."""


class ContactStiffening(Effect):
    """Compliance that falls smoothly with the load, alike on both flanks, by one of five laws.

    * A contact in parallel with softer ones, ``dC/(1 + |T|/T0)``: half of the extra compliance is
      gone at `turn_nm`. Such a contact is stiff long before the largest load: `turn_nm` stays below
      a quarter of it.
    * A power of the load, after calibration of the linear part: 2/3 of a point contact, 0.9 of a
      roller.
    * A soft layer that is squeezed out, ``dC exp(-|T|/T0)`` with `squeeze_nm`.
    * A power of the compliance, ``dC/(1 + |T|/T0)^q`` with `knee_nm` and `decay`. It includes the
      first law (``q = 1``) and approaches the second and the third, and is fitted only where one of
      them leaves a part of the curve.
    * A cubic spring, ``|T| = x/dC + (x/dC)^3/T0^2`` with `cubic_nm`, at most four times as stiff at
      the largest load as at none. The whole drive may be such a spring.

    All but the cubic spring are softest without load and lose compliance fastest there. The cubic
    spring is as soft at small loads as at none, but stiffens over the whole range and comes to no
    stop; what does is a clearance that is taken up.
    """

    name = "contact_stiffening"
    physics = (
        "Contacts of rollers, pins and disc grow under load, so they are soft near zero load and "
        "stiffen smoothly (Hertz). The rest of the drive stays linear."
    )
    source = "Johnson, Contact Mechanics, 1985, ch. 4 (Hertz); Palmgren 1959 (rollers)"
    tell_tale = "steep near zero load, flatter above; both directions alike"
    shown_by = "more samples at small load"
    family = "smooth odd curve"
    elastic = True
    dense = True
    whole_spring = "cubic_nm"
    shape_parameters = (
        Parameter("turn_nm", "N m", "load that halves the extra compliance", 1e-6, 1e6, True),
        Parameter("power", "", "power of the load", *POWERS[:2]),
        Parameter("squeeze_nm", "N m", "load that squeezes a soft layer out", 1e-6, 1e6, True),
        Parameter("cubic_nm", "N m", "load of a cubic spring", 1e-6, 1e6, True),
        Parameter("knee_nm", "N m", "load from which the compliance falls", 1e-6, 1e6, True),
        Parameter("decay", "", "power by which it falls", *DECAY, True),
    )
    forms = (
        *(ShapeForm((name,)) for name in CURVES),
        ShapeForm(("knee_nm", "decay")),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Power laws from beyond a point contact to a roller, and the other laws by their loads."""
        top = history.largest_torque_nm
        powers: list[Shape] = [{"power": float(p)} for p in np.linspace(*POWERS)]
        return powers + [
            {name: float(share) * top}
            for name, (lowest, highest, count) in LOADS.items()
            for share in np.geomspace(lowest, highest, count)
        ]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep each load to its share of the largest one."""
        if parameter.name not in BOUNDS:
            return parameter
        lower, upper = (share * history.largest_torque_nm for share in BOUNDS[parameter.name])
        return replace(parameter, lower=lower, upper=upper)

    def usual_start(
        self, history: History, limit_share: float, slip_share: float
    ) -> tuple[Shape, float] | None:
        """Loops usually show contacts that stiffen; see `Effect.usual_start`."""
        compliance = history.largest_twist_deg / history.largest_torque_nm
        return {"turn_nm": 0.1 * history.largest_torque_nm}, 0.3 * compliance

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist by contacts for a unit of extra compliance [deg]."""
        load = history.load_nm
        if "knee_nm" in shape:
            curve = _fallen(load, shape["knee_nm"], shape["decay"])
        else:
            ((name, value),) = shape.items()
            curve = CURVES[name](load, value)
        return (history.side * curve)[:, None]

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Compliance that falls by a power of the load, begun as near the law as it comes."""
        if "turn_nm" in shape:
            return {"knee_nm": shape["turn_nm"], "decay": 1.0}
        if "squeeze_nm" in shape:
            return {"knee_nm": AS_EXPONENTIAL * shape["squeeze_nm"], "decay": AS_EXPONENTIAL}
        if "power" in shape and "turn_nm" in found:
            return {"knee_nm": found["turn_nm"], "decay": 1.0 - shape["power"]}
        return None

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Extra compliance at zero load, or the factor of the power law."""
        if "power" in shape:
            unit = f"deg/(N m)^{shape['power']:.3g}"
            return (Parameter("contact_twist", unit, "twist of the contacts at 1 N m", 0.0),)
        return (Parameter("extra_compliance", "deg/(N m)", "compliance lost under load", 0.0),)
