"""What people write today: active pins counted at 720 positions of the mesh zone a variant.

Only the counts are by brute force; everything else is left to the closed forms, which flatters
these opponents. Their figures are those of a grid, so they agree with ours to its step only.
"""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from opponents import numba_closed, numpy_closed
from opponents.common import Constants, Reals

__all__ = ["STEPS", "run_numba", "run_numpy"]

STEPS = 720
C = Constants()
RATIO, DISCS = C.ratio, C.discs


def run_numpy(axes: tuple[Reals, ...]) -> Reals:
    """NumPy: an array of variants by positions for each hole."""
    out = numpy_closed.run(axes)
    pins, clocking = axes[1], axes[5] / 360.0
    delta = np.arcsin(axes[0] / (2.0 * axes[2])) / (2.0 * np.pi)
    theta = (np.arange(STEPS) + 0.5) / STEPS
    published = np.zeros((len(pins), STEPS))
    inside = np.zeros((len(pins), STEPS))
    shares = np.zeros((len(pins), STEPS))
    spin = theta * (1.0 + 1.0 / RATIO)
    shrink = RATIO / (RATIO + 1.0)
    for hole in range(int(pins.max())):
        there = (hole < pins)[:, None]
        first = (clocking + (hole + 0.5) / pins)[:, None]
        reduced = first - np.ceil(first - 0.5)
        pitch = (1.0 / pins)[:, None]
        right = reduced > 0.0
        phi = np.where(right, -reduced, reduced)
        nearest = phi > -pitch + np.where(right, -1e-12, 1e-12)
        position = np.where(right, 1.0 - theta, theta)
        opens = np.maximum((phi + 0.25 + delta[:, None]) * shrink, 0.0)
        closes = (phi + 0.75 - delta[:, None]) * shrink
        closes = np.where(nearest, closes, np.minimum(closes, 0.5))
        published += there & (position >= opens) & (position < closes)
        for disc in range(int(DISCS)):
            psi = 2.0 * np.pi * (spin + disc / DISCS - first)
            inside += there & (np.cos(psi) < -np.sin(2.0 * np.pi * delta)[:, None])
            shares += there * np.maximum(np.sin(psi), 0.0) ** 2
    out[0] = DISCS * published.mean(axis=1)
    out[1] = DISCS * published.min(axis=1)
    out[2] = DISCS * published.max(axis=1)
    out[3] = out[5] = out[0] / (0.5 * DISCS * pins)
    out[4] = inside.mean(axis=1) / (0.5 * DISCS * pins)
    out[6] = shares.mean(axis=1) / pins
    return out


@nb.njit(parallel=True, error_model="numpy")
def _count(e_mm, count, circle_mm, clocking_deg, out):
    shrink = RATIO / (RATIO + 1.0)
    for k in nb.prange(len(count)):
        pins, clocking = int(count[k]), clocking_deg[k] / 360.0
        threshold = e_mm[k] / (2.0 * circle_mm[k])
        delta = math.asin(threshold) / (2.0 * math.pi)
        pitch = 1.0 / pins
        sum_published, sum_inside, sum_shares, least, most = 0, 0, 0.0, 1 << 30, 0
        for step in range(STEPS):
            theta = (step + 0.5) / STEPS
            spin = theta * (1.0 + 1.0 / RATIO)
            active = 0
            for hole in range(pins):
                first = clocking + (hole + 0.5) * pitch
                reduced = first - math.ceil(first - 0.5)
                right = reduced > 0.0
                phi = -reduced if right else reduced
                position = 1.0 - theta if right else theta
                closes = (phi + 0.75 - delta) * shrink
                if phi <= -pitch + (-1e-12 if right else 1e-12):
                    closes = min(closes, 0.5)
                opens = max((phi + 0.25 + delta) * shrink, 0.0)
                active += opens <= position < closes
                for disc in range(int(DISCS)):
                    psi = 2.0 * math.pi * (spin + disc / DISCS - first)
                    sum_inside += math.cos(psi) < -threshold
                    sum_shares += max(math.sin(psi), 0.0) ** 2
            sum_published += active
            least, most = min(least, active), max(most, active)
        contacts = 0.5 * DISCS * pins
        out[0, k] = DISCS * sum_published / STEPS
        out[1, k], out[2, k] = DISCS * least, DISCS * most
        out[3, k] = out[5, k] = out[0, k] / contacts
        out[4, k] = sum_inside / STEPS / contacts
        out[6, k] = sum_shares / STEPS / pins


def run_numba(axes: tuple[Reals, ...]) -> Reals:
    """Numba, parallel over variants: a loop over positions, holes and discs."""
    out = numba_closed.run(axes)
    _count(axes[0], axes[1], axes[2], axes[5], out)
    return out
