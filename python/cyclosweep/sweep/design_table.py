"""A table of designs, from a catalogue or another optimiser, evaluated row by row."""

from __future__ import annotations

import difflib
import logging
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError, instance_of
from cyclosweep.sweep.any_table import as_frame
from cyclosweep.sweep.axes import input_column
from cyclosweep.sweep.rows import frame
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Limits, Study, StudyModel

if TYPE_CHECKING:
    from cyclosweep.design.parts import Engine
    from cyclosweep.sweep.own_columns import Own

__all__ = ["evaluate_table"]

logger = logging.getLogger(__name__)

_LIKELY = 0.8
"""Likeness above which an unknown column of numbers is taken for a misspelt input."""


def evaluate_table(
    drive: Drive,
    table: Any,
    *,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    model: StudyModel | None = None,
    solver: Engine | None = None,
    constraints: Mapping[str, Own] | None = None,
    columns: Mapping[str, Own] | None = None,
    row_name: Callable[[int], str] = lambda index: f"row {index}",
) -> pl.DataFrame:
    """Evaluate a table of designs, one a row.

    Parameters
    ----------
    drive : Drive
        What the table leaves out.
    table : polars.DataFrame, pandas.DataFrame, pyarrow.Table, mapping or ndarray
        Columns named as inputs; others are labels and passed through. Statuses and results of an
        earlier evaluation are computed anew.
    loads_tn, limits, model, solver, constraints, columns : optional
        As for :func:`cyclosweep.scan`.
    row_name : callable
        What a message calls a row, counted from 0.

    Returns
    -------
    polars.DataFrame
        The table's labels and inputs, then ``status``, ``reason`` in words where a design cannot
        be built, and the results, in the table's order.

    Raises
    ------
    InputError
        For a table without an input, a cell that is no number where one is expected, or a column
        of numbers whose name is nearly that of an input.

    Examples
    --------
    >>> designs = {"label": ["a", "b"], "eccentricity_mm": [0.6, 0.9]}
    >>> found = evaluate_table(Drive.reference_87(), designs)
    >>> found["label"].to_list(), found["status"].to_list()
    (['a', 'b'], ['ok', 'eccentricity_too_large_for_ring'])
    """
    instance_of("drive", drive, Drive)
    rows = as_frame(table, "table")
    inputs = _inputs(drive, rows)
    if not inputs:
        raise InputError("table: no column is an input of a drive, expected at least one")
    designs = pl.DataFrame([input_column(rows[name], row_name) for name in inputs])
    study = Study.of(
        Space.table(drive, designs),
        loads_tn=loads_tn,
        limits=limits,
        model=model,
        solver=solver,
        constraints=constraints,
        columns=columns,
    )
    found = frame(study, 0, rows.height, list(study.schema()))
    results = found.drop("variant", "status", *inputs)
    earlier = [name for name in rows.columns if name in (*results.columns, *_OWN)]
    kept = rows.drop(earlier).with_columns(found[name] for name in inputs)
    reasons = _reasons(study, found["status"])
    return kept.with_columns(found["status"], reasons).hstack(results)


_OWN = ("variant", "status", "reason")


def _inputs(drive: Drive, rows: pl.DataFrame) -> list[str]:
    """Columns that are inputs; InputError for one that was meant to be."""
    known = drive.every_input()
    results = Study.of(Space.grid(drive), model="components").schema()
    was_evaluated = "status" in rows.columns and any(
        name in results and name not in (*known, *_OWN) for name in rows.columns
    )
    for name in () if was_evaluated else _OWN:
        if name in rows.columns:
            logger.warning("%s: replaced by the result of this name; rename it to keep it", name)
    found = []
    for name, dtype in rows.schema.items():
        if name in known and not (was_evaluated and name in results):
            found.append(name)
        elif name in known or name in results or name in _OWN or not dtype.is_numeric():
            continue
        elif close := difflib.get_close_matches(name.lower(), known, n=1, cutoff=_LIKELY):
            raise InputError(f"{name}: no such input of a drive, did you mean {close[0]}?")
        else:
            logger.warning("%s: no input of a drive, passed through as a label", name)
    return found


def _reasons(study: Study, statuses: pl.Series) -> pl.Series:
    """Why designs cannot be built, in words; null for the others."""
    found: list[str | None] = []
    for index, status in enumerate(statuses):
        reason = None
        if status != "ok":
            reason = study.core.explain(index)
            if reason is None and study.model == "components":
                reason = study.part_core.explain(study.core, index)
            reason = reason or status.replace("limit_", "outside the limit on ").replace(
                "constraint_", "does not meet the constraint "
            )
        found.append(reason)
    return pl.Series("reason", found, dtype=pl.String)
