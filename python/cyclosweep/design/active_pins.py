"""Which hole-pin contacts carry torque over one turn of the mesh zone."""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import polars as pl

import cyclosweep._core as _core

__all__ = ["CRITERIA", "ActivePins", "Criterion", "count_active_pins"]

Criterion = Literal["published-map", "inside", "statics"]
CRITERIA: tuple[Criterion, ...] = ("published-map", "inside", "statics")


class ActivePins(NamedTuple):
    """Active hole-pin contacts of one drive, all discs together, over one turn.

    Attributes
    ----------
    mean, minimum, maximum : float, int, int
        Number of active contacts [1].
    torque_transfer_efficiency : float
        eta_OP [1], Eqs. (1)-(3).
    sectors : polars.DataFrame
        Columns ``start_deg``, ``end_deg`` (position of the mesh zone) and ``active``.
    """

    mean: float
    minimum: int
    maximum: int
    torque_transfer_efficiency: float
    sectors: pl.DataFrame


def count_active_pins(
    criterion: Criterion,
    *,
    ratio: int,
    disc_count: int,
    output_pin_count: int,
    half_sine: float,
    clocking_deg: float,
) -> ActivePins:
    """Count the active hole-pin contacts of an arrangement of holes.

    Parameters
    ----------
    criterion : {"published-map", "inside", "statics"}
        The rule; see :meth:`cyclosweep.Drive.active_pins`.
    ratio, disc_count, output_pin_count : int
        Reduction ratio, discs, output pins [1].
    half_sine : float
        Eccentricity over the diameter of the pins' circle, e / (2 R_OP) [1], below 1.
    clocking_deg : float
        Clocking of the hole pattern [deg].

    Returns
    -------
    ActivePins

    Raises
    ------
    DesignError
        When a count is outside what the model covers.
    """
    code = CRITERIA.index(criterion)
    arrangement = (
        float(ratio),
        disc_count,
        output_pin_count,
        math.asin(half_sine) / math.tau,
        clocking_deg / 360,
    )
    (mean, low, high), _, _ = _core.active_pins(code, *arrangement)
    starts, ends, active = zip(*_core.sectors(code, *arrangement), strict=True)
    sectors = pl.DataFrame({"start_deg": starts, "end_deg": ends, "active": active})
    efficiency = mean / (0.5 * disc_count * output_pin_count)
    return ActivePins(
        mean, low, high, efficiency, sectors.with_columns(pl.col("start_deg", "end_deg") * 360)
    )
