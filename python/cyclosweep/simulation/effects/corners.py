"""Corners of a load programme between two readings, which neither of them shows.

A torque that rises evenly and then falls evenly turns where the two lines meet, as a rule between
two readings. Friction starts its new way there, and not at the highest reading.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

Kind = TypeVar("Kind", bound=np.generic)

EVEN = 0.02
"""Change of the rate from step to step, as a share of it, up to which a torque changes evenly."""
BEND = 0.1
"""The same, from which there is a corner between two even stretches."""
LONGEST = 1.5
"""Length of the step with a corner over the longer of its neighbours up to which it is one; a
longer one is a load that was held, or a pause."""
MOSTLY = 0.5
"""Share of even steps from which a programme is one of even ramps, that repeat their rates."""
INSIDE = 0.02
"""Least distance of a corner from the readings, in steps; nearer ones are at the reading."""


@dataclass(frozen=True, eq=False)
class Corners:
    """Points of a load history between its readings.

    Attributes
    ----------
    before : ndarray of int, shape (m,)
        Reading before each corner.
    share : ndarray, shape (m,)
        Part of the time to the next reading that has passed at the corner, from 0 to 1.
    torque_nm : ndarray, shape (m,)
        Applied torque at the corner [N m].
    """

    before: Ints
    share: Floats
    torque_nm: Floats

    def __len__(self) -> int:
        return len(self.before)

    def between(self, values: Floats) -> Floats:
        """Values at the corners, on the lines between those of the readings.

        Parameters
        ----------
        values : ndarray, shape (n,)
            At the readings.

        Returns
        -------
        ndarray, shape (m,)
        """
        first = values[self.before]
        return np.asarray(first + self.share * (values[self.before + 1] - first))

    def beyond(self, torque_nm: Floats, angle_deg: Floats, compliance: float) -> Floats:
        """Angles at the corners, on elastic lines from the readings before.

        Parameters
        ----------
        torque_nm, angle_deg : ndarray, shape (n,)
            Applied torque [N m] and angle [deg] at the readings.
        compliance : float
            Of the drive [deg/(N m)].

        Returns
        -------
        ndarray, shape (m,)
            In deg.
        """
        ahead_nm = self.torque_nm - torque_nm[self.before]
        return np.asarray(angle_deg[self.before] + compliance * ahead_nm)

    def insert(self, values: NDArray[Kind], here: NDArray[Kind] | float) -> NDArray[Kind]:
        """Values of readings and corners, in order.

        Parameters
        ----------
        values : ndarray, shape (n,)
            At the readings.
        here : array_like
            At the corners: one each, or one for all.

        Returns
        -------
        ndarray, shape (n + m,)
        """
        both = np.empty(len(values) + len(self), dtype=values.dtype)
        both[self._is_reading(len(both))] = values
        both[self.places] = here
        return both

    def taken_out(self, values: NDArray[Kind]) -> NDArray[Kind]:
        """Values of the readings alone.

        Parameters
        ----------
        values : ndarray, shape (n + m,)
            Of readings and corners, in order.

        Returns
        -------
        ndarray, shape (n,)
        """
        return values[self._is_reading(len(values))]

    def lapse_s(self, lapse_s: Floats) -> Floats:
        """Time that leads to each reading and corner, shape (n + m,) [s].

        Parameters
        ----------
        lapse_s : ndarray, shape (n,)
            Time that leads to each reading [s].

        Returns
        -------
        ndarray, shape (n + m,)
        """
        to_corner = self.share * lapse_s[self.before + 1]
        rest = lapse_s.copy()
        rest[self.before + 1] -= to_corner
        return self.insert(rest, to_corner)

    @cached_property
    def places(self) -> Ints:
        """Places of the corners among readings and corners, shape (m,)."""
        return self.before + 1 + np.arange(len(self))

    def _is_reading(self, count: int) -> Flags:
        """Whether each of ``count`` readings and corners, in order, is a reading."""
        reading = np.ones(count, dtype=bool)
        reading[self.places] = False
        return reading


NO_CORNERS = Corners(np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))
"""None between any readings."""


def find_corners(torque_nm: Floats, time_s: Floats | None, begins: Flags) -> Corners:
    """Find where even changes of the torque meet between two readings.

    Parameters
    ----------
    torque_nm : ndarray, shape (n,)
        Applied torque [N m].
    time_s : ndarray, shape (n,), or None
        Clock [s]; without it no corner is known.
    begins : ndarray of bool, shape (n,)
        Readings with which a run begins; what led to them is not known.

    Returns
    -------
    Corners
        Those with the same sign of the torque on both sides: what friction does where flanks
        change hangs on the play.
    """
    count = len(torque_nm)
    if time_s is None or count < 4:
        return NO_CORNERS
    step_s = np.diff(time_s)
    known = (step_s > 0) & ~begins[1:]
    rate = np.where(known, np.diff(torque_nm) / np.where(known, step_s, 1.0), 0.0)
    even = _even_steps(rate, known, np.cumsum(begins, dtype=np.int64)[1:])
    # The step from reading k to reading k + 1, between the one before and the one after it.
    k = np.arange(1, count - 2)
    before, after = rate[k - 1], rate[k + 1]
    bend, steeper = before - after, np.maximum(np.abs(before), np.abs(after))
    # Two equal readings are a load that was held, and no corner that lies between them.
    bent = (np.abs(bend) > BEND * steeper) & (np.abs(rate[k]) > EVEN * steeper)
    lines_meet = torque_nm[k + 1] - torque_nm[k] - after * step_s[k]
    bent &= known[k] & (step_s[k] <= LONGEST * np.maximum(step_s[k - 1], step_s[k + 1]))
    share = np.where(bent, lines_meet / np.where(bent, bend * step_s[k], 1.0), 0.0)
    torque = torque_nm[k] + before * share * step_s[k]
    inside = (share > INSIDE) & (share < 1.0 - INSIDE)
    sign = np.sign(torque_nm)
    same = (sign[k] == sign[k + 1]) & (np.sign(torque) == sign[k])
    found = even[k - 1] & even[k + 1] & bent & inside & same
    return Corners(k[found], share[found], torque[found])


def _even_steps(rate: Floats, known: Flags, stretch: Ints) -> Flags:
    """Steps over which the torque changes as evenly as over others.

    Parameters
    ----------
    rate : ndarray, shape (n,)
        Rate of the torque over each step between readings [N m/s].
    known : ndarray of bool, shape (n,)
        Steps over which it is known.
    stretch : ndarray of int, shape (n,)
        Label of the stretch of each step, within which the state of the drive is known.

    Returns
    -------
    ndarray of bool, shape (n,)
        Steps with the rate of a neighbour, and others with the rate of any of those, up or down;
        none in stretches that do not mostly consist of steps with the rate of a neighbour.
    """
    alike = np.abs(np.diff(rate)) <= EVEN * np.minimum(np.abs(rate[1:]), np.abs(rate[:-1]))
    alike &= known[1:] & known[:-1] & (np.diff(stretch) == 0)
    even = np.r_[alike, False] | np.r_[False, alike]
    ends = np.flatnonzero(np.diff(stretch)) + 1
    for first, stop in pairwise((0, *ends.tolist(), len(rate))):
        here = slice(first, stop)
        size = np.sort(np.abs(rate[here][known[here] & even[here]]))
        if len(size) < max(MOSTLY * np.count_nonzero(known[here]), 1):
            even[here] = False
            continue
        own = np.abs(rate[here])
        place = np.searchsorted(size, own)
        below = np.abs(size[np.maximum(place - 1, 0)] - own)
        above = np.abs(size[np.minimum(place, len(size) - 1)] - own)
        even[here] |= known[here] & (np.minimum(below, above) <= EVEN * own)
    return np.asarray(even)
