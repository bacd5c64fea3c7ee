"""Torque balance: what friction and drag leave of the applied torque to twist the drive."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.laws.friction import Resistance
from cyclosweep_challenge.second_generator.path import SMALLEST, Path

Array = NDArray[np.float64]

FINEST, COARSEST = 0.01, 0.1
"""Bounds of an increment of torque [rated torques]."""
ITERATIONS = 12
"""Steps of Newton's method alone, before its steps alternate with halving the bracket: friction
that turns is steep on one side and level on the other, between which Newton's steps can cycle."""
BRACKETED = 100
"""Steps after which an increment is taken as it is."""
CLOSE = 1e-9
"""Imbalance at which an increment is solved [rated torques]."""


def solve(path: Path, resistances: Sequence[Resistance], reach: float) -> tuple[Array, Array]:
    """Elastic torque and side of the play for every reading.

    Applied torque = elastic torque + resisting torques, solved with Newton's method over small
    increments. When the elastic torque vanishes the flanks part, the shaft travels through its
    play and all friction slides; they touch again where the torque exceeds the friction.

    Parameters
    ----------
    path : Path
        Load programme.
    resistances : sequence of Resistance
        Resisting torques.
    reach : float
        Shortest presliding travel among them, which sets the increments [rated torques].

    Returns
    -------
    elastic : array, shape (N,)
        Elastic torque, zero within the play [rated torques].
    side : array, shape (N,)
        Side on which the flanks touch, zero within the play.
    """
    if not resistances:
        return path.load.copy(), np.where(np.abs(path.load) < SMALLEST, 0.0, np.sign(path.load))
    increment = min(max(0.25 * reach, FINEST), COARSEST)
    loads, times, starts = path.load.tolist(), path.time_s.tolist(), path.starts.tolist()
    elastic, side = [0.0] * len(loads), [0.0] * len(loads)
    now, load, touch, clock = 0.0, 0.0, 0.0, 0.0
    for row, target in enumerate(loads):
        if starts[row]:
            now, load, touch = 0.0, 0.0, 0.0
            clock = times[row] - 1.0
            for r in resistances:
                r.rest()
        parts = max(1, int(abs(target - load) / increment + 0.999))
        dt = max((times[row] - clock) / parts, 1e-6)
        first = load
        for part in range(1, parts + 1):
            load = first + (target - first) * part / parts
            now, touch = _advance(now, touch, load, dt, resistances)
        clock = times[row]
        elastic[row], side[row] = now, touch
    return np.array(elastic), np.array(side)


def _advance(
    now: float, touch: float, load: float, dt: float, resistances: Sequence[Resistance]
) -> tuple[float, float]:
    """Elastic torque and side after one increment of the applied torque."""
    if touch == 0.0:
        way = 1.0 if load > 0.0 else -1.0
        for r in resistances:
            r.saturate(way)
        if way * (load - sum(r.torque for r in resistances)) <= 0.0:
            return 0.0, 0.0
        touch = way
    twist, slope = now, 1.0
    low, high = -math.inf, math.inf
    for iteration in range(BRACKETED):
        total, slope = twist, 1.0
        for r in resistances:
            torque, rise = r.trial(twist, twist - now, dt)
            total += torque
            slope += rise
        gap = load - total
        if -CLOSE < gap < CLOSE:
            break
        low, high = (twist, high) if gap > 0.0 else (low, twist)
        twist += gap / slope
        cycles = iteration >= ITERATIONS and math.isfinite(high - low)
        if cycles and (iteration % 2 == 0 or not low < twist < high):
            twist = 0.5 * (low + high)
    if touch * twist <= 0.0:
        return 0.0, 0.0
    for r in resistances:
        r.keep(twist, twist - now, dt)
    return twist, touch
