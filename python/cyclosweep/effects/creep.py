"""Delayed elasticity under held or changing load."""

from collections.abc import Sequence

import numpy as np

from cyclosweep import _core
from cyclosweep.effects.base import Effect, Parameter, Shape, spread
from cyclosweep.effects.history import Floats, History


class Creep(Effect):
    """Kelvin-Voigt element in series: its twist follows the torque with a time constant."""

    name = "creep"
    physics = (
        "Plastic parts, bushes and lubricated contacts give way with delay. The delayed twist "
        "follows the load with a time constant and recovers when the load is gone."
    )
    source = "Findley, Lai, Onaran, Creep and Relaxation of Nonlinear Viscoelastic Materials, 1976"
    tell_tale = "angle goes on moving at constant torque; recovers"
    family = "relaxation"
    needs = ("time_s",)
    shape_parameters = (
        Parameter("time_constant_s", "s", "time constant of the delayed twist", 1e-6, 1e9, True),
    )

    def shapes(self, history: History) -> Sequence[Shape]:
        """Time constants from a few samples to the length of the longest run."""
        assert history.time_s is not None
        starts = history.run_starts
        stops = np.r_[starts[1:], len(history)]
        longest = max(spread(history.time_s[a:b]) for a, b in zip(starts, stops, strict=True))
        steps = np.diff(history.time_s)
        usual = float(np.median(steps[steps > 0])) if np.any(steps > 0) else longest
        shortest = min(max(2.0 * usual, longest / 2000.0), longest / 4.0)
        if not longest > 0:
            return []
        return [{"time_constant_s": float(t)} for t in np.geomspace(shortest, longest, 8)]

    def columns(self, history: History, shape: Shape) -> Floats:
        """Delayed twist for a delayed compliance of 1 deg/(N m) [deg]."""
        assert history.time_s is not None
        state = _core.creep_state(
            history.elastic_nm, history.time_s, history.restart, float(shape["time_constant_s"])
        )
        return state[:, None]

    def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
        """Delayed compliance."""
        return (Parameter("delayed_compliance", "deg/(N m)", "compliance that comes late", 0.0),)
