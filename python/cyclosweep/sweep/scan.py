"""A sweep as a lazy polars source: what a query does not need is not computed.

polars marks the interface of lazy sources unstable; this file is the only one that uses it. The
engine trusts the source: it must apply the predicate and the row limit itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import polars as pl
from polars.io.plugins import register_io_source

import cyclosweep._core as _core
from cyclosweep.design.parts import Engine
from cyclosweep.errors import InputError
from cyclosweep.sweep.memory import take
from cyclosweep.sweep.study import Limits, Study, StudyModel
from cyclosweep.sweep.train_columns import (
    TRAIN_COLUMNS,
    needed_inputs,
    needed_results,
    train_columns,
)

if TYPE_CHECKING:
    import numpy.typing as npt

    from cyclosweep.sweep.space import Space

__all__ = ["Evaluations", "frame", "kernel_evaluations", "scan", "sweep"]

DEFAULT_BATCH = 100_000
SOLVED_BATCH = 5_000
"""Variants a batch whose equilibria are solved: well under a second, or Ctrl-C would hang."""
_LARGEST_FRAME = 2**32 - 1  # rows polars can count


class Evaluations(NamedTuple):
    """What the kernel has computed in this process.

    Attributes
    ----------
    variants : int
        Variants it was given.
    values : int
        Values of result columns.
    """

    variants: int
    values: int


def kernel_evaluations() -> Evaluations:
    """Count what the kernel has computed in this process: what a query did not need is not in it.

    Returns
    -------
    Evaluations

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=range(6, 13))
    >>> before = kernel_evaluations()
    >>> query = cs.scan(space).filter(pl.col("output_pin_count") > 10).select("twist_1tn_deg")
    >>> rows = query.collect().height
    >>> rows, kernel_evaluations().variants - before.variants
    (2, 2)
    """
    return Evaluations(*_core.kernel_evaluations())


def scan(
    space: Space | Study,
    *,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    model: StudyModel | None = None,
    solver: Engine | None = None,
) -> pl.LazyFrame:
    """Sweep a space lazily.

    Conditions on ``variant`` and on inputs are applied before the kernel, only the results that
    the query needs are computed, and memory follows the engine's batches, not the space.

    Parameters
    ----------
    space : Space or Study
        What varies.
    loads_tn : sequence of float, optional
        Loads [T_N] at which twists are computed; 1, 2, 3, 4 and 4.5 by default.
    limits : mapping, optional
        ``{column: (least or None, greatest or None)}``; a variant outside gets the status
        ``limit_<column>`` and null results.
    model : {"published", "components"}, optional
        The published model alone, by default, or with the component model's columns, each of
        which is solved for only where a query needs it.
    solver : {"quadratic", "full"}, optional
        How the component model finds its equilibria; the faster one by default.

    Returns
    -------
    polars.LazyFrame
        Columns ``variant``, the inputs that vary, ``status`` and the results; a variant that
        cannot be built keeps its row, with the reason as its status and null results.

    Raises
    ------
    InputError
        For loads or limits that make no sense.

    Notes
    -----
    The engine does not push ``slice(k, n)`` and ``tail`` down to a source: use ``space[a:b]``.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9, 10])
    >>> cs.scan(space).filter(pl.col("output_pin_count") > 8).select("active_pins_max").collect()[
    ...     "active_pins_max"
    ... ].to_list()
    [10, 10]
    """
    study = Study.of(space, loads_tn=loads_tn, limits=limits, model=model, solver=solver)
    most = DEFAULT_BATCH if study.model == "published" else SOLVED_BATCH

    def source(
        with_columns: list[str] | None,
        predicate: pl.Expr | None,
        n_rows: int | None,
        batch_size: int | None,
    ) -> Iterator[pl.DataFrame]:
        wanted = list(study.schema()) if with_columns is None else with_columns
        start = study.space.start
        stop = study.space.stop if n_rows is None else min(study.space.stop, start + n_rows)
        size = min(batch_size or most, most) if most < DEFAULT_BATCH else batch_size or most
        for first in range(start, stop, size):
            yield frame(study, first, min(first + size, stop), wanted, predicate)

    return register_io_source(
        source, schema=study.schema(), is_pure=True, explain_name="cyclosweep"
    )


def sweep(
    space: Space | Study,
    *,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    model: StudyModel | None = None,
    solver: Engine | None = None,
) -> pl.DataFrame:
    """Sweep a space into memory.

    Parameters
    ----------
    space : Space or Study
        What varies.
    loads_tn, limits, model, solver : optional
        As for :func:`scan`.

    Returns
    -------
    polars.DataFrame
        One row a variant, in order.

    Raises
    ------
    InputError
        As for :func:`scan`, and for more variants than a frame can hold.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), eccentricity_mm=[0.6, 0.9])
    >>> cs.sweep(space)["status"].to_list()
    ['ok', 'eccentricity_too_large_for_ring']
    """
    study = Study.of(space, loads_tn=loads_tn, limits=limits, model=model, solver=solver)
    count = study.space.stop - study.space.start
    if count > _LARGEST_FRAME:
        raise InputError(
            f"{count:,} variants do not fit into one frame, expected scan, sink or a slice"
        )
    return frame(study, study.space.start, study.space.stop, list(study.schema()))


def frame(
    study: Study,
    start: int,
    stop: int,
    columns: Sequence[str],
    predicate: pl.Expr | None = None,
) -> pl.DataFrame:
    """Columns of variants start..stop for which a predicate holds.

    Parameters
    ----------
    study : Study
        What is computed.
    start, stop : int
        Variants of the whole space, slices not applied.
    columns : sequence of str
        Columns wanted, in order.
    predicate : polars.Expr, optional
        Condition; its parts on inputs alone are applied before the kernel.

    Returns
    -------
    polars.DataFrame
    """
    cheap = {"variant", *(axis.name for axis in study.space.axes)}
    before, after = _split(predicate, cheap)
    needed = dict.fromkeys(columns)
    for condition in after:
        needed.update(dict.fromkeys(condition.meta.root_names()))
    results = [name for name in needed if name not in cheap]
    first = dict.fromkeys(name for name in needed if name in cheap)
    for condition in before:
        first.update(dict.fromkeys(condition.meta.root_names()))
    if before:
        inputs = _inputs(study, list(dict.fromkeys(["variant", *first])), start, stop)
        inputs = inputs.filter(*before)
        if not results:
            return inputs.select(columns)
        picked = None if inputs.height == stop - start else inputs["variant"].to_numpy()
    else:
        # A frame without columns has no height: the number of the variant stands in.
        inputs, picked = _inputs(study, list(first) or ["variant"], start, stop), None
    if not results:
        return inputs.select(columns)
    whole = inputs.with_columns(_results(study, results, start, stop, picked))
    if after:
        whole = whole.filter(*after)
    return whole.select(columns)


def _split(predicate: pl.Expr | None, cheap: set[str]) -> tuple[list[pl.Expr], list[pl.Expr]]:
    """Divide a conjunction into terms on ``cheap`` columns alone, and the others."""
    if predicate is None:
        return [], []
    parts = predicate.meta.pop()
    if len(parts) == 2 and (parts[1] & parts[0]).meta.eq(predicate):
        before, after = _split(parts[1], cheap)
        more_before, more_after = _split(parts[0], cheap)
        return before + more_before, after + more_after
    return ([predicate], []) if set(predicate.meta.root_names()) <= cheap else ([], [predicate])


def _inputs(study: Study, names: list[str], start: int, stop: int) -> pl.DataFrame:
    dtypes = study.schema()
    axes = [name for name in names if name != "variant"]
    memory = take(len(axes) * (stop - start))
    study.core.fill_axes(axes, start, stop, memory)
    values = dict(zip(axes, memory.reshape(len(axes), stop - start), strict=True))
    columns = []
    for name in names:
        if name == "variant":
            columns.append(pl.int_range(start, stop, dtype=pl.UInt64, eager=True).alias(name))
        elif name == "criterion":
            codes = pl.Series(name, values[name].astype(np.uint8))
            columns.append(codes.cat.to(dtypes[name]))
        else:
            columns.append(pl.Series(name, values[name]).cast(dtypes[name]))
    return pl.DataFrame(columns)


def _results(
    study: Study,
    names: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> list[pl.Series]:
    wanted = [name for name in names if name != "status"]
    of_train = [name for name in wanted if name in TRAIN_COLUMNS]
    with_parts = study.model == "components"
    outputs = [name for name in wanted if name not in TRAIN_COLUMNS]
    if of_train:
        outputs = list(dict.fromkeys([*outputs, *needed_results(with_parts)]))
    of_parts = [name for name in outputs if name in _PARTS and study.model == "components"]
    published = [name for name in outputs if name not in of_parts]
    status, any_refused, columns = _evaluated(study.core, published, start, stop, picked)
    values = dict(zip(published, columns, strict=True))
    may_not_apply = dict(zip(published, study.core.may_not_apply(published), strict=True))
    if study.model == "components":
        status, any_refused, columns = _solved(study, of_parts, start, stop, picked)
        values.update(zip(of_parts, columns, strict=True))
        may_not_apply.update(dict.fromkeys(of_parts, True))
    if of_train:
        inputs = _train_inputs(study, with_parts, start, stop, picked)
        results = {name: values[name] for name in needed_results(with_parts)}
        values.update(train_columns(of_train, {**inputs, **results}, with_parts))
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
        *(_cast(name, dtypes[name]) for name in outputs if dtypes[name] != pl.Float64()),
        pl.col("status").cat.to(dtypes["status"]),
    )
    return [table[name] for name in names]


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
    core: _core.Study,
    outputs: list[str],
    start: int,
    stop: int,
    picked: npt.NDArray[np.uint64] | None,
) -> tuple[npt.NDArray[np.uint8], bool, npt.NDArray[np.float64]]:
    """Statuses of the published model and its columns."""
    if picked is None:
        memory = take(len(outputs) * (stop - start))
        status, any_refused = core.fill_range(start, stop, outputs, memory)
        return status, any_refused, memory.reshape(len(outputs), stop - start)
    return core.evaluate_at(picked, outputs)


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
