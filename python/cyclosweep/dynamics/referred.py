"""A train as the core takes it: everything referred to the first shaft."""

from __future__ import annotations

from typing import NamedTuple

import cyclosweep._core as _core
from cyclosweep.dynamics.chain import Chain
from cyclosweep.dynamics.spring import SlipElement, TrainSpring
from cyclosweep.errors import InputError

__all__ = ["Brake", "referred"]


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


def referred(train: Chain, brake: Brake | None = None) -> _core.Train:
    """Return the core's train, everything referred to the first shaft.

    Parameters
    ----------
    train : Chain
        Every shaft in its own terms.
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
    at_nodes = train.node_ratios
    last = len(train.inertias_kg_m2) - 1
    rows = []
    for k, (spring, ratio) in enumerate(zip(train.springs, train.spring_ratios, strict=True)):
        rows.append(_row(k, k + 1 if k < last else None, spring.scaled(float(ratio))))
    if brake is not None:
        friction = TrainSpring((), (0.0,), 0.0, (brake.element,))
        rows.append(_row(brake.node, None, friction.scaled(float(at_nodes[brake.node]))))
    inertias = [
        inertia / float(ratio) ** 2
        for inertia, ratio in zip(train.inertias_kg_m2, at_nodes, strict=True)
    ]
    try:
        return _core.Train(inertias, rows, train.damping_s)
    except ValueError as error:
        raise InputError(f"train: {error}") from None


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
