"""Slow plain-NumPy twins of the history operators, kept on purpose to check the core against."""

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.support.arrays import Floats, Mask

Law = Callable[[float], float]
"""Elastic torque [N m] over the twist beyond the dead zone [deg]."""


def line(compliance: float) -> Law:
    """Law of a spring."""
    return lambda beyond: beyond / compliance


def through(torque: Floats, twist: Floats) -> Law:
    """Law through points, the outermost two carried on beyond the ends."""

    def law(beyond: float) -> float:
        for k in range(1, len(twist)):
            if beyond <= twist[k] or k == len(twist) - 1:
                part = (beyond - twist[k - 1]) / (twist[k] - twist[k - 1])
                return float(torque[k - 1] + part * (torque[k] - torque[k - 1]))
        raise ValueError("a law needs two points")

    return law


def stretch_by(limit: float, reference: float, growth: float) -> float:
    """Factor on the presliding distances at a friction limit."""
    return 1.0 if growth == 0 else max(limit / reference, 1e-9) ** growth


def solve_slip(
    torque: Floats,
    offset: Floats,
    restart: Mask,
    start: Floats,
    slip: Floats,
    share: Floats,
    play: float,
    law: Law,
    limit: float,
    load: float = 0.0,
    growth: float = 0.0,
    reference_nm: float = 1.0,
    forgetting: float = 0.0,
    load_power: float = 0.0,
) -> tuple[Floats, Floats]:
    """Balance of torques by bisection, one sample after the other."""
    angle, friction = np.zeros(len(torque)), np.zeros(len(torque))
    anchor = np.full(len(slip), start[0])
    before, dahl = start[0], np.zeros(len(slip))

    def elastic(twist: float) -> float:
        if abs(twist) <= play:
            return 0.0
        return law(twist - play if twist > 0 else twist + play)

    def hold(twist: float) -> tuple[float, float]:
        """Friction limit, and how much longer the presliding distances are."""
        held = abs(elastic(twist))
        most = limit + load * held * ((1 + min(held / reference_nm, 4)) / 2) ** load_power
        return most, stretch_by(most, limit + load * reference_nm, growth)

    def force(at: float, base: float) -> float:
        most, stretch = hold(at - base)
        reach = slip * stretch
        slipping = np.clip((at - anchor) / reach, -1, 1)
        forgets = dahl_states(dahl, at - before, reach)
        return most * float(np.sum(share * ((1 - forgetting) * slipping + forgetting * forgets)))

    for i in range(len(torque)):
        if i and restart[i]:
            anchor = np.full(len(slip), start[i])
            before, dahl = start[i], np.zeros(len(slip))
        low, high = offset[i] - 1e4, offset[i] + 1e4
        for _ in range(60):
            middle = 0.5 * (low + high)
            if elastic(middle - offset[i]) + force(middle, offset[i]) < torque[i]:
                low = middle
            else:
                high = middle
        angle[i] = 0.5 * (low + high)
        friction[i] = force(angle[i], offset[i])
        reach = slip * hold(angle[i] - offset[i])[1]
        anchor = np.clip(anchor, angle[i] - reach, angle[i] + reach)
        dahl = dahl_states(dahl, angle[i] - before, reach)
        before = angle[i]
    return angle, friction


def dahl_states(states: Floats, way: float, reach: Floats) -> Floats:
    """Dahl's law in closed form along a way in one direction."""
    limit = 1.0 if way >= 0 else -1.0
    return np.asarray(limit - (limit - states) * np.exp(-abs(way) / reach))


def dahl_by_steps(state: float, way: float, reach: float, steps: int = 20_000) -> float:
    """Dahl's law, many small explicit steps."""
    step = way / steps
    for _ in range(steps):
        state += (np.sign(step) - state) * abs(step) / reach
    return state


def slip_state(
    angle: Floats, restart: Mask, start: Floats, stretch: Floats, slip: Floats, share: Floats
) -> Floats:
    """State of the elements along an angle, each element on its own."""
    out = np.zeros(len(angle))
    for distance, part in zip(slip, share, strict=True):
        anchor = start[0]
        for i in range(len(angle)):
            anchor = start[i] if i and restart[i] else anchor
            reach = distance * stretch[i]
            anchor = min(max(anchor, angle[i] - reach), angle[i] + reach)
            out[i] += part * (angle[i] - anchor) / reach
    return out


def remembered_datum(push: Floats, memory: float) -> Floats:
    """Datum of each run as a sum over all runs before."""
    return np.array(
        [sum(push[j] * memory ** (k - 1 - j) for j in range(k)) for k in range(len(push))]
    )


def creep_state(load: Floats, time: Floats, restart: Mask, tau: float, steps: int = 400) -> Floats:
    """Kelvin-Voigt state by many small explicit steps."""
    out = np.zeros(len(load))
    state = 0.0
    for i in range(len(load)):
        if i == 0 or restart[i]:
            state = 0.0
        else:
            h = (time[i] - time[i - 1]) / steps
            for k in range(steps):
                at = load[i - 1] + (load[i] - load[i - 1]) * (k + 0.5) / steps
                state += h * (at - state) / tau
        out[i] = state
    return out


def dragged(
    load: Floats,
    lapse: Floats,
    restart: Mask,
    lag: float,
    power: float = 1.0,
    reference_rate: float = 1.0,
    thinning_rate: float | None = None,
) -> list[float]:
    """Solution of ``u = x + drag(dx/dt)`` by an integrator that controls its error."""
    drag = lag * reference_rate

    def rate_of(resisted: float) -> float:
        if thinning_rate is None:
            return float(reference_rate * (resisted / drag) ** (1.0 / power))

        def law(rate: float) -> float:
            return float(rate * (1.0 + (rate / thinning_rate) ** 2) ** (0.5 * (power - 1.0)))

        wanted = resisted / drag * law(reference_rate)
        highest = 1.0
        while law(highest) < wanted:
            highest *= 2.0
        return float(brentq(lambda rate: law(rate) - wanted, 0.0, highest, xtol=1e-14))

    out, state, before = [], 0.0, 0.0
    for u, h, fresh in zip(load, lapse, restart, strict=True):
        state, before = (0.0, 0.0) if fresh else (state, before)

        def rate(t: float, x: Floats, u: float = u, h: float = h, start: float = before) -> Floats:
            gap = start + (u - start) * t / h - x
            return np.asarray(np.sign(gap) * rate_of(float(np.abs(gap)[0])))

        solved = solve_ivp(rate, (0.0, h), [state], "Radau", rtol=1e-8, atol=1e-10)
        state, before = float(solved.y[0, -1]), u
        out.append(state)
    return out
