"""A rig whose mesh travels while it twists: a staircase along the twist, and friction beside it.

The twist of every sample is solved by bisection from the balance of torques. It shares no law and
no code with the simulation.
"""

import itertools
from collections.abc import Sequence

import numpy as np

import cyclosweep as cs
from tests.support.arrays import Floats

COMPLIANCE = 19.8 / 7.2575
PLAY = 28.0
RATE = 0.5
"""Rate of the torque [N m/s]."""


def ramp(points: Sequence[float], step: float) -> Floats:
    """Torque that goes from point to point in equal steps [N m]."""
    out = [points[0]]
    for a, b in itertools.pairwise(points):
        count = max(int(abs(b - a) / step), 2)
        out += list(np.linspace(a, b, count + 1)[1:])
    return np.array(out)


def staircase(angle: Floats | float, waves: Sequence[tuple[float, float, float]]) -> Floats:
    """Error of the mesh at an angle [deg]: order, amplitude [deg] and angle of the crest [deg]."""
    total = np.zeros_like(np.asarray(angle, dtype=np.float64))
    for order, size, crest in waves:
        total = total + size * np.cos(np.radians(order * (np.asarray(angle) - crest)))
    return np.asarray(total)


def twist(
    torque: Floats,
    waves: Sequence[tuple[float, float, float]],
    friction_nm: float = 0.0,
    scale: float = 1.0,
) -> Floats:
    """Twist of one run [deg], each sample solved by bisection.

    ``scale`` is the measured angle over that of the input: 1, or one over the ratio. Friction acts
    through three elements that stick and slip at distances of their own.
    """
    reach = np.array([0.8, 2.0, 5.0]) * scale
    limit = friction_nm * np.array([0.4, 0.35, 0.25])

    def slipped(held: Floats, travelled: float) -> Floats:
        return np.clip(held + limit / reach * travelled, -limit, limit)

    def torque_at(angle: float, held: Floats, before: float) -> float:
        straight = angle - scale * float(staircase(angle / scale, waves))
        beyond = np.sign(straight) * max(abs(straight) - PLAY * scale, 0.0)
        return float(beyond / (COMPLIANCE * scale) + slipped(held, angle - before).sum())

    held, before = np.zeros(3), PLAY * scale
    out = np.zeros(len(torque))
    for i, applied in enumerate(torque):
        low, high = -400.0 * scale, 400.0 * scale
        for _ in range(60):
            middle = 0.5 * (low + high)
            below = torque_at(middle, held, before) < applied
            low, high = (middle, high) if below else (low, middle)
        out[i] = 0.5 * (low + high)
        held, before = slipped(held, out[i] - before), out[i]
    return out


def recording(
    points: Sequence[Sequence[float]],
    waves: Sequence[tuple[float, float, float]],
    friction_nm: float = 0.0,
    *,
    noise_deg: float = 0.05,
    seed: int = 1,
    step: float = 0.5,
    crank_deg: float | None = None,
) -> cs.Recording:
    """Recording at the input of runs through these torques [N m], without a locking position."""
    rng = np.random.default_rng(seed)
    torque = [ramp(each, step) for each in points]
    angle = [twist(each, waves, friction_nm) for each in torque]
    run = np.concatenate([np.full(len(each), k + 1) for k, each in enumerate(torque)])
    values = np.concatenate(angle)
    return cs.Recording.from_arrays(
        np.concatenate(torque),
        values + noise_deg * rng.standard_normal(len(values)),
        run=run,
        time_s=step / RATE * np.arange(len(values)),
        crank_deg=None if crank_deg is None else np.full(len(values), crank_deg),
    )
