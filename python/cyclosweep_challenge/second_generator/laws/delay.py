"""Delayed elasticity: twist that goes on under a constant load.

Kernels are sums of Kelvin elements, each advanced exactly for a load that is linear between
readings. Angle added is per unit of size [deg], about a degree at the largest load when complete.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.laws.law import Draw, Law, Parameters, State

Array = NDArray[np.float64]

ELEMENTS = 14
"""Kelvin elements of a kernel that has no time of its own."""


def kelvin(state: State, times_s: Array, weights: Array) -> Array:
    """Sum of Kelvin elements under the elastic torque [rated torques].

    Parameters
    ----------
    state : State
        What the drive does.
    times_s, weights : array, shape (K,)
        Retardation times [s] and weights [-].
    """
    load, starts = state.twist, state.path.starts
    step = np.diff(state.path.time_s, prepend=state.path.time_s[0] - 1.0)
    step = np.maximum(np.where(starts, 1.0, step), 1e-6)
    part = step[:, None] / times_s
    fade = np.exp(-part)
    held = -np.expm1(-part) / part
    before = np.where(starts, 0.0, np.concatenate([[0.0], load[:-1]]))
    # Exact response to a ramp from the load before to the load now.
    gain = (held - fade) * before[:, None] + (1.0 - held) * load[:, None]
    fade[starts] = 0.0
    course = np.empty_like(gain)
    now = np.zeros(len(times_s))
    for row in range(len(load)):
        now = fade[row] * now + gain[row]
        course[row] = now
    return np.asarray(course @ weights, dtype=float)


def standard_solid(state: State, shape: Parameters) -> Array:
    """Standard linear solid: one retardation time."""
    return kelvin(state, np.array([shape["slow"]]), np.array([1.0])) / shape["top"]


def two_kelvin(state: State, shape: Parameters) -> Array:
    """Two Kelvin elements of different times."""
    times = np.array([shape["slow"] / shape["apart"], shape["slow"]])
    return kelvin(state, times, np.array([shape["share"], 1.0 - shape["share"]])) / shape["top"]


def logarithmic(state: State, shape: Parameters) -> Array:
    """Logarithmic creep: equal weights at evenly spaced logarithms of time."""
    times = np.geomspace(shape["fast"], shape["slow"] * 20.0, ELEMENTS)
    return kelvin(state, times, np.full(ELEMENTS, 1.0 / ELEMENTS)) / shape["top"]


def power_law(state: State, shape: Parameters) -> Array:
    """Creep by a power of time: weights that rise with the power of the retardation time."""
    times = np.geomspace(shape["fast"], shape["slow"] * 20.0, ELEMENTS)
    weights = times ** shape["power"]
    return kelvin(state, times, weights / weights.sum()) / shape["top"]


def burgers(state: State, shape: Parameters) -> Array:
    """Burgers: a Kelvin element and a dashpot whose flow does not recover within a run."""
    solid = standard_solid(state, shape)
    time, load, starts = state.path.time_s, state.twist / shape["top"], state.path.starts
    step = np.where(starts, 0.0, np.diff(time, prepend=time[0]))
    mean = 0.5 * (load + np.concatenate([[0.0], load[:-1]]))
    flow = np.cumsum(step * mean)
    first = np.maximum.accumulate(np.where(starts, np.arange(len(load)), 0))
    return np.asarray(solid + shape["flow"] * (flow - flow[first]) / shape["slow"], dtype=float)


def _times(**ranges: tuple[float, float]) -> Draw:
    def draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
        drawn = {k: float(rng.uniform(*v)) for k, v in ranges.items()}
        slow = duration_s * float(np.exp(rng.uniform(np.log(0.003), np.log(0.03))))
        return {"top": top, "slow": slow, "fast": 0.01 * slow} | drawn

    return draw


CLOCK = frozenset({"clock"})
LAWS = (
    Law(
        "creep",
        "standard-linear-solid",
        "C. Zener, Elasticity and Anelasticity of Metals, Chicago, 1948",
        _times(),
        standard_solid,
        CLOCK,
    ),
    Law(
        "creep",
        "two-kelvin",
        "W. N. Findley, J. S. Lai, K. Onaran, Creep and Relaxation of Nonlinear Viscoelastic "
        "Materials, 1976, ch. 5",
        _times(apart=(5.0, 20.0), share=(0.3, 0.7)),
        two_kelvin,
        CLOCK,
    ),
    Law(
        "creep",
        "logarithmic",
        "P. Phillips, Philos. Mag., vol. 9, pp. 513-531, 1905: stretch of wires with the logarithm "
        "of time",
        _times(),
        logarithmic,
        CLOCK,
    ),
    Law(
        "creep",
        "power-law",
        "P. G. Nutting, J. Franklin Inst., vol. 191, pp. 679-685, 1921: strain as a power of time",
        _times(power=(0.1, 0.35)),
        power_law,
        CLOCK,
    ),
    Law(
        "creep",
        "burgers",
        "J. M. Burgers, First Report on Viscosity and Plasticity, Amsterdam, 1935",
        _times(flow=(0.02, 0.1)),
        burgers,
        CLOCK,
    ),
)
