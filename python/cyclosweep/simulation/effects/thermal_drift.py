"""Thermal change of datum, clearance or compliance."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, spread
from cyclosweep.simulation.effects.history import Floats, History

REFERENCE_C = 20.0
DELAYS = (0.01, 0.04)
"""Delays that are looked for, as shares of the duration of the recording."""
LONGEST_DELAY = 0.25
"""Largest delay that a fit may find, as such a share."""
GRADIENT = "gradient"
"""Shape parameter: a datum that moves with the difference of the temperature and what follows it
late, too."""
MOVED = {
    "datum": ("deg/K", "datum a kelvin"),
    "clearance": ("deg/K", "clearance a kelvin"),
    "compliance": ("deg/(N m K)", "compliance a kelvin"),
    GRADIENT: ("deg/K", "datum a kelvin of difference"),
}
"""Unit and meaning of the amplitudes that a shape may name, in their order."""
KINDS = tuple(name for name in MOVED if name != GRADIENT)
"""Those that follow one temperature."""


class ThermalDrift(Effect):
    """Offset, clearance or compliance in proportion to the temperature above 20 degC.

    `datum`, `clearance` and `compliance` say which of them moves; a compliance does so in all
    elastic parts alike. With `delay_s` it follows the recorded temperature late, because the sensor
    sits elsewhere than the part that expands. With `gradient` the datum also moves with what that
    part still lags behind, because another one has warmed up already.
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
        ShapeForm((GRADIENT, "delay_s"), KINDS),
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
        """Datum, clearance, compliance, or the first two, at once or with a delay, and a gradient.

        Others move together where a search finds so, see `combined`.
        """
        kinds: list[Shape] = [*({kind: 1.0} for kind in KINDS), {"datum": 1.0, "clearance": 1.0}]
        if history.time_s is None or not spread(history.time_s) > 0:
            return kinds
        delays = [share * spread(history.time_s) for share in DELAYS]
        late = [*kinds, {GRADIENT: 1.0}]
        return kinds + [{**kind, "delay_s": delay} for kind in late for delay in delays]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep the delay to a part of the recording."""
        bounds = super().shape_bounds(parameter, history)
        step = history.usual_step_s
        if history.time_s is None or not step > 0:
            return bounds
        return replace(bounds, upper=max(LONGEST_DELAY * spread(history.time_s), 4.0 * step))

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """All that moves, with one delay."""
        moved = {name: 1.0 for name in MOVED if name in shape or name in found}
        both = {**moved, **{k: v for k, v in {**found, **shape}.items() if k not in MOVED}}
        return None if set(both) == set(shape) else both

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Datum that moves with a difference of temperatures, too; see `Effect.refinements`."""
        if history.time_s is None or not spread(history.time_s) > 0:
            return []
        late = {"delay_s": DELAYS[-1] * spread(history.time_s)} | dict(shape)
        both = {**late, "datum": 1.0, GRADIENT: 1.0}
        return [] if set(both) == set(shape) else [both]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Twist for 1 deg/K, and for 1 deg/(N m K) of compliance [deg], in the order of `MOVED`."""
        assert history.temperature_c is not None
        warm = sensed = history.temperature_c - REFERENCE_C
        if "delay_s" in shape:
            assert history.time_s is not None
            once = np.arange(len(warm)) == 0
            risen = np.ascontiguousarray(warm - warm[0])
            warm = warm[0] + _core.creep_state(risen, history.time_s, once, shape["delay_s"])
        parts = {
            "datum": warm,
            "clearance": history.side * warm,
            "compliance": history.line_equivalent_nm * warm,
            GRADIENT: sensed - warm,
        }
        return np.column_stack([parts[name] for name in MOVED if name in shape])

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Change of datum, clearance or compliance a kelvin."""
        return tuple(
            Parameter(f"{name}_per_k", unit, meaning)
            for name, (unit, meaning) in MOVED.items()
            if name in shape
        )
