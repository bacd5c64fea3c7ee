"""Thermal change of datum, clearance or compliance."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, spread
from cyclosweep.simulation.effects.history import Floats, History

REFERENCE_C = 20.0
KINDS = ("datum", "clearance", "compliance")


class ThermalDrift(Effect):
    """Offset, clearance or compliance in proportion to the temperature above 20 degC.

    `datum`, `clearance` and `compliance` say which of them moves. With `delay_s` it follows the
    recorded temperature late, because the sensor sits elsewhere than the part that expands.
    """

    name = "thermal_drift"
    physics = (
        "Disc, pins and housing expand differently, which changes the clearances and turns the "
        "zero; plastics and greased joints give way more when they are warm. All of these follow "
        "the temperature."
    )
    source = "thermal expansion of unlike materials"
    tell_tale = "offset follows temperature"
    shown_by = "a recorded temperature that changes"
    family = "run offsets"
    needs = ("temperature_c",)
    shape_parameters = (
        Parameter("delay_s", "s", "time constant behind the recorded temperature", 1e-6, 1e9, True),
    )
    forms = (
        ShapeForm(("datum",), ("clearance", "compliance", "delay_s")),
        ShapeForm(("clearance",), ("compliance", "delay_s")),
        ShapeForm(("compliance",), ("delay_s",)),
    )

    def untestable(self, history: History) -> str | None:
        """Need a temperature that changes."""
        reason = super().untestable(history)
        if reason is None and spread(np.asarray(history.temperature_c)) < 0.2:
            reason = "the temperature did not change by even 0.2 degC"
        return reason

    def shapes(self, history: History) -> Sequence[Shape]:
        """Datum, clearance, compliance, or the first two, at once or with a delay.

        Others move together where a search finds so, see `combined`.
        """
        kinds: list[Shape] = [*({kind: 1.0} for kind in KINDS), {"datum": 1.0, "clearance": 1.0}]
        if history.time_s is None or not spread(history.time_s) > 0:
            return kinds
        delays = [share * spread(history.time_s) for share in (0.01, 0.04)]
        return kinds + [{**kind, "delay_s": delay} for kind in kinds for delay in delays]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep the delay to a tenth of the recording."""
        bounds = super().shape_bounds(parameter, history)
        step = history.usual_step_s
        if history.time_s is None or not step > 0:
            return bounds
        return replace(bounds, upper=max(0.1 * spread(history.time_s), 4.0 * step))

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """All that moves, with one delay."""
        kinds = {kind: 1.0 for kind in KINDS if kind in shape or kind in found}
        both = {**kinds, **{k: v for k, v in {**found, **shape}.items() if k == "delay_s"}}
        return None if set(both) == set(shape) else both

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist for 1 deg/K, and for 1 deg/(N m K) of compliance [deg]."""
        assert history.temperature_c is not None
        warm = history.temperature_c - REFERENCE_C
        if "delay_s" in shape:
            assert history.time_s is not None
            once = np.arange(len(warm)) == 0
            risen = np.ascontiguousarray(warm - warm[0])
            warm = warm[0] + _core.creep_state(risen, history.time_s, once, shape["delay_s"])
        parts = {
            "datum": warm,
            "clearance": history.side * warm,
            "compliance": history.elastic_nm * warm,
        }
        return np.column_stack([parts[name] for name in KINDS if name in shape])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Change of datum, clearance or compliance a kelvin."""
        return tuple(
            Parameter(
                f"{name}_per_k",
                "deg/(N m K)" if name == "compliance" else "deg/K",
                f"{name} a kelvin",
            )
            for name in KINDS
            if name in shape
        )
