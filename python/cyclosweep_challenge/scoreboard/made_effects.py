"""Twists and offsets that the scoreboard's rig adds: one law an effect, none of them the library's.

Each returns the shape of the effect at every reading in arbitrary size [deg].
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.scoreboard.made_rig import TOP_NM, Balance, Course

Array = NDArray[np.float64]
Shape = Callable[[Course, Balance, np.random.Generator], Array]

SPRINGS_AT = (0.08, 0.2, 0.34, 0.45)
"""Loads over the largest one at which the pins come into contact one after another."""
ONSET = 0.6
"""Load over the largest one above which parts give way."""
LAGS_S = (12.0, 70.0)
"""Times in which delayed elasticity recovers [s]."""
SOAK_S = 240.0
"""Time in which a change of temperature reaches the shaft [s]."""


def _load(at: Balance) -> tuple[Array, Array]:
    """Side and size over the largest torque of the load on the spring."""
    return np.sign(at.elastic_nm), np.abs(at.elastic_nm) / TOP_NM


def soft_layer(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Stiffening: a layer that is squeezed out exponentially before the contact is hard."""
    side, load = _load(at)
    return np.asarray(side * (1.0 - np.exp(-load / 0.2)))


def late_pins(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Take-up: pins that come into contact one after another, each adding a tenth of stiffness."""
    side, load = _load(at)
    low, high = np.zeros_like(load), 2.0 * np.ones_like(load)
    for _ in range(50):
        middle = 0.5 * (low + high)
        carried = middle + sum(0.35 * np.maximum(middle - gap, 0.0) for gap in SPRINGS_AT)
        low, high = np.where(carried < load, middle, low), np.where(carried < load, high, middle)
    return np.asarray(side * 0.5 * (low + high))


def giving_way(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Softening: a twist that grows with the square of the overload."""
    side, load = _load(at)
    return np.asarray(side * np.maximum(load - ONSET, 0.0) ** 2)


def side_load(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Side load: even in torque, saturating."""
    _, load = _load(at)
    return np.asarray(load - 0.3 * load**2)


def lagging(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Creep: two relaxations that follow the load with a delay; they start afresh in each run."""
    out = np.zeros(course.torque_nm.size)
    for weight, lag in zip((0.6, 0.4), LAGS_S, strict=True):
        state = 0.0
        for k, start in enumerate(course.starts.tolist()):
            if start:
                state = 0.0
            else:
                passed = course.time_s[k] - course.time_s[k - 1]
                state += (at.elastic_nm[k] / TOP_NM - state) * (1.0 - np.exp(-passed / lag))
            out[k] += weight * state
    return out


def soaked(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Thermal drift: the zero follows the temperature with a delay."""
    out = np.empty(course.torque_nm.size)
    inside = float(course.temperature_c[0])
    for k in range(out.size):
        passed = course.time_s[k] - course.time_s[max(k - 1, 0)]
        inside += (course.temperature_c[k] - inside) * (1.0 - np.exp(-passed / SOAK_S))
        out[k] = inside
    return out - 20.0


def to_and_fro(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Moving zero: each run leaves an offset against the last one, which fades to a half."""
    out, shift = np.zeros(course.torque_nm.size), 0.0
    for number in np.unique(course.run):
        here = course.run == number
        out[here] = shift
        largest = float(np.abs(course.torque_nm[here]).max()) / TOP_NM
        sign = 1.0 if float(course.torque_nm[here][-2]) >= 0.0 and shift <= 0.0 else -1.0
        shift = -0.5 * shift + sign * largest * float(rng.uniform(0.6, 1.0))
    return out


def profile_error(course: Course, at: Balance, rng: np.random.Generator) -> Array:
    """Transmission error: two orders of the position."""
    turn = np.radians(course.crank_deg)
    return np.asarray(
        np.cos(turn + rng.uniform(0.0, 6.3)) + 0.3 * np.cos(2.0 * turn + rng.uniform(0.0, 6.3))
    )


SHAPES: dict[str, Shape] = {
    "contact_stiffening": soft_layer,
    "clearance_takeup": late_pins,
    "overload_softening": giving_way,
    "load_asymmetry": side_load,
    "creep": lagging,
    "thermal_drift": soaked,
    "datum_drift": to_and_fro,
    "transmission_error": profile_error,
}
"""Shape of every effect that is added to the twist, by the name that a right answer gives it."""
