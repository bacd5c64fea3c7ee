"""One spring of a torsional train: an elastic law of straight lines, and friction beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Self

import numpy as np
import numpy.typing as npt

from cyclosweep.errors import InputError

__all__ = ["Brake", "SlipElement", "TrainSpring"]

Reals = npt.NDArray[np.float64]


class SlipElement(NamedTuple):
    """Friction in parallel to a spring: a spring of its own that slides at a limit.

    Several of them with different stiffnesses are a Maxwell-slip model (Al-Bender, Lampaert and
    Swevers, IEEE Trans. Autom. Control 50(11), 2005, doi 10.1109/TAC.2005.858676).

    Attributes
    ----------
    stiffness_nm_per_rad : float
        Stiffness while it holds [N m/rad].
    limit_nm : float
        Torque at which it slides without load [N m].
    load_factor : float
        What the limit grows by for one N m of the elastic torque of its spring [1].
    """

    stiffness_nm_per_rad: float
    limit_nm: float
    load_factor: float = 0.0


class Brake(NamedTuple):
    """Friction between a node and the ground.

    Attributes
    ----------
    node : int
        Number of the node, from 0.
    element : SlipElement
        Its torque and how stiffly it holds, on the node's own shaft.
    """

    node: int
    element: SlipElement


@dataclass(frozen=True)
class TrainSpring:
    """A spring between two neighbours of a train.

    Attributes
    ----------
    knees_rad : tuple of float
        Twists at which the slope of the elastic law changes, rising [rad].
    slopes_nm_per_rad : tuple of float
        Slopes before, between and behind the knees, one more than knees [N m/rad]; a slope of
        zero is play.
    unloaded_rad : float
        A twist at which the law has no torque [rad].
    friction : tuple of SlipElement
        Friction in parallel.
    """

    knees_rad: tuple[float, ...]
    slopes_nm_per_rad: tuple[float, ...]
    unloaded_rad: float = 0.0
    friction: tuple[SlipElement, ...] = ()

    @classmethod
    def linear(
        cls,
        stiffness_nm_per_rad: float,
        gap_rad: float = 0.0,
        friction: Sequence[SlipElement] = (),
    ) -> Self:
        """Return a spring of one stiffness behind a play.

        Parameters
        ----------
        stiffness_nm_per_rad : float
            Stiffness once the play is used up [N m/rad].
        gap_rad : float
            Half of the play [rad].
        friction : sequence of SlipElement
            Friction in parallel.

        Returns
        -------
        TrainSpring

        Raises
        ------
        InputError
            For a stiffness that is not above zero (a gap needs a spring behind it), or a gap below
            zero.
        """
        if not (math.isfinite(stiffness_nm_per_rad) and stiffness_nm_per_rad > 0):
            behind = " behind the gap" if gap_rad > 0 else ""
            raise InputError(
                f"stiffness{behind}: found {stiffness_nm_per_rad:g} N m/rad, "
                "expected a number above zero"
            )
        if not (math.isfinite(gap_rad) and gap_rad >= 0):
            raise InputError(f"gap: found {gap_rad:g} rad, expected a number not below zero")
        if gap_rad == 0:
            return cls((), (stiffness_nm_per_rad,), 0.0, tuple(friction))
        slopes = (stiffness_nm_per_rad, 0.0, stiffness_nm_per_rad)
        return cls((-gap_rad, gap_rad), slopes, 0.0, tuple(friction))

    @classmethod
    def through_points(
        cls,
        twist_rad: npt.ArrayLike,
        torque_nm: npt.ArrayLike,
        friction: Sequence[SlipElement] = (),
    ) -> Self:
        """Return a spring whose law joins points by straight lines.

        Parameters
        ----------
        twist_rad, torque_nm : array_like, shape (n,)
            Points of the law [rad], [N m]; twists that rise, torques that never fall and change
            their sign. The outermost lines go on.
        friction : sequence of SlipElement
            Friction in parallel.

        Returns
        -------
        TrainSpring

        Raises
        ------
        InputError
            When the points are no such law.
        """
        twist = np.asarray(twist_rad, dtype=np.float64)
        torque = np.asarray(torque_nm, dtype=np.float64)
        if twist.ndim != 1 or twist.shape != torque.shape or len(twist) < 2:
            raise InputError("elastic law: expected as many twists as torques, at least two")
        if not (np.isfinite(twist).all() and np.isfinite(torque).all()):
            raise InputError("elastic law: expected finite numbers")
        if (np.diff(twist) <= 0).any() or (np.diff(torque) < 0).any():
            raise InputError("elastic law: expected twists that rise and torques that do not fall")
        if torque[0] > 0 or torque[-1] < 0:
            raise InputError("elastic law: expected torques on both sides of zero")
        slopes = np.diff(torque) / np.diff(twist)
        zero = np.flatnonzero(torque == 0)
        if len(zero):
            unloaded = 0.5 * float(twist[zero[0]] + twist[zero[-1]])
        else:
            unloaded = float(np.interp(0.0, torque, twist))
        changes = np.flatnonzero(slopes[1:] != slopes[:-1]) + 1
        kept = slopes[np.r_[0, changes]]
        return cls(
            tuple(float(x) for x in twist[changes]),
            tuple(float(x) for x in kept),
            unloaded,
            tuple(friction),
        )

    @property
    def gap_rad(self) -> float:
        """Half of the play [rad]; zero without play."""
        for k, slope in enumerate(self.slopes_nm_per_rad[1:-1]):
            if slope == 0:
                return 0.5 * (self.knees_rad[k + 1] - self.knees_rad[k])
        return 0.0

    def torque_nm(self, twist_rad: npt.ArrayLike) -> Reals:
        """Elastic torque at twists.

        Parameters
        ----------
        twist_rad : array_like, shape (n,)
            Twists [rad].

        Returns
        -------
        ndarray, shape (n,)
            Torque [N m], friction left out.
        """
        twist = np.asarray(twist_rad, dtype=np.float64)
        knees = np.array([-math.inf, *self.knees_rad, math.inf])
        total = np.zeros_like(twist)
        for k, slope in enumerate(self.slopes_nm_per_rad):
            low, high = knees[k], knees[k + 1]
            part = np.clip(twist, low, high) - np.clip(self.unloaded_rad, low, high)
            total = total + slope * part
        return total

    def stiffness_at(self, torque_nm: float) -> float:
        """Slope of the elastic law under a torque.

        Parameters
        ----------
        torque_nm : float
            Elastic torque [N m]; zero means the line on which the law begins to carry load with
            growing twist.

        Returns
        -------
        float
            Tangent stiffness [N m/rad].
        """
        if not self.knees_rad:
            return self.slopes_nm_per_rad[0]
        at_knees = self.torque_nm(self.knees_rad)
        place = int(np.searchsorted(at_knees, torque_nm, side="right"))
        return self.slopes_nm_per_rad[place]

    def scaled(self, ratio: float) -> TrainSpring:
        """Return this spring as it acts on a shaft that turns ``ratio`` times as fast.

        Parameters
        ----------
        ratio : float
            Speed of the other shaft over this one [1].

        Returns
        -------
        TrainSpring
            Twists times the ratio, torques over it.
        """
        square = ratio * ratio
        return TrainSpring(
            tuple(knee * ratio for knee in self.knees_rad),
            tuple(slope / square for slope in self.slopes_nm_per_rad),
            self.unloaded_rad * ratio,
            tuple(
                SlipElement(e.stiffness_nm_per_rad / square, e.limit_nm / ratio, e.load_factor)
                for e in self.friction
            ),
        )
