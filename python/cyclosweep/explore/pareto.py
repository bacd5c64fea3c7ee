"""The Pareto front of a study of any size: variants that are best in one objective or a balance."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.errors import InputError, instance_of
from cyclosweep.explore.dominance import Front
from cyclosweep.explore.tables import Conditions, Rows, Table, batches, conditions, open_table
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.progress import ShowProgress

__all__ = ["Objectives", "objectives_of", "pareto_front"]

Objectives = Mapping[str, str] | Sequence["Objective | str"] | Objective | str
"""What is to be small or great, as :func:`pareto_front` takes it."""

_SENSES = {"min": False, "minimise": False, "minimize": False,
           "max": True, "maximise": True, "maximize": True}  # fmt: skip
_ROW = "__row"


def pareto_front(
    table: Table,
    objectives: Objectives,
    limits: Conditions | None = None,
    *,
    only_ok: bool = True,
    progress: ShowProgress = None,
) -> pl.DataFrame:
    """Variants that no other one beats in every objective.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows: a frame; a space or study, swept on the way; a study's folder; or a CSV, Excel or
        Parquet file. Read batch by batch, so it may be larger than the memory.
    objectives : mapping, sequence, Objective or str
        ``{"twist_1tn_deg": "min", "output_stiffness_nm_per_arcmin": "max"}``. A name may be an
        expression of columns. In a sequence a text is minimised, or says which:
        ``["twist_1tn_deg", "max output_stiffness_nm_per_arcmin"]``.
    limits : mapping, sequence of str or str, optional
        ``{column or expression: (least or None, greatest or None)}``, or comparisons such as
        ``hole_web_mm > 2``.
    only_ok : bool
        Whether only rows with the status ``ok`` count, where there is such a column.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    polars.DataFrame
        Every column of the table, and one for each objective that is an expression, named as it
        is written. Sorted by the first objective, the best first; equal rows in their order.
        Variants that are equal in all objectives are all there.

    Raises
    ------
    InputError
        For an unknown column, an objective that is no number, or one named twice.

    Notes
    -----
    A variant is left out when another one is at least as good in every objective and better in
    one. Null and NaN are left out, too. The rows are read twice: first the objectives and limits
    alone, then what else belongs to the front. Memory follows a batch and the front; with many
    objectives, or very many ties, the front can be a large part of the table.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9, 10])
    >>> front = pareto_front(space, {"output_pin_count": "min", "twist_1tn_deg": "min"})
    >>> front["output_pin_count"].to_list()
    [6, 8, 9, 10]
    """
    rows = open_table(table)
    wanted = objectives_of(objectives, rows.schema)
    kept = conditions(limits, rows.schema, only_ok=only_ok)
    values = [number(each.column, rows.schema, where="objective") for each in wanted]
    whole = None
    if rows.schema.get("variant") == pl.UInt64():
        key = pl.col("variant").fill_null(0)
        picked = _picked(rows, wanted, values, kept, key, progress)
        whole = rows_at(rows.frame, "variant", picked)
    if whole is None or whole.height != len(picked):
        # The numbers of the variants do not tell the rows apart: their places do.
        numbered = Rows(rows.frame.with_row_index(_ROW), rows.schema, rows.total)
        picked = _picked(numbered, wanted, values, kept, pl.col(_ROW).cast(pl.UInt64), progress)
        whole = rows_at(numbered.frame, _ROW, picked).drop(_ROW)
    made = {
        each.column: value
        for each, value in zip(wanted, values, strict=True)
        if each.column not in rows.schema
    }
    first, value = wanted[0], values[0]
    return whole.with_columns(**made).sort(value, descending=first.maximise, maintain_order=True)


def objectives_of(
    given: Objectives, columns: Mapping[str, pl.DataType], *, where: str = "objectives"
) -> list[Objective]:
    """Read what is to be small or great.

    Parameters
    ----------
    given : mapping, sequence, Objective or str
        As for :func:`pareto_front`.
    columns : mapping of str to polars.DataType
        Columns there are.
    where : str
        What a message names.

    Returns
    -------
    list of Objective
        At least one; ``column`` may be an expression.

    Raises
    ------
    InputError
        For none, a sense that is neither min nor max, or one objective twice.
    """
    instance_of(where, given, Mapping, Sequence, Objective)
    if isinstance(given, Mapping):
        found = [
            Objective(text.strip(), _is_max(text, sense, where)) for text, sense in given.items()
        ]
    else:
        each = [given] if isinstance(given, str | Objective) else given
        found = [_read(item, columns, where) for item in each]
    if not found:
        raise InputError(f"{where}: none, expected at least one column")
    texts = [each.column for each in found]
    for text in texts:
        if texts.count(text) > 1:
            raise InputError(f"{where}: found {text} twice, expected it once")
    return found


def rows_at(frame: pl.LazyFrame, key: str, values: npt.NDArray[np.uint64]) -> pl.DataFrame:
    """Rows of a frame whose ``key`` is one of some values.

    Parameters
    ----------
    frame : polars.LazyFrame
        The rows.
    key : str
        Column of whole numbers.
    values : ndarray of uint64, shape (rows,)
        What it is to be.

    Returns
    -------
    polars.DataFrame
        In the order of the frame.
    """
    found = frame.filter(pl.col(key).is_in(pl.Series(values).implode()))
    return found.collect(engine="streaming")


def _picked(
    rows: Rows,
    wanted: Sequence[Objective],
    values: Sequence[pl.Expr],
    kept: Sequence[pl.Expr],
    key: pl.Expr,
    progress: ShowProgress,
) -> npt.NDArray[np.uint64]:
    """Keys of the rows on the front, in order."""
    names = [f"__objective_{k}" for k in range(len(wanted))]
    columns = [value.alias(name) for value, name in zip(values, names, strict=True)]
    inside = pl.all_horizontal(*kept, *(value.is_not_nan() for value in values))
    columns += [inside.fill_null(False).alias("__inside"), key.alias("__key")]
    signs = np.array([-1.0 if each.maximise else 1.0 for each in wanted])
    front = Front(len(wanted))
    for batch in batches(rows, columns, "Pareto front", progress=progress):
        inner = batch.filter("__inside")
        front.add(inner.select(names).to_numpy() * signs, inner["__key"].to_numpy())
    return front.result()[1]


def _read(item: object, columns: Mapping[str, pl.DataType], where: str) -> Objective:
    if isinstance(item, Objective):
        return item
    if not isinstance(item, str):
        raise InputError(f"{where}: found {item!r}, expected a column or an expression")
    text = item.strip()
    sense, _, rest = text.partition(" ")
    if text not in columns and sense.lower() in _SENSES and rest.strip():
        return Objective(rest.strip(), _SENSES[sense.lower()])
    return Objective(text)


def _is_max(text: str, sense: object, where: str) -> bool:
    if not isinstance(sense, str) or sense.lower() not in _SENSES:
        raise InputError(f"{where}.{text}: found {sense!r}, expected min or max")
    return _SENSES[sense.lower()]
