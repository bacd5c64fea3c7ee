"""NumPy, vectorised: the same closed forms, whole columns at a time."""

from __future__ import annotations

import numpy as np

from opponents.common import COLUMNS, LOADS_TN, Constants, Reals

__all__ = ["run"]

C = Constants()
SHEAR = C.youngs / (2.0 * (1.0 + C.poisson))
SCALE = 32.0 / (np.pi * SHEAR)
COWPER = 6.0 * (1.0 + C.poisson) / (7.0 + 6.0 * C.poisson)
TRAVEL = 1.0 + 1.0 / C.ratio
ARCMIN = 10_800.0 / np.pi


def _floor_integral(y: Reals) -> Reals:
    n = np.floor(y)
    return n * (0.5 * (n - 1.0) + (y - n))


def _half(pins: Reals, delta: Reals, nearest: Reals, holes: Reals) -> tuple[Reals, ...]:
    end = 0.5 * pins * TRAVEL
    opens = nearest + (0.25 + delta) * pins
    closes = nearest + (0.75 - delta) * pins
    late = np.ceil(opens)
    still = np.maximum(np.floor(closes - end) + 1.0, 0.0)
    clipped = np.maximum(still, 1.0)
    triangles = holes * (holes - 1.0) - clipped * (clipped - 1.0)
    ends = (clipped - 1.0) * end + (holes - clipped) * closes + closes - 0.5 * triangles
    return closes, end, holes - late, still, ends - late * (opens - 0.5 * (late - 1.0))


def _extremes(
    closes: Reals, end: Reals, start: Reals, still: Reals, holes: Reals, joins: Reals
) -> tuple[Reals, Reals]:
    joined = joins < end
    before = np.minimum(np.floor(closes - joins) + 1.0, holes)
    least = np.where(
        joined, np.minimum(np.minimum(start, before), still + 1.0), np.minimum(start, still)
    )
    return least, holes + (joined & (joins < closes - (holes - 1.0)))


def published_map(pins: Reals, delta: Reals, clocking: Reals) -> tuple[Reals, Reals, Reals]:
    """Mean, least and largest number of active contacts."""
    base = clocking * pins + 0.5
    nearest = base - np.ceil(base)
    holes = np.minimum(np.floor(0.5 * pins + nearest) + 1.0, pins)
    lc, le, ls, la, ll = _half(pins, delta, nearest, holes)
    rc, re, rs, ra, rl = _half(pins, delta, -nearest - 1.0, pins - holes)
    low_l, high_l = _extremes(lc, le, ls, la, holes, 2.0 * re - rc)
    low_r, high_r = _extremes(rc, re, rs, ra, pins - holes, 2.0 * le - lc)
    mean = C.discs * (ll + rl) / (pins * TRAVEL)
    return mean, C.discs * np.minimum(low_l, low_r), C.discs * np.maximum(high_l, high_r)


def inside_mean(pins: Reals, delta: Reals, clocking: Reals) -> Reals:
    """Mean number of active contacts by the criterion `inside`, two discs."""
    fold = np.where(pins % 2 == 0, 2.0, 1.0)
    lattice = pins / fold * C.discs
    low, high = 0.25 + delta, 0.75 - delta
    width = (high - low) * lattice
    first = clocking + 0.5 / pins
    up = (
        _floor_integral((TRAVEL - first - low) * lattice)
        - _floor_integral((-first - low) * lattice)
        - _floor_integral((TRAVEL - first - high) * lattice)
        + _floor_integral((-first - high) * lattice)
    )
    whole = np.floor(width) == np.ceil(width)
    return np.where(whole, width * fold, fold * up / (lattice * TRAVEL))


def run(axes: tuple[Reals, ...]) -> Reals:
    """Return the table, one row a column of ``COLUMNS``."""
    e_mm, pins, circle_mm, diameter_mm, length_mm, clocking_deg, l1_mm, d3_mm = axes
    e, circle, diameter = e_mm * 1e-3, circle_mm * 1e-3, diameter_mm * 1e-3
    length, l1, d3 = length_mm * 1e-3, l1_mm * 1e-3, d3_mm * 1e-3
    clocking = clocking_deg / 360.0
    d1, d2, _, d4, d5 = C.shaft_diameters
    _, l2, l3, l4, l5 = C.shaft_lengths
    ratio5 = d5 / C.shaft_end
    fixed = (
        l2 / d2**4
        + l4 / d4**4
        + (1.0 - (d4 / d5) ** 3) / (8.0 * d4**3)
        + l5 / (3.0 * d5**3 * C.shaft_end) * (1.0 + ratio5 + ratio5 * ratio5)
    )
    k1 = e * ((C.ratio + 1.0) / C.ring)
    hole = diameter + 2.0 * C.wall + 2.0 * e
    web = np.minimum(2.0 * circle * np.sin(np.pi / pins) - hole, C.rim - circle - 0.5 * hole)
    web = np.minimum(web, circle - 0.5 * hole - C.hub)
    good = (e > 0.0) & (k1 < 1.0) & (e < 2.0 * circle) & (diameter > 0.0) & (length > 0.0)
    good &= (l1 > 0.0) & (d3 >= d2) & (d3 <= d4) & (pins >= 3) & (pins <= 64) & (web > 0.0)
    delta = np.arcsin(e / (2.0 * circle)) / (2.0 * np.pi)
    mean, least, most = published_map(pins, delta, clocking)
    contacts = 0.5 * C.discs * pins
    efficiency = mean / contacts
    participation = 0.25 * C.discs
    cube = d3 * d3 * d3
    shoulder = (1.0 - d2**3 / cube) / (8.0 * d2**3) + (1.0 - cube / d4**3) / (8.0 * cube)
    keyway = l1 * ((1.0 + C.keyway * C.keyway_depth / d1) / d1**4)
    shaft = SCALE * (keyway + l3 / (cube * d3) + shoulder + fixed)
    square = diameter * diameter
    bending = length * length * length * (64.0 / (3.0 * C.youngs * np.pi)) / (square * square)
    flexibility = bending + length * (4.0 / (COWPER * SHEAR * np.pi)) / square
    pin = flexibility / (circle * circle)
    compliance = shaft + pin / pins
    reflected = compliance * C.ratio**2
    stiffness = 1.0 / reflected
    slope = np.degrees(efficiency * (reflected * C.nominal))
    force = 4.0 * C.torque / C.discs / (pins * circle)
    inside = inside_mean(pins, delta, clocking) / contacts
    columns: list[Reals | float] = [
        *(mean, least, most, efficiency, inside, efficiency),
        *(participation, 1.0 if C.discs <= 2 else 0.0),
        *(hole * 1e3, web * 1e3, k1, C.nominal),
        np.sqrt(stiffness / C.inertia) / (2.0 * np.pi),
        *(shaft, pin, compliance, shaft + pin / (pins * participation)),
        *(reflected, stiffness, 1.0 / (compliance * ARCMIN)),
        *(force, force * length * (32e-6 / np.pi) / (square * diameter)),
        *(slope * load + C.free_play for load in LOADS_TN),
    ]
    out = np.empty((len(COLUMNS), len(e)))
    for row, column in zip(out, columns, strict=True):
        row[:] = column
    out[:, ~good] = np.nan
    return out
