"""Columns of variants as the compiled models give them: values of axes, statuses and results."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

import cyclosweep._core as _core
from cyclosweep.sweep.memory import take
from cyclosweep.sweep.train_columns import (
    TRAIN_COLUMNS,
    needed_inputs,
    needed_results,
    train_columns,
)

if TYPE_CHECKING:
    import numpy.typing as npt

    from cyclosweep.sweep.study import Study

    _Column = npt.NDArray[np.float64] | npt.NDArray[np.uint32]
    _Columns = Mapping[str, _Column]

__all__ = ["result_columns", "stretch_columns"]


def stretch_columns(study: Study, names: list[str], start: int, stop: int) -> pl.DataFrame:
    """Values of axes, numbers and results of all variants of a stretch, in one pass.

    Parameters
    ----------
    study : Study
        What they belong to.
    names : list of str
        ``variant``, axes, ``status`` and result columns; without the last two the models are not
        evaluated.
    start, stop : int
        Variants of the whole space, slices not applied.

    Returns
    -------
    polars.DataFrame
        Columns in the order of ``names``.
    """
    varying = {"variant", *(axis.name for axis in study.space.axes)}
    inputs = [name for name in names if name in varying]
    axes = [name for name in inputs if name != "variant"]
    results = [name for name in names if name not in varying]
    if results:
        series, values = _results(study, results, start, stop, None, axes)
    else:
        series, values = [], _axis_values(study, axes, start, stop)
    found = _axis_series(study, inputs, values, start, stop) + series
    return pl.DataFrame(found).select(names)


def _axis_values(study: Study, axes: list[str], start: int, stop: int) -> _Columns:
    """Values of axes alone."""
    memory = take(len(axes) * (stop - start))
    study.core.fill_axes(axes, start, stop, memory)
    return dict(zip(axes, memory.reshape(len(axes), stop - start), strict=True))


def _axis_series(
    study: Study, names: list[str], values: _Columns, start: int, stop: int
) -> list[pl.Series]:
    """Numbers of variants, and axes with the type that they have in a table."""
    dtypes = study.schema()
    columns = []
    for name in names:
        if name == "variant":
            columns.append(pl.int_range(start, stop, dtype=pl.UInt64, eager=True).alias(name))
        elif name == "criterion":
            codes = pl.Series(name, values[name].astype(np.uint8))
            columns.append(codes.cat.to(dtypes[name]))
        else:
            columns.append(pl.Series(name, values[name]).cast(dtypes[name]))
    return columns


def result_columns(
    study: Study,
    names: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> list[pl.Series]:
    """Statuses and results of variants by the models alone.

    Parameters
    ----------
    study : Study
        What they belong to.
    names : list of str
        ``status`` and result columns.
    start, stop : int
        Variants of the whole space, slices not applied.
    picked : ndarray of uint64, optional
        Which of them; all without it.

    Returns
    -------
    list of polars.Series
    """
    return _results(study, names, start, stop, picked, [])[0]


def _results(
    study: Study,
    names: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
    axes: list[str],
) -> tuple[list[pl.Series], _Columns]:
    """Statuses and results as columns; values of axes beside them, where all variants are meant."""
    wanted = [name for name in names if name != "status"]
    of_train = [name for name in wanted if name in TRAIN_COLUMNS]
    with_parts = study.model == "components"
    outputs = [name for name in wanted if name not in TRAIN_COLUMNS]
    if of_train:
        outputs = list(dict.fromkeys([*outputs, *needed_results(with_parts)]))
    of_parts = [name for name in outputs if name in _PARTS and study.model == "components"]
    published = [name for name in outputs if name not in of_parts]
    status, any_refused, inputs, columns = _evaluated(study, axes, published, start, stop, picked)
    values = dict(columns)
    may_not_apply = dict(zip(published, study.core.may_not_apply(published), strict=True))
    if study.model == "components":
        status, any_refused, solved = _solved(study, of_parts, start, stop, picked)
        values.update(zip(of_parts, solved, strict=True))
        may_not_apply.update(dict.fromkeys(of_parts, True))
    if of_train:
        train = _train_inputs(study, with_parts, start, stop, picked)
        train.update((name, np.asarray(values[name], float)) for name in needed_results(with_parts))
        values.update(train_columns(of_train, train, with_parts))
        may_not_apply.update(dict.fromkeys(of_train, True))
    outputs = wanted
    dtypes = study.schema()
    series = {"status": pl.Series("status", status)}
    for name in outputs:
        series[name] = pl.Series(name, values[name], nan_to_null=may_not_apply[name])
    table = pl.DataFrame(series)
    if any_refused and outputs:
        # Nothing is copied: polars joins the validity to the columns.
        built = pl.col("status") == 0
        table = table.with_columns(pl.when(built).then(pl.col(*outputs)))
    table = table.with_columns(
        *(_cast(name, dtypes[name]) for name in outputs if dtypes[name] != table.schema[name]),
        pl.col("status").cat.to(dtypes["status"]),
    )
    return [table[name] for name in names], inputs


def _train_inputs(
    study: Study,
    with_parts: bool,
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> dict[str, npt.NDArray[np.float64] | float]:
    """Inputs of the torsional train: columns where they vary, numbers elsewhere, NaN without."""
    drive = study.space.drive
    varying = {axis.name for axis in study.space.axes}
    names = needed_inputs(with_parts)
    axes = [name for name in names if name in varying]
    found: dict[str, npt.NDArray[np.float64] | float] = {}
    for name in names:
        value = getattr(drive, name)
        found[name] = math.nan if value is None else float(value)
    for name, column in zip(axes, study.core.axes(axes, start, stop), strict=True):
        found[name] = column if picked is None else column[picked - np.uint64(start)]
    return found


_PARTS = frozenset(name for name, _ in _core.part_output_table())


def _cast(name: str, dtype: pl.DataType) -> pl.Expr:
    """Turn a column of floats into its own type; codes into the words of an Enum."""
    if isinstance(dtype, pl.Enum):
        return pl.col(name).cast(pl.UInt8).cat.to(dtype)
    return pl.col(name).cast(dtype)


def _evaluated(
    study: Study,
    axes: list[str],
    outputs: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> tuple[npt.NDArray[np.uint8], bool, _Columns, _Columns]:
    """Statuses of the published model, axes, of all variants only, and its columns."""
    if picked is not None:
        status, any_refused, columns = study.core.evaluate_at(picked, outputs)
        return status, any_refused, {}, dict(zip(outputs, columns, strict=True))
    dtypes = study.schema()
    names, height = [*axes, *outputs], stop - start
    are_counts = [dtypes[name] == pl.UInt32() for name in names]
    counts = sum(are_counts)
    reals = len(names) - counts
    real_memory = take(reals * height)
    count_memory = take(-(-counts * height // 2)).view(np.uint32)[: counts * height]
    status, any_refused = study.core.fill_range(
        start, stop, axes, outputs, are_counts, real_memory, count_memory
    )
    of_reals: Iterator[_Column] = iter(real_memory.reshape(reals, height))
    of_counts: Iterator[_Column] = iter(count_memory.reshape(counts, height))
    written = [next(of_counts if is_count else of_reals) for is_count in are_counts]
    return (
        status,
        any_refused,
        dict(zip(axes, written[: len(axes)], strict=True)),
        dict(zip(outputs, written[len(axes) :], strict=True)),
    )


def _solved(
    study: Study,
    outputs: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> tuple[npt.NDArray[np.uint8], bool, npt.NDArray[np.float64]]:
    """Statuses of both models and the component model's columns."""
    if picked is None:
        return study.part_core.evaluate_range(study.core, start, stop, outputs)
    return study.part_core.evaluate_at(study.core, picked, outputs)
