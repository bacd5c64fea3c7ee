"""Inputs of a table cut into intervals, so that rows can be counted without being kept."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.errors import InputError, did_you_mean, names_of
from cyclosweep.explore.tables import Rows

__all__ = ["Cut", "cut_inputs", "input_columns"]

_MOST_VALUES = 24
"""Values up to which each is an interval of its own, as those of a grid's axis or of a count."""


@dataclass(frozen=True)
class Cut:
    """One input, cut into intervals.

    Attributes
    ----------
    name : str
        The input.
    low, high : ndarray, shape (intervals,)
        Ends of each, equal where an interval is one value; the last one has its upper end.
    """

    name: str
    low: npt.NDArray[np.float64]
    high: npt.NDArray[np.float64]

    def place(self, values: npt.NDArray[np.float64]) -> npt.NDArray[np.intp]:
        """Number of the interval of each value; values must be those that were cut."""
        place = np.searchsorted(self.low, values, side="right") - 1
        return np.clip(place, 0, len(self.low) - 1)


def input_columns(rows: Rows, inputs: Sequence[str] | None) -> list[str]:
    """Which columns are inputs: those named, or those that a sweep has before its status.

    Parameters
    ----------
    rows : Rows
        The table.
    inputs : sequence of str, optional
        Names of columns.

    Returns
    -------
    list of str
        Columns of numbers.

    Raises
    ------
    InputError
        For an unknown column, one that is no number, or none given for a table of no sweep.
    """
    columns = list(rows.schema)
    if inputs is None:
        if "variant" not in columns or "status" not in columns:
            raise InputError(
                "inputs: none given, expected names of columns: this is no sweep's table"
            )
        first, last = columns.index("variant") + 1, columns.index("status")
        inputs = [name for name in columns[first:last] if rows.schema[name].is_numeric()]
    else:
        inputs = names_of("inputs", inputs)
    for name in inputs:
        if name not in rows.schema:
            raise InputError(f"inputs: no column {name}{did_you_mean(name, columns)}")
        if not rows.schema[name].is_numeric():
            raise InputError(f"inputs: {name} holds no numbers, expected some")
    if not inputs:
        raise InputError("inputs: none, expected at least one column")
    return list(inputs)


def cut_inputs(rows: Rows, inputs: Sequence[str], count: int) -> list[Cut]:
    """Cut inputs into intervals of equal width, or into their values where these are few.

    Parameters
    ----------
    rows : Rows
        The table, which is read once for its ends.
    inputs : sequence of str
        Columns of numbers.
    count : int
        Intervals of an input.

    Returns
    -------
    list of Cut
        For each input that has a value.
    """
    reals = {name: pl.col(name).cast(pl.Float64) for name in inputs}
    ends = [
        [
            value.filter(value.is_finite()).min().alias(f"{k}low"),
            value.filter(value.is_finite()).max().alias(f"{k}high"),
            value.approx_n_unique().alias(f"{k}count"),
        ]
        for k, value in enumerate(reals.values())
    ]
    found = rows.frame.select(each for three in ends for each in three)
    row = found.collect(engine="streaming").row(0, named=True)
    cuts = []
    for k, (name, value) in enumerate(reals.items()):
        low, high = row[f"{k}low"], row[f"{k}high"]
        if low is None:
            continue
        # The count is an estimate; twice the most still may be few enough.
        if row[f"{k}count"] <= 2 * _MOST_VALUES:
            unique = rows.frame.select(value.alias("x")).filter(pl.col("x").is_finite()).unique()
            values = unique.collect(engine="streaming")["x"].sort().to_numpy()
            if len(values) <= _MOST_VALUES:
                cuts.append(Cut(name, values, values))
                continue
        edges = np.linspace(low, high, count + 1)
        cuts.append(Cut(name, edges[:-1], edges[1:]))
    return cuts
