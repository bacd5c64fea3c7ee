"""Torques on the nodes of a train, as straight lines between knots in time."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np
import numpy.typing as npt

from cyclosweep.dynamics.chain import Chain
from cyclosweep.dynamics.checks import real
from cyclosweep.errors import InputError, instance_of

__all__ = ["History", "Torques", "knots"]

Reals = npt.NDArray[np.float64]
History = tuple[Sequence[float] | Reals, Sequence[float] | Reals]
"""Times [s] and torques [N m], joined by straight lines."""
Torques = (
    Mapping[str | int, float | History]
    | Mapping[str, float | History]
    | Mapping[int, float | History]
)
"""Torque on each node by its name or number: constant, or a history."""


def knots(train: Chain, torques: Torques, duration_s: float) -> tuple[Reals, Reals]:
    """Knots between which every torque is a straight line.

    Parameters
    ----------
    train : Chain
        The nodes.
    torques : mapping
        As for :meth:`cyclosweep.dynamics.Train.transient`.
    duration_s : float
        End of the last line [s].

    Returns
    -------
    times, torques : ndarray, shapes (knots,) and (knots, nodes)
        Times [s], where a jump has two equal ones; torques on the nodes' own shafts [N m].

    Raises
    ------
    InputError
        For an unknown node, times that fall, or numbers that are none.
    """
    instance_of("torques", torques, Mapping)
    duration_s = real("duration_s", duration_s)
    if not (math.isfinite(duration_s) and duration_s > 0):
        raise InputError(f"duration_s: found {duration_s:g}, expected a number above zero")
    histories: dict[int, tuple[Reals, Reals]] = {}
    for name, torque in torques.items():
        node = train.node(name)
        if node in histories:
            raise InputError(f"torques: node {name!r} is given twice")
        histories[node] = _history(name, torque)
    inner = np.concatenate([np.zeros(0), *(times for times, _ in histories.values())])
    inner = np.unique(inner[(inner > 0) & (inner < duration_s)])
    times = np.repeat(np.r_[0.0, inner, duration_s], 2)[1:-1]
    table = np.zeros((len(times), len(train.names)))
    for node, (own, values) in histories.items():
        if len(values) == 1:
            table[:, node] = values
            continue
        table[0::2, node] = _side(own, values, times[0::2], "right")
        table[1::2, node] = _side(own, values, times[1::2], "left")
    return times, table


def _history(name: str | int, torque: float | History) -> tuple[Reals, Reals]:
    if isinstance(torque, (int, float)):
        torque = ([0.0], [real(f"torque of {name}", torque)])
    try:
        times, values = (np.asarray(each, dtype=np.float64) for each in torque)
    except (TypeError, ValueError, OverflowError):
        raise InputError(
            f"torque of {name}: found {torque!r}, expected a number, or times and torques"
        ) from None
    if times.ndim != 1 or times.shape != values.shape or not len(times):
        raise InputError(f"torque of {name}: expected as many times as torques, at least one")
    if not (np.isfinite(times).all() and np.isfinite(values).all()):
        raise InputError(f"torque of {name}: expected finite numbers")
    if (np.diff(times) < 0).any():
        raise InputError(f"torque of {name}: time_s falls, expected times that rise")
    return times, values


def _side(times: Reals, values: Reals, at: Reals, side: Literal["left", "right"]) -> Reals:
    """Value just behind (``right``) or just before (``left``) each time of a history."""
    after = np.searchsorted(times, at, side)
    low, high = np.maximum(after - 1, 0), np.minimum(after, len(times) - 1)
    width = times[high] - times[low]
    share = np.where(width > 0, (at - times[low]) / np.where(width > 0, width, 1.0), 0.0)
    return np.asarray(values[low] + share * (values[high] - values[low]))
