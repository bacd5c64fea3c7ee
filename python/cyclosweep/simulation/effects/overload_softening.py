"""Compliance that grows above a load."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History
from cyclosweep.simulation.effects.scattered import acting_beyond

SPREAD, USUAL_SPREAD = (0.03, 0.3), 0.1
"""Logistic scale of the loads at which joints part, over their mean load."""


class OverloadSoftening(Effect):
    """Extra twist ``a (|T| - T0)^p`` above a load `onset_nm`.

    Joints that part one after another about the load ``T0`` give, with ``w`` the `spread` times
    ``T0``, ``a w (log(1 + exp((|T| - T0)/w)) - log(1 + exp(-T0/w)))``.
    """

    name = "overload_softening"
    physics = (
        "Above a load the parts give way more: pins bend out of their seats, bushes and flange "
        "deform, contacts tilt. The compliance grows with the overload."
    )
    source = "Kumar et al. 2016 (the loading curve is nonlinear above 2.5 times nominal torque)"
    tell_tale = "slope rises beyond a torque"
    shown_by = "loads beyond 2.5 times the nominal torque"
    family = "smooth odd curve"
    elastic = True
    dense = True
    shape_parameters = (
        Parameter("onset_nm", "N m", "load above which the compliance grows", 0.0, 1e6),
        Parameter("power", "", "power of the extra twist", 1.0, 10.0),
        Parameter("spread", "", "logistic scale of the onsets over their mean", *SPREAD, True),
    )
    forms = (ShapeForm(("onset_nm", "power")), ShapeForm(("onset_nm", "spread")))

    def shapes(self, history: History) -> Sequence[Shape]:
        """Onsets up to four fifths of the largest load, kinked to cubic."""
        top = history.largest_torque_nm
        return [
            {"onset_nm": share * top, "power": power}
            for share in (0.15, 0.3, 0.45, 0.55, 0.65, 0.8)
            for power in (1.0, 1.5, 2.0, 3.0)
        ]

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Onsets scattered about a mean, or the other law; see `Effect.refinements`."""
        law = {"power": 1.2} if "spread" in shape else {"spread": USUAL_SPREAD}
        return [{"onset_nm": shape["onset_nm"], **law}]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep the onset below the largest load."""
        if parameter.name != "onset_nm":
            return super().shape_bounds(parameter, history)
        return replace(parameter, lower=0.0, upper=0.92 * history.largest_torque_nm)

    def columns(self, history: History, shape: Shape) -> Floats:
        """Extra twist, one at an overload of 10 N m [deg]."""
        if "spread" in shape:
            parted = acting_beyond(history.load_nm, shape["onset_nm"], shape["spread"])
            return np.asarray(history.side * parted / 10.0)[:, None]
        over = np.maximum(history.load_nm - shape["onset_nm"], 0.0)
        return (history.side * (over / 10.0) ** shape["power"])[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Extra twist at an overload of 10 N m."""
        return (Parameter("extra_twist_deg", "deg", "extra twist at 10 N m overload", 0.0),)
