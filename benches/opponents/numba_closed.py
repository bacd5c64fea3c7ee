"""Numba, parallel: the same closed forms, one variant a turn of the loop, constants hoisted."""

from __future__ import annotations

import math

import numba as nb
import numpy as np

from opponents.common import COLUMNS, LOADS_TN, Constants, Reals

__all__ = ["run"]

C = Constants()
PI = math.pi
SHEAR = C.youngs / (2.0 * (1.0 + C.poisson))
SCALE = 32.0 / (PI * SHEAR)
COWPER = 6.0 * (1.0 + C.poisson) / (7.0 + 6.0 * C.poisson)
SPIN = 1.0 / C.ratio
TRAVEL = 1.0 + SPIN
D1, D2, D3, D4, D5 = C.shaft_diameters
_, L2, L3, L4, L5 = C.shaft_lengths
KEYWAY_PER_LENGTH = (1.0 + C.keyway * C.keyway_depth / D1) / D1**4
_R5 = D5 / C.shaft_end
# Segments two, four and five, and the shoulder onto the fifth, are the same for every variant.
FIXED = (
    L2 / D2**4
    + L4 / D4**4
    + (1.0 - (D4 / D5) ** 3) / (8.0 * D4**3)
    + L5 / (3.0 * D5**3 * C.shaft_end) * (1.0 + _R5 + _R5 * _R5)
)
LOADS = np.array(LOADS_TN)
SIN_HALF_PITCH = np.array([math.sin(PI / max(n, 1)) for n in range(65)])
EDGE = 1e-9
ARCMIN = 10_800.0 / PI
RATIO, DISCS, RING = C.ratio, C.discs, C.ring
WALL, RIM, HUB = C.wall, C.rim, C.hub
YOUNGS, TORQUE, NOMINAL = C.youngs, C.torque, C.nominal
FREE_PLAY, INERTIA = C.free_play, C.inertia
STATICS = 1.0 if C.discs <= 2 else 0.0


@nb.njit(inline="always")
def floor_integral(y):
    n = math.floor(y)
    return n * (0.5 * (n - 1.0) + (y - n))


@nb.njit(inline="always")
def half(pins, delta, nearest, holes):
    """Counts and window lengths of one half's holes, in pitches."""
    end = 0.5 * pins * TRAVEL
    opens = nearest + (0.25 + delta) * pins
    closes = nearest + (0.75 - delta) * pins
    late = math.ceil(opens)
    still = max(math.floor(closes - end) + 1.0, 0.0)
    clipped = max(still, 1.0)
    ends = (
        (clipped - 1.0) * end
        + (holes - clipped) * closes
        + closes
        - 0.5 * (holes * (holes - 1.0) - clipped * (clipped - 1.0))
    )
    length = ends - late * (opens - 0.5 * (late - 1.0))
    return closes, end, holes - late, still, length


@nb.njit(inline="always")
def extremes(closes, end, at_start, at_end, holes, joins):
    first = closes - (holes - 1.0)
    if joins > end:
        return min(at_start, at_end), holes
    before = min(math.floor(closes - joins) + 1.0, holes)
    most = holes + 1.0 if joins < first else holes
    return min(at_start, before, at_end + 1.0), most


@nb.njit(inline="always")
def published_map(pins, delta, clocking):
    base = clocking * pins + 0.5
    nearest = base - math.ceil(base)
    if nearest < EDGE - 1.0:
        nearest += 1.0
    holes = min(math.floor(0.5 * pins + nearest) + 1.0, pins)
    lc, le, ls, la, ll = half(pins, delta, nearest, holes)
    rc, re, rs, ra, rl = half(pins, delta, -nearest - 1.0, pins - holes)
    low_l, high_l = extremes(lc, le, ls, la, holes, 2.0 * re - rc)
    low_r, high_r = extremes(rc, re, rs, ra, pins - holes, 2.0 * le - lc)
    mean = DISCS * (ll + rl) / (pins * TRAVEL)
    return mean, DISCS * min(low_l, low_r), DISCS * max(high_l, high_r)


@nb.njit(inline="always")
def inside_mean(pins, delta, clocking):
    fold = 2.0 if pins % 2 == 0 else 1.0
    lattice = pins / fold * DISCS
    low, high = 0.25 + delta, 0.75 - delta
    width = (high - low) * lattice
    if math.floor(width) == math.ceil(width):
        return width * fold
    first = clocking + 0.5 / pins
    up = (
        floor_integral((TRAVEL - first - low) * lattice)
        - floor_integral((-first - low) * lattice)
        - floor_integral((TRAVEL - first - high) * lattice)
        + floor_integral((-first - high) * lattice)
    )
    return fold * up / (lattice * TRAVEL)


@nb.njit(parallel=True, error_model="numpy")
def kernel(e_mm, count, circle_mm, diameter_mm, length_mm, clocking_deg, l1_mm, d3_mm, out):
    for k in nb.prange(len(e_mm)):
        e, pins, circle = e_mm[k] * 1e-3, count[k], circle_mm[k] * 1e-3
        diameter, length = diameter_mm[k] * 1e-3, length_mm[k] * 1e-3
        l1, d3 = l1_mm[k] * 1e-3, d3_mm[k] * 1e-3
        clocking = clocking_deg[k] * (1.0 / 360.0)
        k1 = e * (RATIO + 1.0) / RING
        hole = diameter + 2.0 * WALL + 2.0 * e
        between = 2.0 * circle * SIN_HALF_PITCH[int(pins)] - hole
        outer = RIM - circle - 0.5 * hole
        inner = circle - 0.5 * hole - HUB
        web = min(between, outer, inner)
        good = (
            e > 0.0
            and k1 < 1.0
            and e < 2.0 * circle
            and diameter > 0.0
            and length > 0.0
            and l1 > 0.0
            and D2 <= d3 <= D4
            and 3.0 <= pins <= 64.0
            and web > 0.0
        )
        if not good:
            for column in range(out.shape[0]):
                out[column, k] = math.nan
            continue
        delta = math.asin(e / (2.0 * circle)) / (2.0 * PI)
        mean, least, most = published_map(pins, delta, clocking)
        contacts = 0.5 * DISCS * pins
        efficiency = mean / contacts
        participation = 0.25 * DISCS
        shoulder = (1.0 - (D2 / d3) ** 3) / (8.0 * D2**3) + (1.0 - (d3 / D4) ** 3) / (8.0 * d3**3)
        shaft = SCALE * (l1 * KEYWAY_PER_LENGTH + L3 / d3**4 + shoulder + FIXED)
        square = diameter * diameter
        bending = length**3 * 64.0 / (3.0 * YOUNGS * PI * square * square)
        flexibility = bending + length * 4.0 / (COWPER * SHEAR * PI * square)
        pin = flexibility / (circle * circle)
        compliance = shaft + pin / pins
        reflected = compliance * RATIO**2
        slope = math.degrees(efficiency * (reflected * NOMINAL))
        force = 4.0 * TORQUE / (DISCS * pins * circle)
        out[0, k] = mean
        out[1, k] = least
        out[2, k] = most
        out[3, k] = efficiency
        out[4, k] = inside_mean(pins, delta, clocking) / contacts
        out[5, k] = efficiency
        out[6, k] = participation
        out[7, k] = STATICS
        out[8, k] = hole * 1e3
        out[9, k] = web * 1e3
        out[10, k] = k1
        out[11, k] = NOMINAL
        stiffness = 1.0 / reflected
        out[12, k] = math.sqrt(stiffness / INERTIA) / (2.0 * PI)
        out[13, k] = shaft
        out[14, k] = pin
        out[15, k] = compliance
        out[16, k] = shaft + pin / (pins * participation)
        out[17, k] = reflected
        out[18, k] = stiffness
        out[19, k] = 1.0 / (compliance * ARCMIN)
        out[20, k] = force
        out[21, k] = force * length * 32.0 / (PI * square * diameter) * 1e-6
        for load in range(LOADS.size):
            out[22 + load, k] = slope * LOADS[load] + FREE_PLAY


def run(axes: tuple[Reals, ...]) -> Reals:
    """Return the table, one row a column of ``COLUMNS``."""
    out = np.empty((len(COLUMNS), len(axes[0])))
    kernel(*axes, out)
    return out
