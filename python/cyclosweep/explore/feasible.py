"""Which ranges of the inputs give feasible designs, and what rules the others out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import polars as pl

from cyclosweep.design.numbers import whole_number
from cyclosweep.explore.intervals import Cut, cut_inputs, input_columns
from cyclosweep.explore.tables import Conditions, Table, batches, conditions, open_table
from cyclosweep.sweep.progress import ShowProgress

__all__ = ["FeasibleRanges", "feasible_ranges"]

INTERVALS = 20
"""Intervals of an input: fine enough to see an end of the feasible range to 5 %."""


@dataclass(frozen=True)
class FeasibleRanges:
    """Where in the ranges of the inputs the feasible variants are.

    Attributes
    ----------
    rows, feasible : int
        Variants, and those of them that are feasible.
    inputs : polars.DataFrame
        For each input ``low`` and ``high`` of all variants, ``feasible_low`` and
        ``feasible_high`` of the feasible ones.
    intervals : polars.DataFrame
        For each interval of each input ``low``, ``high``, ``rows``, ``feasible`` and ``share``.
    rules : polars.DataFrame
        What no feasible variant does, as ``rule``, with the ``rows`` it rules out and their
        ``share_of_infeasible``, the most first. Each holds by itself; together they may not rule
        out everything that is infeasible.
    """

    rows: int
    feasible: int
    inputs: pl.DataFrame
    intervals: pl.DataFrame
    rules: pl.DataFrame


def feasible_ranges(
    table: Table,
    limits: Conditions | None = None,
    *,
    inputs: Sequence[str] | None = None,
    intervals: int = INTERVALS,
    only_ok: bool = True,
    progress: ShowProgress = None,
) -> FeasibleRanges:
    """Find which ranges of the inputs give feasible designs.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, as for :func:`~cyclosweep.explore.pareto.pareto_front`; read batch by batch.
    limits : mapping, sequence of str or str, optional
        What else a feasible variant must meet, as there.
    inputs : sequence of str, optional
        Columns looked at; by default the inputs that vary in a sweep.
    intervals : int
        Into how many equal intervals a range is cut; few values are taken one by one.
    only_ok : bool
        Whether a feasible variant has the status ``ok``, where there is such a column.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    FeasibleRanges

    Raises
    ------
    InputError
        For an unknown column, or no inputs given for a table that is no sweep's.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), eccentricity_mm=cs.linspace(0.5, 1.0, 6))
    >>> feasible_ranges(space).inputs.row(0)
    ('eccentricity_mm', 0.5, 1.0, 0.5, 0.8)
    """
    rows = open_table(table)
    names = input_columns(rows, inputs)
    kept = conditions(limits, rows.schema, only_ok=only_ok)
    cuts = cut_inputs(rows, names, whole_number("intervals", intervals, least=1))
    flag = pl.all_horizontal(pl.lit(True), *kept).fill_null(False).alias("__feasible")
    columns = [pl.col(cut.name).cast(pl.Float64) for cut in cuts]
    counts = [np.zeros((2, len(cut.low)), np.int64) for cut in cuts]
    ends = np.array([[np.inf, -np.inf]] * len(cuts)).reshape(-1, 2)
    total = feasible = 0
    for batch in batches(rows, [*columns, flag], "feasible ranges", progress=progress):
        inside = batch["__feasible"].to_numpy()
        total, feasible = total + len(inside), feasible + int(inside.sum())
        for k, cut in enumerate(cuts):
            values = batch[cut.name].fill_null(np.nan).to_numpy()
            is_number = np.isfinite(values)
            place = cut.place(values[is_number])
            within = inside[is_number]
            counts[k][0] += np.bincount(place, minlength=len(cut.low))
            counts[k][1] += np.bincount(place[within], minlength=len(cut.low))
            met = values[inside & is_number]
            if len(met):
                ends[k] = min(ends[k, 0], met.min()), max(ends[k, 1], met.max())
    return FeasibleRanges(
        total,
        feasible,
        _inputs(cuts, ends),
        pl.concat([_interval_rows(cut, count) for cut, count in zip(cuts, counts, strict=True)]),
        _rules(cuts, counts, total - feasible),
    )


def _inputs(cuts: Sequence[Cut], ends: np.ndarray) -> pl.DataFrame:
    ends = np.where(np.isfinite(ends), ends, np.nan)
    columns = {
        "input": [cut.name for cut in cuts],
        "low": [cut.low[0] for cut in cuts],
        "high": [cut.high[-1] for cut in cuts],
        "feasible_low": ends[:, 0],
        "feasible_high": ends[:, 1],
    }
    return pl.DataFrame(columns, nan_to_null=True)


def _interval_rows(cut: Cut, counts: np.ndarray) -> pl.DataFrame:
    columns = {"low": cut.low, "high": cut.high, "rows": counts[0], "feasible": counts[1]}
    share = pl.when(pl.col("rows") > 0).then(pl.col("feasible") / pl.col("rows"))
    table = pl.DataFrame(columns).with_columns(share.alias("share"))
    return table.select(pl.lit(cut.name).alias("input"), pl.all())


def _rules(cuts: Sequence[Cut], counts: Sequence[np.ndarray], infeasible: int) -> pl.DataFrame:
    found: list[tuple[str, int]] = []
    for cut, (rows, feasible) in zip(cuts, counts, strict=True):
        with_some = np.flatnonzero(feasible)
        if len(with_some) == 0:
            continue
        first, last = with_some[0], with_some[-1]
        found.append((f"{cut.name} < {cut.low[first]:.6g}", int(rows[:first].sum())))
        above = "> " if cut.high[last] == cut.low[last] else ">= "
        found.append((f"{cut.name} {above}{cut.high[last]:.6g}", int(rows[last + 1 :].sum())))
        for k in range(first + 1, last):
            if feasible[k] == 0:
                ends = sorted({f"{cut.low[k]:.6g}", f"{cut.high[k]:.6g}"}, key=float)
                where = f"= {ends[0]}" if len(ends) == 1 else f"from {ends[0]} to {ends[1]}"
                found.append((f"{cut.name} {where}", int(rows[k])))
    kept = [(rule, count, count / max(infeasible, 1)) for rule, count in found if count]
    schema = {"rule": pl.String, "rows": pl.Int64, "share_of_infeasible": pl.Float64}
    table = pl.DataFrame(kept, schema=schema, orient="row")
    return table.sort("rows", descending=True, maintain_order=True)
