"""Delayed elasticity under held or changing load."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.base import Effect, Parameter, Shape, ShapeForm, listed, spread
from cyclosweep.simulation.effects.bounds import FEWEST_STEPS
from cyclosweep.simulation.effects.history import Flags, Floats, History

LONGEST = 3.0
"""Longest time constant over the longest run."""
REFERENCE_NM = 10.0
"""Load at which a delayed compliance holds that changes with the load [N m]."""
FLOW = "flow"
"""Shape parameter, 0 or 1: a part that flows as long as it is loaded and does not recover, too."""
BESIDE_TAUS = ("power", FLOW)
"""What a shape may have beside its time constants."""
MOST_TAUS = 5
"""Time constants of a spectrum."""


class Creep(Effect):
    """Kelvin-Voigt elements in series: their twist follows the torque with time constants.

    One element with a free time constant, or a spectrum of fixed ones, as real materials show. With
    `power` the delayed twist grows with that power of the load, as by Findley's law. With `flow`
    a damper is in series, too, as in Burgers' model.
    """

    name = "creep"
    physics = (
        "Plastic parts, bushes and lubricated contacts give way with delay. The delayed twist "
        "follows the load with a time constant and recovers when the load is gone."
    )
    source = "Findley, Lai, Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials, 1976"
    tell_tale = "angle goes on moving at constant torque; recovers"
    shown_by = "a clock, and holds at constant torque"
    family = "relaxation"
    needs = ("time_s",)
    shape_parameters = (
        Parameter("time_constant_s", "s", "time constant of the delayed twist", 1e-6, 1e9, True),
        Parameter("power", "", "power of the load with which the delayed twist grows", 0.3, 4.0),
    )
    forms = (
        ShapeForm(("time_constant_s",), BESIDE_TAUS),
        ShapeForm(optional=BESIDE_TAUS, numbered="tau_{}_s"),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Time constants from a few samples to the length of the longest run."""
        longest = _longest_run_s(history)
        shortest = min(max(FEWEST_STEPS * history.usual_step_s, longest / 2000.0), longest / 4.0)
        if not longest > 0:
            return []
        single: list[Shape] = [
            {"time_constant_s": float(t)} for t in np.geomspace(shortest, longest, 8)
        ]
        series = np.geomspace(shortest, longest, 6)
        spectra = (series[1:4:2], series[1:5], series[2:6])
        return single + [
            {f"tau_{k}_s": float(t) for k, t in enumerate(spectrum, 1)} for spectrum in spectra
        ]

    def shape_bounds(self, parameter: Parameter, history: History) -> Parameter:
        """Keep a time constant to a few runs: a slower one shows as a rate only."""
        bounded = super().shape_bounds(parameter, history)
        most = max(LONGEST * _longest_run_s(history), 2.0 * bounded.lower)
        return replace(bounded, upper=min(bounded.upper, most))

    def columns(self, history: History, shape: Shape) -> Floats:
        """Delayed twist for a delayed compliance of 1 deg/(N m), flow for 1 deg/(N m s) [deg]."""
        assert history.time_s is not None
        load = history.elastic_nm
        if "power" in shape:
            share = np.abs(load) / REFERENCE_NM
            load = REFERENCE_NM * np.sign(load) * share ** shape["power"]
        delayed = [
            _core.creep_state(load, history.time_s, history.restart, tau)
            for tau in _time_constants(shape)
        ]
        return np.column_stack([*delayed, *([_flowed(load, history)] if _flows(shape) else [])])

    def combined(self, shape: Shape, found: Shape) -> Shape | None:
        """Time constants of both."""
        both = [*_time_constants(shape), *_time_constants(found)]
        taus = listed("tau_{}_s", both, most=MOST_TAUS)
        return None if taus is None else {**_kept(found), **_kept(shape), **taus}

    def reduced(self, shape: Shape, wrong: Flags) -> Shape | None:
        """Time constants of positive weight, and flow where it is."""
        own = _time_constants(shape)
        right = [tau for tau, off in zip(own, wrong[: len(own)], strict=True) if not off]
        flows = _flows(shape) and not wrong[-1]
        if "time_constant_s" in shape and right and not flows:
            return {name: value for name, value in shape.items() if name != FLOW}
        taus = listed("tau_{}_s", right, most=MOST_TAUS)
        kept = {name: v for name, v in _kept(shape).items() if name != FLOW or flows}
        return None if taus is None else {**kept, **taus}

    def refinements(self, history: History, shape: Shape) -> Sequence[Shape]:
        """Twist that grows with a power of the load, or flows; see `Effect.refinements`.

        What a spectrum of time constants stood in for may be one of them and the flow.
        """
        freer: list[Shape] = [] if "power" in shape else [{"power": 1.2, **shape}]
        if FLOW not in shape:
            return [*freer, {**shape, FLOW: 1.0}]
        if "time_constant_s" in shape:
            return freer
        middle = float(np.exp(np.mean(np.log(_time_constants(shape)))))
        return [*freer, {"time_constant_s": middle, **_kept(shape)}]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Delayed compliance, one a time constant, and what flows."""
        if "time_constant_s" in shape:
            delayed = [
                Parameter("delayed_compliance", "deg/(N m)", "compliance that comes late", 0.0)
            ]
        else:
            delayed = [
                Parameter(
                    f"delayed_compliance_{k}", "deg/(N m)", f"compliance after {tau:.3g} s", 0.0
                )
                for k, tau in enumerate(_time_constants(shape), 1)
            ]
        flow = Parameter("flow_compliance", "deg/(N m s)", "compliance that flows in a second", 0.0)
        return (*delayed, flow) if _flows(shape) else tuple(delayed)

    def found_law(self, history: History, shape: Shape, amplitudes: Floats) -> str:
        """Say where a part of it does not recover; see `Effect.found_law`."""
        return "a part of it flows and does not recover" if _flows(shape) else ""


def _time_constants(shape: Shape) -> list[float]:
    """Time constants of a shape [s]."""
    return [float(value) for name, value in shape.items() if name not in BESIDE_TAUS]


def _flows(shape: Shape) -> bool:
    """Whether a part of the twist flows."""
    return bool(shape.get(FLOW, 0.0))


def _kept(shape: Shape) -> dict[str, float]:
    """What a shape has beside its time constants: power of the load, and flow."""
    return {name: value for name, value in shape.items() if name in BESIDE_TAUS}


def _flowed(load_nm: Floats, history: History) -> Floats:
    """Time integral of the load since the start of each run, shape (n,) [N m s].

    Parameters
    ----------
    load_nm : ndarray, shape (n,)
        Load of the part that flows [N m].
    history : History
        With a clock.

    Returns
    -------
    ndarray
    """
    assert history.time_s is not None
    step = np.maximum(np.diff(history.time_s, prepend=history.time_s[:1]), 0.0)
    added = step * 0.5 * (load_nm + np.roll(load_nm, 1))
    total = np.cumsum(np.where(history.restart, 0.0, added))
    start = np.maximum.accumulate(np.where(history.restart, np.arange(len(total)), 0))
    return np.asarray(total - total[start])


def _longest_run_s(history: History) -> float:
    """Length of the longest run [s]."""
    assert history.time_s is not None
    starts = history.run_starts
    stops = np.r_[starts[1:], len(history)]
    return max(spread(history.time_s[a:b]) for a, b in zip(starts, stops, strict=True))
