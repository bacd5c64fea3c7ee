"""Thermal change of clearance or datum."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.effects.base import Effect, Parameter, Shape, spread
from cyclosweep.effects.history import Floats, History

REFERENCE_C = 20.0


class ThermalDrift(Effect):
    """Offset, or clearance, in proportion to the temperature above 20 degC.

    `datum` and `clearance` say which of the two (or both) moves.
    """

    name = "thermal_drift"
    physics = (
        "Disc, pins and housing expand differently, which changes the clearances and turns the "
        "zero. Both follow the temperature."
    )
    source = "thermal expansion of unlike materials"
    tell_tale = "offset follows temperature"
    family = "run offsets"
    needs = ("temperature_c",)

    def untestable(self, history: History) -> str | None:
        """Need a temperature that changes."""
        reason = super().untestable(history)
        if reason is None and spread(np.asarray(history.temperature_c)) < 0.2:
            reason = "the temperature did not change by even 0.2 degC"
        return reason

    def shapes(self, history: History) -> Sequence[Shape]:
        """Datum, clearance, or both."""
        return [{"datum": 1.0}, {"clearance": 1.0}, {"datum": 1.0, "clearance": 1.0}]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Offset for 1 deg/K [deg]."""
        assert history.temperature_c is not None
        warm = history.temperature_c - REFERENCE_C
        parts = {"datum": warm, "clearance": history.side * warm}
        return np.column_stack([parts[name] for name in shape])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Shift of datum or clearance a kelvin."""
        return tuple(Parameter(f"{name}_per_k", "deg/K", f"{name} a kelvin") for name in shape)
