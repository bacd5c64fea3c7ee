"""Compliance that grows above a load."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm
from cyclosweep.simulation.effects.history import Floats, History


class OverloadSoftening(Effect):
    """Extra twist ``a (|T| - T0)^p`` above a load `onset_nm`."""

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
    )
    forms = (ShapeForm(("onset_nm", "power")),)

    def shapes(self, history: History) -> Sequence[Shape]:
        """Onsets up to four fifths of the largest load, kinked to cubic."""
        top = history.largest_torque_nm
        return [
            {"onset_nm": share * top, "power": power}
            for share in (0.15, 0.3, 0.45, 0.55, 0.65, 0.8)
            for power in (1.0, 1.5, 2.0, 3.0)
        ]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep the onset below the largest load."""
        if parameter.name != "onset_nm":
            return super().shape_bounds(parameter, history)
        return replace(parameter, lower=0.0, upper=0.92 * history.largest_torque_nm)

    def columns(self, history: History, shape: Shape) -> Floats:
        """Extra twist, one at an overload of 10 N m [deg]."""
        over = np.maximum(history.load_nm - shape["onset_nm"], 0.0)
        return (history.side * (over / 10.0) ** shape["power"])[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Extra twist at an overload of 10 N m."""
        return (Parameter("extra_twist_deg", "deg", "extra twist at 10 N m overload", 0.0),)
