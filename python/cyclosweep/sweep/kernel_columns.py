"""Columns of variants as the compiled models give them: values of axes, statuses and results."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
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

    _Column = npt.NDArray[np.float64] | npt.NDArray[np.uint32] | npt.NDArray[np.uint64]
    _Columns = Mapping[str, _Column]

__all__ = ["KernelArrays", "result_columns", "stretch_arrays", "stretch_columns"]


@dataclass(frozen=True)
class KernelArrays:
    """Columns of variants as the compiled models write them.

    Attributes
    ----------
    dtypes : dict of str to polars.DataType
        Type that each column has in a table.
    inputs : dict of str to ndarray
        Numbers of the variants and values of axes.
    status : ndarray of uint8, or None
        Codes of the statuses; without results none.
    any_refused : bool
        Whether a variant cannot be built, so that its results mean nothing.
    results : dict of str to ndarray
        Results of the models.
    may_not_apply : frozenset of str
        Results that can be NaN for a variant that can be built: there is none.
    of_refused : frozenset of str
        Results that can be numbers for a variant that is refused, and then mean nothing.
    """

    dtypes: Mapping[str, pl.DataType]
    inputs: _Columns
    status: npt.NDArray[np.uint8] | None
    any_refused: bool
    results: _Columns
    may_not_apply: frozenset[str]
    of_refused: frozenset[str]

    def reals(self) -> _Columns:
        """Results that are real numbers, and NaN in every row without a result."""
        return {
            name: values
            for name, values in self.results.items()
            if name not in self.of_refused and values.dtype == np.float64
        }

    def series(self, names: list[str]) -> list[pl.Series]:
        """Columns of a table; null where a variant has no result.

        Parameters
        ----------
        names : list of str
            Which, in order.

        Returns
        -------
        list of polars.Series
        """
        found = {name: self._input(name) for name in names if name in self.inputs}
        found.update(self._results([name for name in names if name not in found]))
        return [found[name] for name in names]

    def _input(self, name: str) -> pl.Series:
        """Numbers of variants, or an axis with the type that it has in a table."""
        values, dtype = self.inputs[name], self.dtypes[name]
        if isinstance(dtype, pl.Enum):
            return pl.Series(name, values.astype(np.uint8)).cat.to(dtype)
        return pl.Series(name, values).cast(dtype)

    def _results(self, names: list[str]) -> dict[str, pl.Series]:
        if not names:
            return {}
        results = [name for name in names if name != "status"]
        series = {"status": pl.Series("status", self.status)}
        for name in results:
            may_not_apply = name in self.may_not_apply
            series[name] = pl.Series(name, self.results[name], nan_to_null=may_not_apply)
        table = pl.DataFrame(series)
        if self.any_refused and results:
            # Nothing is copied: polars joins the validity to the columns.
            built = pl.col("status") == 0
            table = table.with_columns(pl.when(built).then(pl.col(*results)))
        changed = [name for name in results if self.dtypes[name] != table.schema[name]]
        table = table.with_columns(
            *(_cast(name, self.dtypes[name]) for name in changed),
            pl.col("status").cat.to(self.dtypes["status"]),
        )
        return {name: table[name] for name in names}


def stretch_arrays(study: Study, names: list[str], start: int, stop: int) -> KernelArrays:
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
    KernelArrays
    """
    varying = {"variant", *(axis.name for axis in study.space.axes)}
    axes = [name for name in names if name in varying and name != "variant"]
    results = [name for name in names if name not in varying]
    if results:
        found = _arrays(study, results, start, stop, None, axes)
    else:
        memory = take(len(axes) * (stop - start))
        study.core.fill_axes(axes, start, stop, memory)
        values = dict(zip(axes, memory.reshape(len(axes), stop - start), strict=True))
        found = KernelArrays(study.schema(), values, None, False, {}, frozenset(), frozenset())
    if "variant" in names:
        numbers = np.arange(start, stop, dtype=np.uint64)
        found = replace(found, inputs={**found.inputs, "variant": numbers})
    return found


def stretch_columns(study: Study, names: list[str], start: int, stop: int) -> pl.DataFrame:
    """Values of axes, numbers and results of all variants of a stretch, as a table.

    Parameters
    ----------
    study, names, start, stop
        As for :func:`stretch_arrays`.

    Returns
    -------
    polars.DataFrame
        Columns in the order of ``names``.
    """
    return pl.DataFrame(stretch_arrays(study, names, start, stop).series(names))


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
    return _arrays(study, names, start, stop, picked, []).series(names)


def _arrays(
    study: Study,
    names: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
    axes: list[str],
) -> KernelArrays:
    """Statuses and results, and values of axes where all variants are meant."""
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
    absent = frozenset(name for name, may in may_not_apply.items() if may)
    # The published model knows nothing of what the component model refuses.
    unsure = frozenset(values if with_parts else of_train)
    return KernelArrays(study.schema(), inputs, status, any_refused, values, absent, unsure)


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
