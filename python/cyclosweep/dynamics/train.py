"""A torsional train: its modes, and its transients."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from cyclosweep.dynamics.chain import Chain
from cyclosweep.dynamics.checks import same_length
from cyclosweep.dynamics.modes import Modes
from cyclosweep.dynamics.spring import Brake
from cyclosweep.dynamics.torques import Torques, knots
from cyclosweep.dynamics.transient import Transient, follow
from cyclosweep.errors import InputError, instance_of

__all__ = ["Train"]

Reals = npt.NDArray[np.float64]

MOST_SAMPLES = 10_000_000
"""Rows of a transient's table: its columns then still fit into memory."""


class Train(Chain):
    """A chain of inertias joined by springs, frozen and checked.

    Node 1 is usually the motor. Spring k joins nodes k and k + 1; a grounded train has one more
    spring, from its last node to the ground. Every inertia, stiffness and play is that of its own
    shaft; ``ratios`` join the shafts.

    Parameters
    ----------
    inertias_kg_m2 : sequence of float
        Inertias [kg m^2], each above zero.
    stiffnesses_nm_per_rad : sequence of float
        Stiffness of each spring [N m/rad], on the shaft of its first node.
    gaps_rad : sequence of float, optional
        Half of the play of each spring [rad]; none by default.
    grounded : bool
        Whether the last spring holds the last node.
    ratios : sequence of float, optional
        Speed of each spring's first node over that of its second [1]; one by default.
    names : sequence of str, optional
        Names of the nodes; ``node_1`` and so on by default.
    springs : sequence of TrainSpring, optional
        The springs instead of stiffnesses and gaps: other laws, friction.
    spring_names : sequence of str, optional
        Names of the springs; those of the nodes that they join by default.
    damping_s : float
        Stiffness-proportional damping [s]: beside every stiffness k acts a dashpot k times this.

    Raises
    ------
    InputError
        For an inertia or stiffness that is not above zero, a gap without a spring, or lists that
        do not fit each other.

    Examples
    --------
    >>> train = Train([5.0, 11.0, 22.0], [1e5, 2e5])
    >>> [round(float(f) * 6.283185307, 4) for f in train.modes().frequencies_hz]
    [0.0, 123.6658, 202.6583]
    """

    def modes(self, torque_nm: float = 0.0, *, locked: bool = False) -> Modes:
        """Natural frequencies around a load that keeps the play closed.

        Parameters
        ----------
        torque_nm : float
            Torque at the first shaft around which the train oscillates [N m]. By default it is so
            small that every spring has the stiffness that it begins with beyond its play; a
            negative one acts on the other flank.
        locked : bool
            Whether the last node is held.

        Returns
        -------
        Modes
            Natural frequencies [Hz], lowest first, and shapes, the largest angle of each being
            one [1].

        Raises
        ------
        InputError
            For a torque that is no finite number, or when a lone node is to be locked.

        Notes
        -----
        Small oscillations without friction. Through the play the frequency depends on the
        amplitude: :func:`cyclosweep.dynamics.backbone_frequency_hz`.
        """
        train = self.locked() if locked else self
        stiffnesses = train.stiffnesses_at(torque_nm)
        at_nodes, at_springs = train.node_ratios, train.spring_ratios
        squares, shapes, twists = train.core().modes(list(stiffnesses / at_springs**2))
        angles = np.array(shapes).T
        largest = np.abs(angles).argmax(axis=1)
        scale = angles[np.arange(len(angles)), largest][:, None]
        inertias = np.array(train.inertias_kg_m2) / at_nodes**2
        kinetic = inertias * angles**2
        elastic = (stiffnesses / at_springs**2) * np.array(twists).reshape(-1, len(squares)).T ** 2
        total = elastic.sum(axis=1, keepdims=True)
        moving = np.array(squares)[:, None] > 0
        potential = np.where(moving, elastic / np.where(moving, total, 1.0), 0.0)
        return Modes(
            train,
            stiffnesses,
            np.sqrt(np.array(squares)) / math.tau,
            angles / scale / at_nodes,
            kinetic / kinetic.sum(axis=1, keepdims=True),
            potential,
        )

    def locked(self) -> Train:
        """Return this train with its last node held, so that its last spring goes to the ground.

        Returns
        -------
        Train
            Itself where it is grounded.

        Raises
        ------
        InputError
            For a train of one node.
        """
        if self.grounded:
            return self
        if len(self.inertias_kg_m2) < 2:
            raise InputError("train: one inertia alone has no spring that could hold it")
        return Train(
            self.inertias_kg_m2[:-1],
            grounded=True,
            ratios=self.ratios,
            names=self.names[:-1],
            springs=self.springs,
            spring_names=self.spring_names,
            damping_s=self.damping_s,
        )

    def transient(
        self,
        torques: Torques,
        duration_s: float,
        samples: int = 2000,
        *,
        preload_nm: Torques | None = None,
        speeds_rad_per_s: Sequence[float] | float = 0.0,
        brake: Brake | None = None,
    ) -> Transient:
        """Follow the train under torques, from event to event in closed form.

        Parameters
        ----------
        torques : mapping
            Torque on each node by its name or number: a number [N m], or times and torques as a
            pair of sequences [s], [N m], joined by straight lines (equal times are a jump). Nodes
            left out have none. A driving torque is positive; a load that resists is negative.
        duration_s : float
            How long [s].
        samples : int
            Rows of the table, evenly spaced; events and peaks do not depend on them.
        preload_nm : mapping, optional
            Torques that have acted for long before, in numbers: the train starts in their
            equilibrium. None by default.
        speeds_rad_per_s : float or sequence of float
            Speed of the first shaft, which all others follow, or of each node on its own shaft
            [rad/s].
        brake : Brake, optional
            Friction between a node and the ground, from the start on.

        Returns
        -------
        Transient
            Peaks of the springs' torques [N m], their times [s], and a table over the time.

        Raises
        ------
        InputError
            For torques on nodes that the train does not have, times that fall, numbers that are
            none, or a preload out of balance on a train that nothing holds.

        Notes
        -----
        Between events the motion is that of the modes in closed form. Elastic laws are straight
        lines between their knees; friction is slip elements of constant stiffness; damping is
        proportional to stiffness.

        Examples
        --------
        >>> train = Train([0.0035], [21.0], [0.48869219], grounded=True)
        >>> run = train.transient({0: -7.2575}, 0.5, preload_nm={0: 7.2575})
        >>> round(run.shock_factor, 6)
        4.107449
        """
        times, values = knots(self, torques, duration_s)
        instance_of("samples", samples, int, np.integer)
        if not 2 <= samples <= MOST_SAMPLES:
            raise InputError(f"samples: found {samples}, expected 2 to {MOST_SAMPLES}")
        before = np.zeros(len(self.names))
        for name, torque in (preload_nm or {}).items():
            if not isinstance(torque, (int, float)):
                raise InputError(f"preload_nm of {name}: expected a number")
            before[self.node(name)] = torque
        self._balanced(before)
        return follow(self, times, values, samples, before, self._speeds(speeds_rad_per_s), brake)

    def _balanced(self, before: Reals) -> None:
        """Require that torques before the start leave a free train at rest."""
        referred_nm = before / self.node_ratios
        rest, largest = abs(float(referred_nm.sum())), float(np.abs(referred_nm).max())
        if not self.grounded and rest > 1e-9 * largest:
            raise InputError(
                f"preload_nm: found {rest:g} N m left over at the first shaft of a train that "
                "nothing holds, expected torques in balance or a grounded train"
            )

    def _speeds(self, given: Sequence[float] | float) -> Reals:
        if isinstance(given, (int, float)):
            return np.asarray(float(given) / self.node_ratios)
        speeds = np.asarray(given, dtype=np.float64)
        same_length("speeds_rad_per_s", len(speeds), len(self.names))
        return speeds
