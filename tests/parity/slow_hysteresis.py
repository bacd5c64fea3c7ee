"""Slow plain-NumPy twins of the history operators, kept on purpose to check the core against."""

import numpy as np

from tests.support.arrays import Floats, Mask


def solve_slip(
    torque: Floats,
    offset: Floats,
    restart: Mask,
    start: Floats,
    slip: Floats,
    share: Floats,
    play: float,
    compliance: float,
    limit: float,
    load: float = 0.0,
) -> tuple[Floats, Floats]:
    """Balance of torques by bisection, one sample after the other."""
    angle, friction = np.zeros(len(torque)), np.zeros(len(torque))
    anchor = np.full(len(slip), start[0])

    def elastic(twist: float) -> float:
        return float(np.sign(twist)) * max(abs(twist) - play, 0.0) / compliance

    def force(at: float, base: float) -> float:
        state = float(np.sum(share * np.clip((at - anchor) / slip, -1, 1)))
        return (limit + load * abs(elastic(at - base))) * state

    for i in range(len(torque)):
        if i and restart[i]:
            anchor = np.full(len(slip), start[i])
        reach = play + compliance * (abs(torque[i]) + limit) / (1 - load) + 1.0
        low, high = offset[i] - reach, offset[i] + reach
        for _ in range(200):
            middle = 0.5 * (low + high)
            if elastic(middle - offset[i]) + force(middle, offset[i]) < torque[i]:
                low = middle
            else:
                high = middle
        angle[i] = 0.5 * (low + high)
        friction[i] = force(angle[i], offset[i])
        anchor = np.clip(anchor, angle[i] - slip, angle[i] + slip)
    return angle, friction


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


def dragged(load: Floats, lapse: Floats, restart: Mask, lag: float) -> list[float]:
    """Root of ``u - x - lag (x - before)/lapse``, found by bisection instead of division."""
    out, before = [], 0.0
    for u, h, fresh in zip(load, lapse, restart, strict=True):
        before = 0.0 if fresh else before
        low, high = min(u, before) - 1.0, max(u, before) + 1.0
        for _ in range(200):
            x = 0.5 * (low + high)
            low, high = (x, high) if u - x - lag * (x - before) / h > 0 else (low, x)
        before = x
        out.append(x)
    return out
