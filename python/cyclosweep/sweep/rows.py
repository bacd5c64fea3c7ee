"""Rows of a study: inputs, statuses and results of variants for which a condition holds."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import polars as pl

from cyclosweep.sweep.derived import constants, with_derived
from cyclosweep.sweep.kernel_columns import result_columns, stretch_columns

if TYPE_CHECKING:
    from cyclosweep.sweep.study import Study

__all__ = ["frame"]


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
    if study.is_extended:
        return _extended(study, start, stop, columns, predicate)
    cheap = {"variant", *(axis.name for axis in study.space.axes)}
    before, after = _split(predicate, cheap)
    needed = dict.fromkeys(columns)
    for condition in after:
        needed.update(dict.fromkeys(condition.meta.root_names()))
    results = [name for name in needed if name not in cheap]
    first = dict.fromkeys(name for name in needed if name in cheap)
    for condition in before:
        first.update(dict.fromkeys(condition.meta.root_names()))
    if not before:
        # A frame without columns has no height: the number of the variant stands in.
        whole = stretch_columns(study, [*first, *results] or ["variant"], start, stop)
    else:
        inputs = stretch_columns(study, list(dict.fromkeys(["variant", *first])), start, stop)
        inputs = inputs.filter(*before)
        if not results:
            return inputs.select(columns)
        picked = None if inputs.height == stop - start else inputs["variant"].to_numpy()
        whole = inputs.with_columns(result_columns(study, results, start, stop, picked))
    if after:
        whole = whole.filter(*after)
    return whole.select(columns)


def _extended(
    study: Study, start: int, stop: int, columns: Sequence[str], predicate: pl.Expr | None
) -> pl.DataFrame:
    """Rows of a study with derived inputs, own columns or conditions; see `frame`."""
    space, extras = study.space, study.extras
    cheap = {"variant", *(axis.name for axis in space.axes), *(d.name for d in space.derived)}
    before, after = _split(predicate, cheap)
    asked = dict.fromkeys(columns)
    for term in after:
        asked.update(dict.fromkeys(term.meta.root_names()))
    inputs = stretch_columns(study, ["variant", *(axis.name for axis in space.axes)], start, stop)
    inputs = with_derived(inputs, space.drive, space.derived).filter(*before)
    if cheap.issuperset(asked):
        return inputs.select(columns)
    needed = extras.needed([*asked, "status"])
    own = {column.name for column in extras.columns}
    computed = {*cheap, *own, *study.outputs, "status"}
    fixed = [name for name in needed if name not in computed]
    rows = inputs.with_columns(constants(space.drive, fixed))
    codes = pl.repeat(None, rows.height, dtype=pl.UInt8, eager=True)
    for label, rule in extras.early({*cheap, *fixed}):
        broken = (~rule.add_to(rows)[rule.name]).fill_null(False)
        codes = codes.set(broken & codes.is_null(), study.status_codes[label])
    met = codes.is_null()
    names = list(dict.fromkeys(["status", *(n for n in needed if n in study.outputs)]))
    results = _modelled(study, names, rows.filter(met), start, stop)
    if not met.all():
        place = rows.select(pl.when(met).then(met.cum_sum().cast(pl.Int64) - 1)).to_series()
        results = results.select(pl.all().gather(place))
    status = results["status"].to_physical().cast(pl.UInt8).zip_with(met, codes)
    rows = rows.hstack(results.drop("status"))
    for column in extras.columns:
        if column.name in needed:
            rows = column.add_to(rows)
    for label, rule in extras.conditions:
        broken = ~rule.add_to(rows)[rule.name].fill_null(False)
        status = status.set((status == 0) & broken, study.status_codes[label])
    found = [name for name in (*names, *own) if name in needed and name != "status"]
    if (status != 0).any():
        rows = rows.with_columns(pl.when(status == 0).then(pl.col(found)))
    rows = rows.with_columns(status.alias("status").cat.to(study.schema()["status"]))
    return rows.filter(*after).select(columns)


def _modelled(
    study: Study, names: list[str], inputs: pl.DataFrame, start: int, stop: int
) -> pl.DataFrame:
    """Statuses and results of the models for the variants of a frame of inputs."""
    if not study.space.derived:
        whole = inputs.height == stop - start
        picked = None if whole else inputs["variant"].to_numpy()
        return pl.DataFrame(result_columns(study, names, start, stop, picked))
    if inputs.is_empty():
        schema = study.schema()
        return pl.DataFrame(schema={name: schema[name] for name in names})
    return pl.DataFrame(result_columns(study.on_rows(inputs), names, 0, inputs.height, None))


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
