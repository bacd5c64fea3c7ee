"""How clear each order is in the torque along the legs of a recording, and in random staircases.

The spectrum is that of the torque at equal angle, less a local line. An order is clear by what it
and its multiples stand out of their surroundings; random staircases with the same smooth spectrum
say how clear chance makes one.
"""

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import uniform_filter1d

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
SIDES = (1, -1)
"""Signs of the load."""
DRAWS = 399
"""Random staircases with which a staircase is compared."""


@dataclass(frozen=True, slots=True)
class Leg:
    """Torque along one leg less its trend, with the direction and the side of the load.

    Attributes
    ----------
    angle_deg : ndarray, shape (n,)
        Places along the leg, equally spaced [deg].
    torque_nm : ndarray, shape (n,)
        Torque there less a local line [N m].
    rising : bool
        Whether the torque rises along the leg.
    side : int
        Sign of the load.
    """

    angle_deg: Floats
    torque_nm: Floats
    rising: bool
    side: int


@dataclass(frozen=True, slots=True)
class StepSpectrum:
    """How clear each order is.

    Attributes
    ----------
    cycles_per_deg : ndarray, shape (k,)
        Orders whose multiples were looked at as well, evenly spaced in their logarithm [1/deg].
    clearness : ndarray, shape (k,)
        Mean excess of an order and its multiples over their surroundings, as logarithms [-].
    drawn : ndarray, shape (k, DRAWS)
        The same of random staircases [-].
    """

    cycles_per_deg: Floats
    clearness: Floats
    drawn: Floats

    @property
    def clearest(self) -> int:
        """Place of the clearest order."""
        return int(np.argmax(self.clearness))

    @property
    def chance(self) -> float:
        """Share of random staircases of which some order is at least as clear as the clearest."""
        return _share_as_large(self.drawn.max(axis=0), self.clearness[self.clearest])

    def chance_at(self, place: int) -> float:
        """Share of random staircases in which the order at a place is at least as clear."""
        return _share_as_large(self.drawn[place], self.clearness[place])


def _share_as_large(drawn: Floats, recorded: float) -> float:
    """Share of random values, the recorded one counted among them, that are as large as it.

    Parameters
    ----------
    drawn : ndarray, shape (d,)
        Values of random staircases.
    recorded : float
        Value of the recorded one.

    Returns
    -------
    float
    """
    return float((1 + np.count_nonzero(drawn >= recorded)) / (1 + len(drawn)))


def legs_in(torque: Floats, angle: Floats, run: Ints) -> Iterator[Leg]:
    """Loaded parts of every leg, their trend taken out.

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Torque [N m] and angle [deg].
    run : ndarray of int, shape (n,)

    Yields
    ------
    Leg
    """
    top, whole = float(np.abs(torque).max(initial=0.0)), float(np.ptp(torque))
    parts = []
    for each in np.unique(run) if top > 0.0 else ():
        index = np.flatnonzero(run == each)
        for leg in legs_of(torque, index, whole):
            for side in SIDES:
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
            yield Leg(np.asarray((cell + 0.5) * (length / CELLS)), left, rising, side)


def enough(legs: Sequence[Leg]) -> bool:
    """Whether there are legs of two kinds: directions of the torque, or sides of the load."""
    return len({(leg.rising, leg.side) for leg in legs}) > 1


def length_deg(legs: Sequence[Leg]) -> float:
    """Usual length of a leg [deg]."""
    return float(np.median([np.ptp(leg.angle_deg) for leg in legs]))


def orders_in(length: float) -> Floats:
    """Orders that a leg can show, evenly spaced in their logarithm.

    Parameters
    ----------
    length : float
        Length of a leg.

    Returns
    -------
    ndarray, shape (k,)
        Cycles in the unit of the length.
    """
    lowest, highest = (float(np.log(each / length)) for each in CYCLES)
    return np.asarray(np.exp(np.arange(lowest, highest, LOG_STEP)))


def from_one_place(legs: Sequence[Leg]) -> list[Leg]:
    """Legs of either side counted from where the first of them begins, as if all were made there.

    The angle at which a sensor reads zero is a setting: two recordings of one place may have other
    angles.

    Parameters
    ----------
    legs : sequence of Leg

    Returns
    -------
    list of Leg
    """
    begins = {
        side: min(float((side * leg.angle_deg).min()) for leg in legs if leg.side == side)
        for side in {leg.side for leg in legs}
    }
    return [replace(leg, angle_deg=leg.angle_deg - leg.side * begins[leg.side]) for leg in legs]


def step_spectrum(legs: Sequence[Leg], cycles: Floats, rng: np.random.Generator) -> StepSpectrum:
    """Clearness of every order in the legs of a recording, and in random staircases.

    Parameters
    ----------
    legs : sequence of Leg
    cycles : ndarray, shape (k,)
        Orders, evenly spaced in their logarithm by `LOG_STEP` [1/deg].
    rng : Generator
        Draws the random staircases. Equal ones, with equally many orders, draw the same staircase
        along the angle, whichever legs there are.

    Returns
    -------
    StepSpectrum
        Of the orders whose multiples are among those given.
    """
    recorded = _mean_power(legs, [leg.torque_nm[:, None] for leg in legs], cycles)
    clearness = _clearness(recorded)[:, 0]
    drawn = _clearness(_power_of_drawn(legs, cycles, rng))
    return StepSpectrum(cycles[: len(clearness)], clearness, drawn)


def _mean_power(legs: Sequence[Leg], profiles: Sequence[Floats], cycles: Floats) -> Floats:
    """Mean power of profiles along legs at each order, as a share of their variance.

    Parameters
    ----------
    legs : sequence of Leg
    profiles : sequence of ndarray, shape (n of the leg, d)
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


def _power_of_drawn(legs: Sequence[Leg], cycles: Floats, rng: np.random.Generator) -> Floats:
    """Power of random staircases with the smooth spectrum of the recorded one.

    Runs pass the same staircase, so that the legs of one direction and side count as one; both
    directions share as much of theirs as they do in the recording.

    Parameters
    ----------
    legs : sequence of Leg
    cycles : ndarray, shape (k,)
        Cycles a degree.
    rng : Generator

    Returns
    -------
    ndarray, shape (k, DRAWS)
    """
    units = list({(leg.side, leg.rising): leg for leg in legs}.values())
    recorded = _mean_power(units, [unit.torque_nm[:, None] for unit in units], cycles)
    smooth = np.exp(_smooth(np.log(recorded + FLOOR)))
    amplitude = np.sqrt(smooth * cycles[:, None])
    shared = _shared(legs)

    def waves() -> Floats:
        return np.asarray(rng.normal(size=(2, len(cycles), DRAWS)))

    # In one order, whichever legs there are: equal generators draw the same staircase.
    of_side = {side: waves() for side in SIDES}
    own = {(side, rising): waves() for side in SIDES for rising in (False, True)}
    profiles = []
    for unit in units:
        alone = own[unit.side, unit.rising]
        real, imaginary = np.sqrt(shared) * of_side[unit.side] + np.sqrt(1.0 - shared) * alone
        wave = np.exp(2j * np.pi * np.outer(unit.angle_deg, cycles))
        profiles.append(np.real(wave @ (amplitude * (real + 1j * imaginary))))
    return _mean_power(units, profiles, cycles)


def _shared(legs: Sequence[Leg]) -> float:
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
