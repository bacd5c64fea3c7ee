"""A sweep as a lazy polars source: what a query does not need is not computed.

polars marks the interface of lazy sources unstable; this file is the only one that uses it. The
engine trusts the source: it must apply the predicate and the row limit itself.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import polars as pl
from polars.io.plugins import register_io_source

import cyclosweep._core as _core
from cyclosweep.design.parts import Engine
from cyclosweep.errors import InputError
from cyclosweep.sweep.own_columns import Own
from cyclosweep.sweep.rows import frame
from cyclosweep.sweep.study import Limits, Study, StudyModel

if TYPE_CHECKING:
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
    constraints: Mapping[str, Own] | None = None,
    columns: Mapping[str, Own] | None = None,
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
    constraints, columns : mapping, optional
        Conditions and columns of your own by name, as for :meth:`cyclosweep.Study.of`.

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
    study = Study.of(
        space,
        loads_tn=loads_tn,
        limits=limits,
        model=model,
        solver=solver,
        constraints=constraints,
        columns=columns,
    )
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

    rows = register_io_source(
        source, schema=study.schema(), is_pure=True, explain_name="cyclosweep"
    )
    if study.only_ok:
        rows = rows.filter(pl.col("status") == "ok")
    return rows if study.keep is None else rows.select(study.given())


def sweep(
    space: Space | Study,
    *,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    model: StudyModel | None = None,
    solver: Engine | None = None,
    constraints: Mapping[str, Own] | None = None,
    columns: Mapping[str, Own] | None = None,
) -> pl.DataFrame:
    """Sweep a space into memory.

    Parameters
    ----------
    space : Space or Study
        What varies.
    loads_tn, limits, model, solver, constraints, columns : optional
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
    study = Study.of(
        space,
        loads_tn=loads_tn,
        limits=limits,
        model=model,
        solver=solver,
        constraints=constraints,
        columns=columns,
    )
    count = study.space.stop - study.space.start
    if count > _LARGEST_FRAME:
        raise InputError(
            f"{count:,} variants do not fit into one frame, expected scan, sink or a slice"
        )
    return study.select(frame(study, study.space.start, study.space.stop, study.computed()))
