"""A torsional train: a chain of inertias and springs, with gear ratios, play and friction."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

import cyclosweep._core as _core
from cyclosweep.dynamics.modes import Modes
from cyclosweep.dynamics.spring import TrainSpring
from cyclosweep.dynamics.torques import Torques, knots
from cyclosweep.dynamics.transient import Brake, Transient, follow
from cyclosweep.errors import InputError

__all__ = ["Train"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, init=False)
class Train:
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

    inertias_kg_m2: tuple[float, ...]
    springs: tuple[TrainSpring, ...]
    grounded: bool
    ratios: tuple[float, ...]
    names: tuple[str, ...]
    spring_names: tuple[str, ...]
    damping_s: float

    def __init__(
        self,
        inertias_kg_m2: Sequence[float],
        stiffnesses_nm_per_rad: Sequence[float] = (),
        gaps_rad: Sequence[float] | None = None,
        grounded: bool = False,
        *,
        ratios: Sequence[float] | None = None,
        names: Sequence[str] | None = None,
        springs: Sequence[TrainSpring] | None = None,
        spring_names: Sequence[str] | None = None,
        damping_s: float = 0.0,
    ) -> None:
        inertias = tuple(float(j) for j in inertias_kg_m2)
        nodes = tuple(names) if names is not None else _numbered("node", len(inertias))
        expected = len(inertias) - (0 if grounded else 1)
        if springs is None:
            gaps = [0.0] * len(stiffnesses_nm_per_rad) if gaps_rad is None else list(gaps_rad)
            _same_length("gaps_rad", len(gaps), len(stiffnesses_nm_per_rad))
            springs = [
                _spring(k, stiffness, gap)
                for k, (stiffness, gap) in enumerate(
                    zip(stiffnesses_nm_per_rad, gaps, strict=True), 1
                )
            ]
        elif len(stiffnesses_nm_per_rad) or gaps_rad is not None:
            raise InputError("springs: given beside stiffnesses or gaps, expected one of both")
        if not inertias:
            raise InputError("inertias_kg_m2: found none, expected at least one")
        for name, inertia in zip(nodes, inertias, strict=False):
            if not (math.isfinite(inertia) and inertia > 0):
                raise InputError(
                    f"inertia of {name}: found {inertia:g} kg m^2, expected a number above zero"
                )
        _same_length("springs", len(springs), expected, " of a grounded train" if grounded else "")
        given = [1.0] * len(springs) if ratios is None else [float(r) for r in ratios]
        _same_length("ratios", len(given), len(springs))
        for ratio in given:
            if not (math.isfinite(ratio) and ratio > 0):
                raise InputError(f"ratios: found {ratio:g}, expected numbers above zero")
        _same_length("names", len(nodes), len(inertias))
        if spring_names is None:
            after = (*nodes[1:], "ground")
            spring_names = [f"{a}-{b}" for a, b in zip(nodes, after, strict=True)][: len(springs)]
        _same_length("spring_names", len(spring_names), len(springs))
        if len({*nodes, *spring_names}) < len(nodes) + len(spring_names):
            raise InputError("names: found the same name twice, expected every name once")
        values = {
            "inertias_kg_m2": inertias,
            "springs": tuple(springs),
            "grounded": bool(grounded),
            "ratios": tuple(given),
            "names": nodes,
            "spring_names": tuple(spring_names),
            "damping_s": float(damping_s),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        self.core()

    @property
    def node_ratios(self) -> Reals:
        """Speed of the first shaft over that of each node's, shape (nodes,) [1]."""
        between = self.ratios[: len(self.inertias_kg_m2) - 1]
        return np.cumprod([1.0, *between])

    @property
    def spring_ratios(self) -> Reals:
        """Speed of the first shaft over that on which each spring is given, shape (springs,) [1]."""
        return self.node_ratios[: len(self.springs)]

    def core(self, brake: Brake | None = None) -> _core.Train:
        """Return the core's train, everything referred to the first shaft.

        Parameters
        ----------
        brake : Brake, optional
            Friction between one node and the ground, as one more spring.

        Returns
        -------
        cyclosweep._core.Train

        Raises
        ------
        InputError
            For numbers that no train can have.
        """
        at_nodes = self.node_ratios
        last = len(self.inertias_kg_m2) - 1
        rows = []
        for k, (spring, ratio) in enumerate(zip(self.springs, self.spring_ratios, strict=True)):
            rows.append(_row(k, k + 1 if k < last else None, spring.scaled(float(ratio))))
        if brake is not None:
            spring = TrainSpring((), (0.0,), 0.0, (brake.element,))
            rows.append(_row(brake.node, None, spring.scaled(float(at_nodes[brake.node]))))
        inertias = [
            inertia / float(ratio) ** 2
            for inertia, ratio in zip(self.inertias_kg_m2, at_nodes, strict=True)
        ]
        try:
            return _core.Train(inertias, rows, self.damping_s)
        except ValueError as error:
            raise InputError(f"train: {error}") from None

    def stiffnesses_at(self, torque_nm: float = 0.0) -> Reals:
        """Tangent stiffness of each spring when a torque at the first shaft goes through.

        Parameters
        ----------
        torque_nm : float
            Torque at the first shaft [N m]; zero means just beyond the play.

        Returns
        -------
        ndarray, shape (springs,)
            On the springs' own shafts [N m/rad].
        """
        torques = torque_nm * self.spring_ratios
        pairs = zip(self.springs, torques, strict=True)
        return np.array([spring.stiffness_at(float(torque)) for spring, torque in pairs])

    def modes(self, torque_nm: float = 0.0, *, locked: bool = False) -> Modes:
        """Natural frequencies around a load that keeps the play closed.

        Parameters
        ----------
        torque_nm : float
            Torque at the first shaft around which the train oscillates [N m]. By default it is so
            small that every spring has the stiffness that it begins with beyond its play.
        locked : bool
            Whether the last node is held.

        Returns
        -------
        Modes

        Raises
        ------
        InputError
            When a lone node is to be locked.

        Notes
        -----
        Small oscillations without friction. Through the play the frequency depends on the
        amplitude: :func:`cyclosweep.dynamics.backbone_frequency_hz`.
        """
        train = self.locked() if locked else self
        stiffnesses = train.stiffnesses_at(torque_nm)
        at_nodes, at_springs = train.node_ratios, train.spring_ratios
        squares, shapes, twists = train.core().modes(list(stiffnesses / at_springs**2))
        referred = np.array(shapes).T
        largest = np.abs(referred).argmax(axis=1)
        scale = referred[np.arange(len(referred)), largest][:, None]
        inertias = np.array(train.inertias_kg_m2) / at_nodes**2
        kinetic = inertias * referred**2
        elastic = (stiffnesses / at_springs**2) * np.array(twists).reshape(-1, len(squares)).T ** 2
        total = elastic.sum(axis=1, keepdims=True)
        moving = np.array(squares)[:, None] > 0
        potential = np.where(moving, elastic / np.where(moving, total, 1.0), 0.0)
        return Modes(
            train,
            stiffnesses,
            np.sqrt(np.array(squares)) / math.tau,
            referred / scale / at_nodes,
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

    def node(self, name: str | int) -> int:
        """Place of a node by its name, or by its number from 0.

        Parameters
        ----------
        name : str or int
            The node; a negative number counts from the end.

        Returns
        -------
        int

        Raises
        ------
        InputError
            For a node that the train does not have.
        """
        count = len(self.names)
        if isinstance(name, str) and name in self.names:
            return self.names.index(name)
        if isinstance(name, int) and -count <= name < count:
            return name % count
        raise InputError(f"node {name!r}: no such node, expected {', '.join(self.names)}")

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
            equilibrium, accelerating as one where they are not in balance. None by default.
        speeds_rad_per_s : float or sequence of float
            Speed of the first shaft, which all others follow, or of each node on its own shaft
            [rad/s].
        brake : Brake, optional
            Friction between a node and the ground, from the start on.

        Returns
        -------
        Transient

        Raises
        ------
        InputError
            For torques on nodes that the train does not have, times that fall, or numbers that
            are none.

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
        if samples < 2:
            raise InputError(f"samples: found {samples}, expected at least 2")
        before = np.zeros(len(self.names))
        for name, torque in (preload_nm or {}).items():
            if not isinstance(torque, (int, float)):
                raise InputError(f"preload_nm of {name}: expected a number")
            before[self.node(name)] = torque
        return follow(self, times, values, samples, before, self._speeds(speeds_rad_per_s), brake)

    def _speeds(self, given: Sequence[float] | float) -> Reals:
        if isinstance(given, (int, float)):
            return np.asarray(float(given) / self.node_ratios)
        speeds = np.asarray(given, dtype=np.float64)
        _same_length("speeds_rad_per_s", len(speeds), len(self.names))
        return speeds

    def static_torques_nm(self, torques_nm: Mapping[str | int, float]) -> Reals:
        """Torque of each spring under constant torques.

        Parameters
        ----------
        torques_nm : mapping
            Torque on each node [N m].

        Returns
        -------
        ndarray, shape (springs,)
            On the springs' own shafts [N m]; torques out of balance accelerate a free train as
            one.
        """
        values = np.zeros(len(self.names))
        for name, torque in torques_nm.items():
            values[self.node(name)] = torque
        return self.carried(values / self.node_ratios) * self.spring_ratios

    def carried(self, torques_nm: Reals) -> Reals:
        """Torque of each spring under constant torques, all referred to the first shaft.

        Parameters
        ----------
        torques_nm : ndarray, shape (nodes,)
            Torques on the nodes [N m].

        Returns
        -------
        ndarray, shape (springs,)
            In N m.
        """
        inertias = np.array(self.inertias_kg_m2) / self.node_ratios**2
        rate = 0.0 if self.grounded else float(torques_nm.sum() / inertias.sum())
        return np.cumsum(torques_nm - rate * inertias)[: len(self.springs)]


def _numbered(word: str, count: int) -> tuple[str, ...]:
    return tuple(f"{word}_{k}" for k in range(1, count + 1))


def _spring(number: int, stiffness: float, gap: float) -> TrainSpring:
    try:
        return TrainSpring.linear(float(stiffness), float(gap))
    except InputError as error:
        raise InputError(f"spring {number}: {error}") from None


def _row(
    start: int, end: int | None, spring: TrainSpring
) -> tuple[int, int | None, list[float], list[float], float, list[tuple[float, float, float]]]:
    return (
        start,
        end,
        list(spring.knees_rad),
        list(spring.slopes_nm_per_rad),
        spring.unloaded_rad,
        [tuple(element) for element in spring.friction],
    )


def _same_length(what: str, found: int, expected: int, where: str = "") -> None:
    if found != expected:
        raise InputError(f"{what}: found {found}, expected {expected}{where}")
