"""What a picture takes from a table of any size: a random sample of rows, or means over cells."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, NamedTuple, get_args

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.errors import InputError, one_of
from cyclosweep.explore.tables import Conditions, Rows, Table, batches, conditions, open_table
from cyclosweep.sweep.expressions import number

__all__ = ["MOST_CELLS", "Cells", "How", "Sample", "cells_of", "rows_of", "sample_of"]

Reals = npt.NDArray[np.float64]
How = Literal["mean", "min", "max"]

MOST_CELLS = 40
"""Values of an input up to which each has a row of cells of its own; others share equal steps."""


class Sample(NamedTuple):
    """Rows drawn from a table.

    Attributes
    ----------
    frame : polars.DataFrame
        ``variant`` where the table has it, and the columns asked for as numbers, in the table's
        order.
    total : int
        Rows of the table that could have been drawn.
    """

    frame: pl.DataFrame
    total: int

    @property
    def said(self) -> str:
        """What a picture has to say of it."""
        if self.frame.height == self.total:
            return f"All {self.total:,} variants."
        return f"{self.frame.height:,} of {self.total:,} variants, drawn at random."


class Cells(NamedTuple):
    """A result over two inputs, in cells.

    Attributes
    ----------
    x, y : ndarray
        Values of the inputs, or the middles of equal steps.
    values : ndarray, shape (y, x)
        The result of each cell, NaN where no row falls.
    counts : ndarray of int, shape (y, x)
        Rows in each cell.
    is_exact : bool
        Whether `x` and `y` are all values that the inputs take.
    how : {"mean", "min", "max"}
        How several rows of a cell are put together.
    """

    x: Reals
    y: Reals
    values: Reals
    counts: npt.NDArray[np.int64]
    is_exact: bool
    how: How

    @property
    def said(self) -> str:
        """What a picture has to say of it."""
        total, most = int(self.counts.sum()), int(self.counts.max(initial=0))
        if most <= 1:
            return f"{total:,} variants, each a point."
        words = {"mean": "Mean", "min": "Smallest", "max": "Largest"}[self.how]
        where = "at a point" if self.is_exact else "in a cell"
        return f"{words} of up to {most:,} variants {where}; {total:,} in all."


def sample_of(
    table: Table,
    columns: Sequence[str],
    *,
    most: int,
    limits: Conditions | None = None,
    only_ok: bool = True,
) -> Sample:
    """Draw rows at random, the same ones each time, in one reading and little memory.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    columns : sequence of str
        Columns or expressions of columns that are numbers.
    most : int
        Rows drawn at most, each with the same probability.
    limits : mapping, sequence of str or str, optional
        Conditions that a row must meet.
    only_ok : bool
        Whether only variants that can be built count.

    Returns
    -------
    Sample
        Rows in which all columns are finite.

    Raises
    ------
    InputError
        For an unknown column, or where no row is left.
    """
    rows = open_table(table)
    values = [number(name, rows.schema).alias(name) for name in dict.fromkeys(columns)]
    kept = [*conditions(limits, rows.schema, only_ok=only_ok), *(v.is_finite() for v in values)]
    label = [pl.col("variant")] if "variant" in rows.schema else []
    found = Rows(rows.frame.filter(*kept), rows.schema, rows.total)
    drawn: list[pl.DataFrame] = []
    held, total, highest = 0, 0, np.iinfo(np.uint64).max
    for batch in batches(found, [*label, *values], "sampling"):
        places = np.arange(total, total + batch.height, dtype=np.uint64)
        total += batch.height
        keyed = batch.with_columns(pl.Series("__row", places), pl.Series("__key", _mixed(places)))
        part = keyed.filter(pl.col("__key") <= highest)
        drawn.append(part)
        held += part.height
        if held > 4 * most:
            drawn = [pl.concat(drawn).bottom_k(most, by="__key")]
            held, highest = most, drawn[0]["__key"].max()  # type: ignore[assignment]
    if total == 0:
        raise InputError("table: no variant is left to draw, expected at least one that is ok")
    chosen = pl.concat(drawn).bottom_k(most, by="__key")
    return Sample(chosen.sort("__row").drop("__row", "__key"), total)


def rows_of(table: Table, variants: Sequence[int], columns: Sequence[str]) -> pl.DataFrame:
    """Chosen variants of a table, in the order asked for.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows with the column ``variant``.
    variants : sequence of int
        Their numbers.
    columns : sequence of str
        Columns or expressions of columns.

    Returns
    -------
    polars.DataFrame
        ``variant`` and the columns.

    Raises
    ------
    InputError
        For a variant that is not there or has no such numbers.
    """
    rows = open_table(table)
    if "variant" not in rows.schema:
        raise InputError("table: no column variant, expected one for chosen variants")
    names = [name for name in dict.fromkeys(columns) if name != "variant"]
    values = [number(name, rows.schema).alias(name) for name in names]
    is_chosen = pl.col("variant").is_in(pl.Series(list(variants)).implode())
    kept = rows.frame.filter(is_chosen, *(value.is_finite() for value in values))
    found = kept.select("variant", *values).collect(engine="streaming")
    for variant in variants:
        if variant not in found["variant"]:
            raise InputError(f"variant {variant}: not among the variants that have these numbers")
    order = pl.DataFrame({"variant": list(variants)}, schema={"variant": found.schema["variant"]})
    return order.join(found, on="variant", how="left", maintain_order="left")


def _mixed(index: npt.NDArray[np.uint64]) -> npt.NDArray[np.uint64]:
    """Numbers that look random, one for each row: the finaliser of splitmix64."""
    z = (index + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


def cells_of(
    table: Table,
    x: str,
    y: str,
    result: str,
    *,
    how: How = "mean",
    limits: Conditions | None = None,
    only_ok: bool = True,
) -> Cells:
    """Put a result into cells over two inputs, in two readings and little memory.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    x, y, result : str
        Columns or expressions of columns that are numbers.
    how : {"mean", "min", "max"}
        How several rows of a cell are put together.
    limits : mapping, sequence of str or str, optional
        Conditions that a row must meet.
    only_ok : bool
        Whether only variants that can be built count.

    Returns
    -------
    Cells
        One row of cells for each value of an input that takes at most :data:`MOST_CELLS`;
        otherwise for each of as many equal steps.

    Raises
    ------
    InputError
        For an unknown column or way, where no row is left, or an input does not vary.
    """
    one_of("how", how, get_args(How))
    rows = open_table(table)
    values = [number(name, rows.schema) for name in (x, y, result)]
    columns = [value.alias(name) for value, name in zip(values, "xyz", strict=True)]
    kept = [*conditions(limits, rows.schema, only_ok=only_ok), *(v.is_finite() for v in values)]
    found = Rows(rows.frame.filter(*kept), rows.schema, rows.total)
    axes = _Values(), _Values()
    for batch in batches(found, columns[:2], "ranges"):
        for axis, name in zip(axes, "xy", strict=True):
            axis.add(batch[name].to_numpy())
    for axis, name in zip(axes, (x, y), strict=True):
        if not axis.low < axis.high:
            raise InputError(f"{name}: takes no two values among the variants, expected two inputs")
    shape = len(axes[1].middles), len(axes[0].middles)
    counts = np.zeros(shape[0] * shape[1], dtype=np.int64)
    held = np.full(len(counts), {"mean": 0.0, "min": np.inf, "max": -np.inf}[how])
    for batch in batches(found, columns, "cells"):
        place = axes[1].place(batch["y"].to_numpy()) * shape[1] + axes[0].place(
            batch["x"].to_numpy()
        )
        z = batch["z"].to_numpy()
        counts += np.bincount(place, minlength=len(counts))
        if how == "mean":
            held += np.bincount(place, weights=z, minlength=len(counts))
        else:
            (np.minimum if how == "min" else np.maximum).at(held, place, z)
    filled = np.where(counts > 0, held / np.maximum(counts, 1) if how == "mean" else held, np.nan)
    is_exact = axes[0].is_exact and axes[1].is_exact
    return Cells(
        axes[0].middles,
        axes[1].middles,
        filled.reshape(shape),
        counts.reshape(shape),
        is_exact,
        how,
    )


class _Values:
    """Values of an input: each of them while they are few, then their range alone."""

    def __init__(self) -> None:
        self.each: Reals = np.zeros(0)
        self.is_exact = True
        self.low, self.high = np.inf, -np.inf

    def add(self, values: Reals) -> None:
        """Take note of some rows' values."""
        if not len(values):
            return
        self.low, self.high = min(self.low, values.min()), max(self.high, values.max())
        if self.is_exact:
            self.each = np.union1d(self.each, values)
            self.is_exact = len(self.each) <= MOST_CELLS

    @property
    def middles(self) -> Reals:
        """Values or middles of the steps, ascending."""
        if self.is_exact:
            return self.each
        edges = np.linspace(self.low, self.high, MOST_CELLS + 1)
        return 0.5 * (edges[1:] + edges[:-1])

    def place(self, values: Reals) -> npt.NDArray[np.int64]:
        """Which of the middles stands for each value."""
        if self.is_exact:
            return np.searchsorted(self.each, values)
        step = (values - self.low) / (self.high - self.low) * MOST_CELLS
        return np.clip(step.astype(np.int64), 0, MOST_CELLS - 1)
