"""Loads between which a drive was worked to and fro before its first reading.

A rig is worked a few times before readings count. Friction then does not begin fresh: it keeps a
part of the torque at which it was left, until the load goes beyond that of the conditioning.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from cyclosweep.simulation.effects.history import Flags, Floats, Ints
from cyclosweep.simulation.effects.parameters import Shape

CONDITIONING = "conditioning_nm"
"""Name in the shape of a friction: the load of the conditioning, with the sign of its last end."""
CONDITIONED = 0.6
"""Load of a conditioning from which its own is looked for, in the largest of the recording."""
MOST_CONDITIONING = 1.2
"""Largest load of a conditioning, in those of the recording."""

Kind = TypeVar("Kind", bound=np.generic)


def conditioned(shape: Shape, largest_nm: float) -> list[Shape]:
    """Shapes of the same friction, left from either side of a conditioning.

    Parameters
    ----------
    shape : mapping
        Shape of a friction.
    largest_nm : float
        Largest torque of the recording [N m].

    Returns
    -------
    list of mapping
        Empty where the shape says from which side already.
    """
    if CONDITIONING in shape:
        return []
    load_nm = CONDITIONED * largest_nm
    return [{**shape, CONDITIONING: load} for load in (load_nm, -load_nm)]


@dataclass(frozen=True, eq=False)
class Conditioning:
    """Two loads before each history of samples that starts afresh.

    Attributes
    ----------
    first : ndarray of int, shape (h,)
        First sample of each history.
    load_nm : float
        Last load before it; the one before that is its opposite [N m].
    """

    first: Ints
    load_nm: float

    @classmethod
    def of(cls, restart: Flags, shape: Shape) -> Self | None:
        """Conditioning that the shape of a friction states.

        Parameters
        ----------
        restart : ndarray of bool, shape (n,)
            Samples with which a history starts afresh; the first one does anyway.
        shape : mapping
            Shape of a friction.

        Returns
        -------
        Conditioning or None
            None where friction begins fresh.
        """
        load_nm = float(shape.get(CONDITIONING, 0.0))
        if load_nm == 0.0 or not len(restart):
            return None
        return cls(np.flatnonzero(restart | (np.arange(len(restart)) == 0)), load_nm)

    @property
    def torque_nm(self) -> Floats:
        """Applied torques before each history, shape (2,) [N m]."""
        return np.array([-self.load_nm, self.load_nm])

    @property
    def flank(self) -> Floats:
        """Flanks in contact under these, +1 or -1, shape (2,)."""
        return np.sign(self.torque_nm)

    def insert(self, values: NDArray[Kind], here: NDArray[Kind] | Floats) -> NDArray[Kind]:
        """Values at the loads before and at the samples, in order.

        Parameters
        ----------
        values : ndarray, shape (n,)
            At the samples.
        here : ndarray, shape (2,) or (h, 2)
            At the loads before each history.

        Returns
        -------
        ndarray, shape (n + 2 h,)
        """
        places = np.repeat(self.first, 2)
        return np.insert(values, places, np.broadcast_to(here, (len(self.first), 2)).ravel())

    def held(self, values: NDArray[Kind]) -> NDArray[Kind]:
        """The same with the value of the first sample at the loads before it, see `insert`."""
        return self.insert(values, np.repeat(values[self.first][:, None], 2, axis=1))

    def restarts(self, restart: Flags) -> Flags:
        """Whether a history starts afresh: at the first of the loads before it, see `insert`."""
        later = restart.copy()
        later[self.first] = False
        return self.insert(later, np.array([True, False]))

    def taken_out(self, values: NDArray[Kind]) -> NDArray[Kind]:
        """Values at the samples alone.

        Parameters
        ----------
        values : ndarray, shape (n + 2 h,)
            At the loads before and at the samples, in order.

        Returns
        -------
        ndarray, shape (n,)
        """
        return np.delete(values, self._places)

    @cached_property
    def _places(self) -> Ints:
        """Places of the loads before, among those and the samples, shape (2 h,)."""
        return np.repeat(self.first, 2) + np.arange(2 * len(self.first))
