"""Causes outside the vocabulary: what benches do that no effect of a drive explains.

Each function returns the angle added per unit of size [deg].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.laws.law import Law, Parameters, State

Array = NDArray[np.float64]


def _torque(state: State, shape: Parameters) -> Array:
    """Applied torque in parts of the largest [-]."""
    return state.path.load / shape["top"]


def _reversals(state: State, shape: Parameters) -> NDArray[np.bool_]:
    """Rows after which the torque turns round, within a run."""
    steps = np.diff(state.path.load, prepend=0.0)
    way = np.zeros(len(steps))
    last = 0.0
    for k, step in enumerate(steps):
        last = np.sign(step) if abs(step) > 1e-9 else last
        way[k] = last
    turned = np.zeros(len(way), dtype=bool)
    turned[1:] = (way[1:] * way[:-1] < 0.0) & ~state.path.starts[1:]
    return turned


def loose_coupling(state: State, shape: Parameters) -> Array:
    """Loose coupling that jumps over at one torque and back at a lower one (relay with lag)."""
    high, low, on, course = shape["high"], shape["low"], 0.0, []
    for value in _torque(state, shape):
        on = 1.0 if value > high else 0.0 if value < low else on
        course.append(on)
    return np.array(course)


def cam_switch(state: State, shape: Parameters) -> Array:
    """Cam that engages a second spring near the end of travel, with a plateau before it."""
    value = _torque(state, shape)
    start, wide = shape["start"], 0.12
    ramp = np.clip((value - start) / wide, 0.0, 1.0)
    return ramp - np.clip((value - start - 1.5 * wide) / (0.5 * wide), 0.0, 1.0) * 0.7


def sticking_encoder(state: State, shape: Parameters) -> Array:
    """Encoder that sticks and follows in jumps: it stays until it is behind by a step."""
    step = shape["stick"] * state.twist_deg
    held, course = float(state.angle_deg[0]), []
    for angle, start in zip(state.angle_deg.tolist(), state.path.starts.tolist(), strict=True):
        if start or abs(angle - held) > step:
            held = angle
        course.append(held - angle)
    return np.array(course) / step


def second_axis(state: State, shape: Parameters) -> Array:
    """Second axis of the bench that swings to and fro with a period of its own in time."""
    phase = state.path.time_s / shape["period"] + shape["phase"]
    return np.clip(2.0 * np.abs(2.0 * (phase % 1.0) - 1.0) - 1.0, -0.6, 0.6) / 0.6


def ring_down(state: State, shape: Parameters) -> Array:
    """Resonance of the bench that rings down after each reversal."""
    turned, time = _reversals(state, shape), state.path.time_s
    since = np.full(len(time), np.inf)
    last, way = -np.inf, 0.0
    signs = np.zeros(len(time))
    for k in range(len(time)):
        if turned[k]:
            last, way = time[k], float(np.sign(state.path.load[k] - state.path.load[k - 1]))
        since[k], signs[k] = time[k] - last, way
    since = np.minimum(since, 1e3 * shape["ring"])
    wave = np.cos(2.0 * np.pi * since / shape["ring"])
    return np.asarray(signs * wave * np.exp(-since / (2.0 * shape["ring"])), dtype=float)


def play_wear(state: State, shape: Parameters) -> Array:
    """Free play that grows by a step with every full cycle of load."""
    side = np.sign(state.path.load)
    change = (np.diff(side, prepend=side[0]) != 0).cumsum() // 2
    return np.asarray(side * np.sqrt(change), dtype=float)


def stick_slip(state: State, shape: Parameters) -> Array:
    """Belt that sticks and slips by rate and state (Ruina's ageing law, quasi-static events)."""
    pull, held, course = 0.0, 0.0, []
    age = 0.0
    values, times = _torque(state, shape).tolist(), state.path.time_s.tolist()
    for k, value in enumerate(values):
        age += times[k] - times[k - 1] if k else 0.0
        pull = value - held
        limit = shape["grip"] * (1.0 + 0.15 * np.log1p(max(age, 0.0) / shape["period"] * 10.0))
        if abs(pull) > limit:
            held, age = value - 0.2 * pull, 0.0
        course.append((value - held) / shape["grip"])
    return np.array(course)


def play_by_position(state: State, shape: Parameters) -> Array:
    """Free play that depends on where the mesh is: worn teeth over a part of the turn."""
    mesh = np.deg2rad(state.path.crank_deg) - 2.0 * np.pi * shape["phase"]
    return np.sign(state.path.load) * np.maximum(np.cos(mesh), 0.0)


def joint_slip(state: State, shape: Parameters) -> Array:
    """Bolted joint that slips a little more whenever the load exceeds all loads before it."""
    value = np.abs(_torque(state, shape))
    most = np.maximum.accumulate(value)
    return np.floor(np.maximum(most - shape["start"] * 0.5, 0.0) / 0.12) * 0.5


def magnetised_sensor(state: State, shape: Parameters) -> Array:
    """Sensor magnetised by each large load of one sign: its zero stays until demagnetised."""
    on, course = 0.0, []
    for value in _torque(state, shape).tolist():
        if value > shape["high"]:
            on = max(on, (value - shape["high"]) / (1.0 - shape["high"]))
        elif value < -0.9 * shape["high"]:
            on *= 0.9
        course.append(on)
    return np.array(course)


def foldback(state: State, shape: Parameters) -> Array:
    """Amplifier that folds back: above a load its reading goes down again, on one side only."""
    beyond = np.maximum(_torque(state, shape) - 0.5 - 0.5 * shape["start"], 0.0)
    return -beyond / 0.25


def missed_counts(state: State, shape: Parameters) -> Array:
    """Encoder that loses counts in fast travel: each fast ramp leaves an offset behind."""
    step = np.diff(state.path.load, prepend=state.path.load[0])
    time = np.maximum(np.diff(state.path.time_s, prepend=state.path.time_s[0] - 1.0), 1e-3)
    speed = np.where(state.path.starts, 0.0, step / time)
    fast = np.abs(speed) > np.quantile(np.abs(speed), 0.75)
    return np.cumsum(np.where(fast, np.abs(step), 0.0)) / shape["top"] / 4.0


def pole_ripple(state: State, shape: Parameters) -> Array:
    """Torque from a motor's current with pole ripple: an error in proportion to the torque."""
    poles = 7.0
    turn = np.deg2rad(state.angle_deg) * poles * state.mesh_per_deg
    return _torque(state, shape) * np.sin(turn + 2.0 * np.pi * shape["phase"])


def _draw(rng: np.random.Generator, top: float, duration_s: float) -> dict[str, float]:
    return {
        "top": top,
        "high": float(rng.uniform(0.45, 0.75)),
        "low": float(rng.uniform(0.05, 0.3)),
        "start": float(rng.uniform(0.3, 0.6)),
        "stick": float(rng.uniform(0.01, 0.06)),
        "period": duration_s * float(rng.uniform(0.004, 0.03)),
        "ring": duration_s * float(rng.uniform(0.0005, 0.002)),
        "phase": float(rng.uniform()),
        "grip": float(rng.uniform(0.03, 0.12)),
    }


_NEEDS = {
    "second_axis": {"clock"},
    "ring_down": {"clock"},
    "stick_slip": {"clock"},
    "play_by_position": {"crank"},
    "missed_counts": {"clock"},
    "pole_ripple": {"input"},
}
_COURSES = (
    loose_coupling,
    cam_switch,
    sticking_encoder,
    second_axis,
    ring_down,
    play_wear,
    stick_slip,
    play_by_position,
    joint_slip,
    magnetised_sensor,
    foldback,
    missed_counts,
    pole_ripple,
)
LAWS = tuple(
    Law(f.__name__, "stranger", (f.__doc__ or ""), _draw, f, frozenset(_NEEDS.get(f.__name__, ())))
    for f in _COURSES
)
STRANGERS = tuple(law.effect for law in LAWS)
"""Names of the causes outside the vocabulary."""
