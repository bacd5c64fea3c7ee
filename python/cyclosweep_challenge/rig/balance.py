"""Torque balance at the input, solved reading by reading: pins, bristles and lubricant."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.bristles import Bristles
from cyclosweep_challenge.rig.elastic import ElasticLaw
from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]

TOLERANCE_NM = 1e-10


@dataclass(frozen=True)
class Resistance:
    """What opposes the shaft besides the pins.

    Attributes
    ----------
    bristles, load_bristles : Bristles
        Bundles with a constant limit, and with a limit in proportion to the pins' load.
    coulomb_nm : float
        Friction of the first bundle [N m].
    friction_ratio : float
        Friction of the second bundle over the transmitted torque [-].
    drag_nms_per_deg : float
        Lubricant's torque per rate of the input [N m s/deg].
    """

    bristles: Bristles
    load_bristles: Bristles
    coulomb_nm: float
    friction_ratio: float
    drag_nms_per_deg: float

    @property
    def absent(self) -> bool:
        """Whether nothing resists."""
        return (
            self.coulomb_nm == 0.0 and self.friction_ratio == 0.0 and self.drag_nms_per_deg == 0.0
        )


class _Bundle:
    """State of both bundles of bristles as one set of arrays."""

    def __init__(self, resistance: Resistance, rated_nm: float) -> None:
        plain, loaded = resistance.bristles, resistance.load_bristles
        constant = resistance.coulomb_nm * plain.share
        ratio = resistance.friction_ratio * loaded.share
        used = []
        if resistance.coulomb_nm > 0.0:
            used.append((constant, np.zeros_like(constant), constant / plain.slip_distance_deg))
        if resistance.friction_ratio > 0.0:
            used.append((np.zeros_like(ratio), ratio, ratio * rated_nm / loaded.slip_distance_deg))
        if not used:
            used.append((np.zeros(1), np.zeros(1), np.zeros(1)))
        self.constant, self.ratio, self.stiffness = (
            np.concatenate([part[k] for part in used]) for k in range(3)
        )
        self.force = np.zeros_like(self.constant)

    def rest(self) -> None:
        """Forget all bending."""
        self.force = np.zeros_like(self.constant)

    def trial(self, travel_deg: float, carried_nm: float) -> tuple[Array, float, float]:
        """Return the forces after a travel, their sum, and its slope in the travel."""
        limit = self.constant + self.ratio * carried_nm
        bent = self.force + self.stiffness * travel_deg
        force = np.minimum(np.maximum(bent, -limit), limit)
        sticking = float(self.stiffness[force == bent].sum())
        return force, float(force.sum()), sticking


@dataclass(frozen=True)
class Balanced:
    """Outcome of the balance at every sample.

    Attributes
    ----------
    carried_nm : array
        Torque through the pins, not signed [N m]; zero where the shaft is off its flank.
    crept_deg : array
        Delayed part of the twist, signed [deg].
    on_flank : array of bool
        Whether the pins of the side that the torque pulls to are in contact.
    """

    carried_nm: Array
    crept_deg: Array
    on_flank: NDArray[np.bool_]


@dataclass
class CreepState:
    """Coefficients of one step of the creep chain and its cells' state, signed [deg]."""

    decay: list[Array]
    from_before: list[Array]
    from_now: list[Array]

    @property
    def absent(self) -> bool:
        """Whether there is no creep to follow."""
        return not self.decay


def effective_lapse(programme: Programme) -> Array:
    """Time over which the flank was loaded before each sample [s].

    The first sample of a run, and the first past the dead zone, count from the moment the
    torque left zero on the way there.
    """
    torque = programme.torque_nm
    lapse = np.diff(programme.time_s, prepend=programme.time_s[:1])
    before = np.concatenate(([0.0], torque[:-1]))
    crossing = before * torque < 0.0
    part = np.abs(torque) / np.maximum(np.abs(torque) + np.abs(before), 1e-12)
    lapse = np.where(crossing, lapse * part, lapse)
    start = programme.run_starts
    rate = np.maximum(np.abs(programme.rate_nm_per_s()), 1e-6)
    return np.where(start, np.abs(torque) / rate, lapse)


def solve_free(programme: Programme, creep: CreepState) -> Balanced:
    """Balance with nothing but the pins: they carry what is applied."""
    torque = programme.torque_nm
    crept = np.zeros(len(programme))
    if not creep.absent:
        start = programme.run_starts
        cells = np.zeros_like(creep.decay[0])
        for k in range(len(programme)):
            before = 0.0
            if start[k]:
                cells = np.zeros_like(cells)
            else:
                before = torque[k - 1]
            cells = (
                creep.decay[k] * cells
                + creep.from_before[k] * before
                + creep.from_now[k] * torque[k]
            )
            crept[k] = cells.sum()
    return Balanced(np.abs(torque), crept, np.ones(len(programme), dtype=bool))


def solve_resisted(
    programme: Programme,
    laws: list[ElasticLaw],
    law_of: NDArray[np.int64],
    half_play_deg: float,
    resistance: Resistance,
    creep: CreepState,
    rated_nm: float,
) -> Balanced:
    """Balance against bristles and lubricant, one reading after the other.

    The unknown is the torque through the pins; the twist follows from it through the elastic
    law and the creep chain, the bristles and the lubricant from the twist. The sum rises with
    the unknown, so Newton's step inside a shrinking bracket always ends at the one root.
    """
    count = len(programme)
    lapse = effective_lapse(programme)
    start = programme.run_starts
    torque = programme.torque_nm
    carried = np.zeros(count)
    crept = np.zeros(count)
    on_flank = np.zeros(count, dtype=bool)
    bundle = _Bundle(resistance, rated_nm)
    drag = resistance.drag_nms_per_deg
    tables = [(law.torque_nm.tolist(), law.twist_deg.tolist()) for law in laws]
    cells = np.zeros_like(creep.decay[0]) if not creep.absent else np.zeros(0)
    position, flank_twist, before, side_before = 0.0, 0.0, 0.0, 0.0
    for k in range(count):
        if start[k]:
            # A run starts in the middle of the play, with the bristles at rest.
            bundle.rest()
            cells = np.zeros_like(cells)
            position, flank_twist, before, side_before = 0.0, 0.0, 0.0, 0.0
        side = 1.0 if torque[k] > 0.0 else -1.0
        applied = abs(float(torque[k]))
        fixed, gain = 0.0, 0.0
        if cells.size:
            settled = creep.decay[k] * cells + creep.from_before[k] * before
            fixed, gain = side * float(settled.sum()), float(creep.from_now[k].sum())
        loads, twists = tables[int(law_of[k])]
        viscous = drag / max(float(lapse[k]), 1e-9)
        start_twist = flank_twist if side == side_before else 0.0
        low, high = (
            0.0,
            max(applied, before * side)
            + 2.0 * float((bundle.constant + bundle.ratio * applied).sum()),
        )
        guess = min(max(applied, 0.0), high)
        force = bundle.force
        twist = 0.0
        for _ in range(80):
            j = min(max(bisect_right(loads, guess) - 1, 0), len(loads) - 2)
            slope = (twists[j + 1] - twists[j]) / (loads[j + 1] - loads[j])
            twist = twists[j] + slope * (guess - loads[j]) + fixed + gain * guess
            travel = side * (half_play_deg + twist) - position
            force, total, sticking = bundle.trial(travel, guess)
            miss = guess + side * total + viscous * (twist - start_twist) - applied
            if abs(miss) < TOLERANCE_NM or high - low < 1e-13:
                break
            if miss > 0.0:
                high = guess
            else:
                low = guess
            step = guess - miss / (1.0 + (sticking + viscous) * (slope + gain))
            guess = step if low < step < high else 0.5 * (low + high)
        contact = guess > 1e-9
        if contact:
            bundle.force = force
            position = side * (half_play_deg + twist)
            carried[k] = guess
        on_flank[k] = contact
        now = side * carried[k]
        if cells.size:
            cells = settled + creep.from_now[k] * now
            crept[k] = float(cells.sum())
        flank_twist, before, side_before = twist, now, side
    return Balanced(carried, crept, on_flank)
