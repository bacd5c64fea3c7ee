"""Rows of a study wherever they are, read batch by batch: a frame, a folder, a file or a space."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import polars as pl

from cyclosweep.errors import InputError, instance_of
from cyclosweep.sweep.dataset_files import scan_dataset
from cyclosweep.sweep.expressions import condition, number
from cyclosweep.sweep.progress import Progress, ShowProgress
from cyclosweep.sweep.scan import scan
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Limits, Study
from cyclosweep.sweep.table_files import read_table

__all__ = ["Conditions", "Rows", "Table", "batches", "conditions", "open_table"]

Table = pl.LazyFrame | pl.DataFrame | Space | Study | str | Path
"""Where rows may come from; text is the path of a study folder or of a table's file."""

Conditions = Limits | Sequence[str] | str
"""``{column or expression: (least or None, greatest or None)}``, or comparisons as text."""

_BATCH_ROWS = 100_000
"""Rows read at a time: some megabytes for ten columns, well under a second of work."""


class Rows(NamedTuple):
    """Rows that can be read lazily.

    Attributes
    ----------
    frame : polars.LazyFrame
        The rows.
    schema : dict
        Columns and their types.
    total : int
        How many there are; 0 where only reading them all would tell.
    """

    frame: pl.LazyFrame
    schema: dict[str, pl.DataType]
    total: int


def open_table(table: Table) -> Rows:
    """Open rows without reading them.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        A frame; a space or study, which is swept while it is read; a study's folder; or a CSV,
        Excel or Parquet file.

    Returns
    -------
    Rows

    Raises
    ------
    InputError
        For anything else, and for a path at which there is no study and no table.
    """
    if isinstance(table, pl.DataFrame):
        return Rows(table.lazy(), dict(table.schema), table.height)
    if isinstance(table, pl.LazyFrame):
        return Rows(table, dict(table.collect_schema()), 0)
    if isinstance(table, Study | Space):
        study = Study.of(table)
        frame = scan(study)
        total = study.space.stop - study.space.start
        return Rows(frame, dict(frame.collect_schema()), 0 if study.only_ok else total)
    if not isinstance(table, str | Path):
        raise InputError(f"table: found {table!r}, expected a frame, a space, a study or a path")
    path = Path(table)
    if path.is_dir():
        frame = scan_dataset(path)
    elif path.suffix == ".parquet" and path.is_file():
        frame = pl.scan_parquet(path)
    else:
        return open_table(read_table(path))
    try:
        # Of Parquet files this reads the footers alone.
        total = frame.select(pl.len()).collect().item()
        return Rows(frame, dict(frame.collect_schema()), total)
    except pl.exceptions.PolarsError as error:
        raise InputError(f"{path}: {str(error).splitlines()[0]}") from None


def conditions(
    limits: Conditions | None, schema: Mapping[str, pl.DataType], *, only_ok: bool = True
) -> list[pl.Expr]:
    """Conditions that a row must meet.

    Parameters
    ----------
    limits : mapping, sequence of str or str, optional
        ``{column or expression: (least or None, greatest or None)}``, or comparisons such as
        ``hole_web_mm > 2``. A value that is null or NaN is outside.
    schema : mapping of str to polars.DataType
        Columns there are.
    only_ok : bool
        Whether a row must also have the status ``ok``, where there is such a column.

    Returns
    -------
    list of polars.Expr
        Each of type Boolean.

    Raises
    ------
    InputError
        For an unknown column or text that is no expression.
    """
    found = []
    if only_ok and "status" in schema:
        found.append(pl.col("status").cast(pl.String) == "ok")
    if limits is None:
        return found
    instance_of("limits", limits, Mapping, Sequence)
    if isinstance(limits, str):
        limits = [limits]
    if not isinstance(limits, Mapping):
        return found + [condition(text, schema, where="limits") for text in limits]
    for text, bounds in limits.items():
        low, high = _bounds(text, bounds)
        value = number(text, schema, where=f"limits.{text}")
        found.append(value.is_not_nan())
        if low is not None:
            found.append(value >= low)
        if high is not None:
            found.append(value <= high)
    return found


def _bounds(text: str, bounds: object) -> tuple[float | None, float | None]:
    pair = list(bounds) if isinstance(bounds, tuple | list) else []
    if len(pair) != 2 or any(
        end is not None and (not isinstance(end, int | float) or end != end) for end in pair
    ):
        raise InputError(
            f"limits.{text}: found {bounds!r}, expected (least, greatest), each a number or None"
        )
    low, high = pair
    if low is not None and high is not None and low > high:
        raise InputError(f"limits.{text}: found {low:g} to {high:g}, expected min <= max")
    return low, high


def batches(
    rows: Rows, columns: Sequence[pl.Expr], label: str, *, progress: ShowProgress = None
) -> Iterator[pl.DataFrame]:
    """Columns of all rows, batch by batch in order, with a progress bar.

    Parameters
    ----------
    rows : Rows
        What is read.
    columns : sequence of polars.Expr
        What is computed of each row.
    label : str
        What stands before the bar.
    progress : bool or callable, optional
        Whether there is a bar; by default after two seconds when standard error is a terminal.

    Yields
    ------
    polars.DataFrame
    """
    source = rows.frame.select(*columns).collect_batches(chunk_size=_BATCH_ROWS, lazy=True)
    try:
        with Progress(label, rows.total, show=progress) as bar:
            for batch in source:
                yield batch
                bar.advance(batch.height)
    except pl.exceptions.PolarsError as error:
        raise InputError(f"table: {str(error).splitlines()[0]}") from None
