"""Order of a staircase: whether its steps come at equal distances along the travel, and at which.

A torque that pulsates with the poles of a motor or the teeth of a mesh is rich in harmonics and
differs with the direction and the side of the load, so that no single wave explains much of it.
Its spectrum tells it all the same: the torque at equal angle has peaks at one order and at its
multiples. Steps that come at random places, however well they repeat, have none.
"""

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from cyclosweep.diagnosis.identify.fitting.repetition import StepOrder
from cyclosweep.diagnosis.whole_loop.both_ways import legs_of, profile
from cyclosweep.simulation.effects.history import Floats, Ints

LOADED = (0.08, 0.93)
"""Shares of the largest torque between which a leg is read: in contact, before it turns."""
CELLS = 150
"""Cells over a leg in which the torque is averaged."""
LOCAL = 8.0
"""Length of a leg over the width of the local line that is taken out (one standard deviation)."""
FEWEST_CELLS = 40
"""Cells of a leg below which it is left out."""
CYCLES = (2.0, 36.0)
"""Cycles in a leg between which its spectrum is taken."""
LOG_STEP = 0.004
"""Step of the spectrum, of the logarithm of the order."""
SMOOTH = 0.5
"""Half width of the running mean that is taken out of the logarithm of the spectrum."""
FLOOR = 3e-3
"""Share of a profile's variance at a single order below which power does not count."""
HARMONICS = 3
"""Order and multiples of it that are looked at together. Each counts by the logarithm of its power,
so that a third of the order, which has the order for its third multiple, does not win."""
ALIKE = 0.7
"""Length of the sum of the waves of a side over the sum of their lengths from which its crest is
stated."""
DRAWS = 399
"""Random staircases with which a staircase is compared."""
CERTAIN = 0.05
"""Share of random staircases of at least as clear an order up to which the order is stated."""


@dataclass(frozen=True, slots=True)
class _Leg:
    """Torque along one leg less its trend, with the direction and the side of the load."""

    angle_deg: Floats
    torque_nm: Floats
    rising: bool
    side: int


def step_order(torque_nm: Floats, angle_deg: Floats, run: Ints, seed: int = 0) -> StepOrder | None:
    """Look for the order of a staircase.

    All rows are read, also those that are neither fitted nor scored: the steps are in them, too.

    Parameters
    ----------
    torque_nm, angle_deg : ndarray, shape (n,)
        Torque [N m] and angle [deg] in the order of the recording.
    run : ndarray of int, shape (n,)
        Run of each row.
    seed : int
        Seed of the random staircases.

    Returns
    -------
    StepOrder or None
        None where legs are too few or too short, or where random staircases show as clear an order.
    """
    legs = list(_legs(torque_nm, angle_deg, run))
    if len({(leg.rising, leg.side) for leg in legs}) < 2:
        return None
    length = float(np.median([np.ptp(leg.angle_deg) for leg in legs]))
    lowest, highest = (float(np.log(each / length)) for each in CYCLES)
    cycles = np.exp(np.arange(lowest, highest, LOG_STEP))
    recorded = _mean_power(legs, [leg.torque_nm[:, None] for leg in legs], cycles)
    score = _clearness(recorded)[:, 0]
    best = int(np.argmax(score))
    drawn = _drawn(legs, cycles, np.random.default_rng(seed))
    chance = float((1 + np.count_nonzero(drawn >= score[best])) / (1 + len(drawn)))
    if chance > CERTAIN:
        return None
    order = float(cycles[best])
    apart = 1.0 / (HARMONICS * length * order)
    return StepOrder(order, apart, chance, _crests(legs, order))


def _legs(torque: Floats, angle: Floats, run: Ints) -> Iterator[_Leg]:
    """Loaded parts of every leg.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Torque [N m] and angle [deg].
    run : ndarray of int, shape (n,)

    Yields
    ------
    _Leg
    """
    top, whole = float(np.abs(torque).max(initial=0.0)), float(np.ptp(torque))
    parts = []
    for each in np.unique(run):
        index = np.flatnonzero(run == each)
        for leg in legs_of(torque, index, whole):
            for side in (1, -1):
                load = side * torque[leg] / top
                part = leg[(load > LOADED[0]) & (load < LOADED[1])]
                if len(part) >= FEWEST_CELLS:
                    parts.append((part, bool(torque[leg[-1]] > torque[leg[0]]), side))
    if not parts:
        return
    length = float(np.median([np.ptp(angle[part]) for part, _, _ in parts]))
    for part, rising, side in parts:
        cell, left = profile(torque[part], angle[part], length / CELLS, CELLS / LOCAL)
        if len(cell) >= FEWEST_CELLS:
            yield _Leg(np.asarray((cell + 0.5) * (length / CELLS)), left, rising, side)


def _mean_power(legs: list[_Leg], profiles: list[Floats], cycles: Floats) -> Floats:
    """Mean power of profiles along legs at each order, as a share of their variance.

    Parameters
    ----------
    legs : list of _Leg
    profiles : list of ndarray, shape (n of the leg, d)
        Torque along each leg, d of them [N m].
    cycles : ndarray, shape (k,)
        Cycles a degree.

    Returns
    -------
    ndarray, shape (k, d)
    """
    total = np.zeros((len(cycles), profiles[0].shape[1]))
    for leg, torque in zip(legs, profiles, strict=True):
        wave = np.exp(-2j * np.pi * np.outer(cycles, leg.angle_deg))
        total += np.abs(wave @ torque) ** 2 / (len(torque) * np.mean(torque**2, axis=0))
    return np.asarray(total / len(legs))


def _smooth(values: Floats) -> Floats:
    """Running mean along the logarithm of the order, the first axis, mirrored at the ends."""
    width = 2 * round(SMOOTH / LOG_STEP) + 1
    return np.asarray(uniform_filter1d(values, width, axis=0, mode="mirror"))


def _clearness(power: Floats) -> Floats:
    """Mean excess of an order and its multiples over their surroundings, as logarithms.

    Parameters
    ----------
    power : ndarray, shape (k, d)
        Spectra, d of them.

    Returns
    -------
    ndarray, shape (less than k, d)
        For the orders whose multiples are within the spectrum.
    """
    logarithm = np.log(power + FLOOR)
    excess = logarithm - _smooth(logarithm)
    steps = [round(float(np.log(k)) / LOG_STEP) for k in range(1, HARMONICS + 1)]
    kept = len(excess) - steps[-1]
    return np.asarray(np.mean([excess[step : step + kept] for step in steps], axis=0))


def _drawn(legs: list[_Leg], cycles: Floats, rng: np.random.Generator) -> Floats:
    """Clearest order of random staircases with the smooth spectrum of the recorded one.

    Runs pass the same staircase, so that the legs of one direction and side count as one; both
    directions share as much of theirs as they do in the recording.

    Parameters
    ----------
    legs : list of _Leg
    cycles : ndarray, shape (k,)
        Cycles a degree.
    rng : Generator

    Returns
    -------
    ndarray, shape (DRAWS,)
    """
    units = list({(leg.side, leg.rising): leg for leg in legs}.values())
    recorded = _mean_power(units, [unit.torque_nm[:, None] for unit in units], cycles)
    smooth = np.exp(_smooth(np.log(recorded + FLOOR)))
    amplitude = np.sqrt(smooth * cycles[:, None])
    shared = _shared(legs)

    def waves() -> Floats:
        return np.asarray(rng.normal(size=(2, len(cycles), DRAWS)))

    of_side = {side: waves() for side in sorted({unit.side for unit in units})}
    profiles = []
    for unit in units:
        real, imaginary = np.sqrt(shared) * of_side[unit.side] + np.sqrt(1.0 - shared) * waves()
        wave = np.exp(2j * np.pi * np.outer(unit.angle_deg, cycles))
        profiles.append(np.real(wave @ (amplitude * (real + 1j * imaginary))))
    return np.asarray(np.max(_clearness(_mean_power(units, profiles, cycles)), axis=0))


def _shared(legs: list[_Leg]) -> float:
    """Correlation of both directions on the same side, at equal angle; zero where it is below."""
    values = []
    for one, other in itertools.combinations(legs, 2):
        if one.side != other.side or one.rising == other.rising:
            continue
        first, second = np.round(one.angle_deg, 6), np.round(other.angle_deg, 6)
        _, here, there = np.intersect1d(first, second, return_indices=True)
        if len(here) >= FEWEST_CELLS:
            values.append(float(np.corrcoef(one.torque_nm[here], other.torque_nm[there])[0, 1]))
    return float(np.clip(np.mean(values), 0.0, 1.0)) if values else 0.0


def _crests(legs: list[_Leg], order: float) -> dict[int, float]:
    """Angle at which the torque is largest, by the side of the load, where its legs agree.

    Parameters
    ----------
    legs : list of _Leg
    order : float
        Cycles a degree.

    Returns
    -------
    dict of int to float
        In deg, the first one at or above zero.
    """
    found = {}
    for side in sorted({leg.side for leg in legs}):
        waves = np.array([
            np.mean(leg.torque_nm * np.exp(-2j * np.pi * order * leg.angle_deg))
            for leg in legs
            if leg.side == side
        ])  # fmt: skip
        if np.abs(waves.sum()) > ALIKE * np.abs(waves).sum():
            turn = float(-np.angle(waves.sum()) / (2 * np.pi))
            found[side] = (turn % 1.0) / order
    return found
