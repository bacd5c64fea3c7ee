"""Variants nearest to a wish: the feasible ones whose columns come closest to target values."""

from __future__ import annotations

from collections.abc import Mapping

import polars as pl

from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.errors import InputError, instance_of
from cyclosweep.explore.tables import Conditions, Table, batches, conditions, open_table
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.progress import ShowProgress

__all__ = ["nearest_variants"]

_DISTANCE = "distance"


def nearest_variants(
    table: Table,
    target: Mapping[str, float],
    *,
    count: int = 10,
    scales: Mapping[str, float] | None = None,
    limits: Conditions | None = None,
    only_ok: bool = True,
    progress: ShowProgress = None,
) -> pl.DataFrame:
    """Feasible variants that come nearest to a wish.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, as for :func:`~cyclosweep.explore.pareto.pareto_front`.
    target : mapping of str to float
        Wanted values of inputs, results or expressions of them, in their units.
    count : int
        How many variants.
    scales : mapping of str to float, optional
        What counts as one unit of distance in a column, in the column's unit. By default the
        standard deviation of the feasible rows, which are read once more for it.
    limits : mapping, sequence of str or str, optional
        As for :func:`~cyclosweep.explore.pareto.pareto_front`.
    only_ok : bool
        Whether only rows with the status ``ok`` count, where there is such a column.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    polars.DataFrame
        Every column of the table and ``distance`` [1], the nearest first: the root of the mean
        square of ``(value - target) / scale`` over the columns of the target. Rows that are
        equally near stand in their order.

    Raises
    ------
    InputError
        For an unknown column, a target that is no finite number, or a scale that is not above 0.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_diameter_mm=[12, 14, 16, 18])
    >>> near = nearest_variants(space, {"output_pin_diameter_mm": 15.5}, count=1)
    >>> near["output_pin_diameter_mm"].item()
    16.0
    """
    rows = open_table(table)
    count = whole_number("count", count, least=1)
    instance_of("target", target, Mapping)
    if not target:
        raise InputError("target: none, expected at least one column and its wanted value")
    if _DISTANCE in rows.schema:
        raise InputError(f"table: has a column {_DISTANCE}, expected another name for it")
    for text, value in target.items():
        finite_number(f"target.{text}", value)
    for text, value in (scales or {}).items():
        if text not in target:
            raise InputError(f"scales.{text}: not in the target, expected one of {list(target)}")
        if finite_number(f"scales.{text}", value) <= 0:
            raise InputError(f"scales.{text}: found {value:g}, expected more than 0")
    values = {text: number(text, rows.schema, where="target") for text in target}
    kept = conditions(limits, rows.schema, only_ok=only_ok)
    inside = pl.all_horizontal(*kept, *(value.is_finite() for value in values.values()))
    frame = rows.frame.filter(inside)
    missing = [text for text in target if text not in (scales or {})]
    unit = {text: float(value) for text, value in (scales or {}).items()}
    if missing:
        spread = frame.select(values[text].std().alias(text) for text in missing)
        for text, value in spread.collect(engine="streaming").row(0, named=True).items():
            # A column that does not vary is equally far for all.
            unit[text] = value or 1.0
    squares = [((values[text] - target[text]) / unit[text]) ** 2 for text in target]
    distance = pl.mean_horizontal(squares).sqrt().alias(_DISTANCE)
    best = pl.DataFrame(schema={**rows.schema, _DISTANCE: pl.Float64()})
    columns = [pl.all(), pl.when(inside).then(distance).alias(_DISTANCE)]
    for batch in batches(rows, columns, "nearest variants", progress=progress):
        near = batch.filter(pl.col(_DISTANCE).is_not_null())
        best = pl.concat([best, near]).sort(_DISTANCE, maintain_order=True).head(count)
    return best
