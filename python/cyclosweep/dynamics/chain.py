"""What a torsional train is made of: a chain of inertias and springs, and its gear ratios."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

import cyclosweep._core as _core
from cyclosweep.dynamics.checks import finite, floats, numbered, same_length, spring_of
from cyclosweep.dynamics.spring import Brake, TrainSpring
from cyclosweep.errors import InputError, did_you_mean, instance_of

__all__ = ["Chain"]

Reals = npt.NDArray[np.float64]


@dataclass(frozen=True, init=False)
class Chain:
    """Inertias joined by springs; the parameters are those of :class:`Train`."""

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
        inertias = floats("inertias_kg_m2", inertias_kg_m2)
        stiffnesses_nm_per_rad = floats("stiffnesses_nm_per_rad", stiffnesses_nm_per_rad)
        for what, given_names in (("names", names), ("spring_names", spring_names)):
            if given_names is not None:
                instance_of(what, given_names, list, tuple)
        nodes = tuple(names) if names is not None else numbered("node", len(inertias))
        expected = len(inertias) - (0 if grounded else 1)
        if springs is None:
            gaps = (
                [0.0] * len(stiffnesses_nm_per_rad)
                if gaps_rad is None
                else floats("gaps_rad", gaps_rad)
            )
            same_length("gaps_rad", len(gaps), len(stiffnesses_nm_per_rad))
            springs = [
                spring_of(k, stiffness, gap)
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
        same_length("springs", len(springs), expected, " of a grounded train" if grounded else "")
        given = [1.0] * len(springs) if ratios is None else floats("ratios", ratios)
        same_length("ratios", len(given), len(springs))
        for ratio in given:
            if not (math.isfinite(ratio) and ratio > 0):
                raise InputError(f"ratios: found {ratio:g}, expected numbers above zero")
        same_length("names", len(nodes), len(inertias))
        if spring_names is None:
            after = (*nodes[1:], "ground")
            spring_names = [f"{a}-{b}" for a, b in zip(nodes, after, strict=True)][: len(springs)]
        same_length("spring_names", len(spring_names), len(springs))
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
            friction = TrainSpring((), (0.0,), 0.0, (brake.element,))
            rows.append(_row(brake.node, None, friction.scaled(float(at_nodes[brake.node]))))
        inertias = [
            inertia / float(ratio) ** 2
            for inertia, ratio in zip(self.inertias_kg_m2, at_nodes, strict=True)
        ]
        try:
            return _core.Train(inertias, rows, self.damping_s)
        except ValueError as error:
            raise InputError(f"train: {error}") from None

    @cached_property
    def node_ratios(self) -> Reals:
        """Speed of the first shaft over that of each node's, shape (nodes,) [1]."""
        between = self.ratios[: len(self.inertias_kg_m2) - 1]
        return np.cumprod(np.array([1.0, *between]), dtype=np.float64)

    @cached_property
    def spring_ratios(self) -> Reals:
        """Speed of the first shaft over that on which each spring is given, (springs,) [1]."""
        return self.node_ratios[: len(self.springs)]

    def stiffnesses_at(self, torque_nm: float = 0.0) -> Reals:
        """Tangent stiffness of each spring when a torque at the first shaft goes through.

        Parameters
        ----------
        torque_nm : float
            Torque at the first shaft [N m]; zero means just beyond the play, and a negative one
            acts on the other flank.

        Returns
        -------
        ndarray, shape (springs,)
            On the springs' own shafts [N m/rad].

        Raises
        ------
        InputError
            For a torque that is no finite number.
        """
        torques = finite("torque_nm", torque_nm) * self.spring_ratios
        pairs = zip(self.springs, torques, strict=True)
        return np.array([spring.stiffness_at(float(torque)) for spring, torque in pairs])

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
        hint = did_you_mean(name, self.names)
        raise InputError(f"node {name!r}: no such node, expected {', '.join(self.names)}{hint}")

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


def _row(
    start: int, end: int | None, spring: TrainSpring
) -> tuple[int, int | None, list[float], list[float], float, list[tuple[float, float, float]]]:
    return (
        start,
        end,
        list(spring.knees_rad),
        list(spring.slopes_nm_per_rad),
        spring.unloaded_rad,
        [(e.stiffness_nm_per_rad, e.limit_nm, e.load_factor) for e in spring.friction],
    )
