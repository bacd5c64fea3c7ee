"""The best variants of a study by one objective, within limits, batch by batch."""

from __future__ import annotations

from dataclasses import dataclass

import polars as pl

from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError
from cyclosweep.explore.pareto import Objectives, objectives_of, rows_at
from cyclosweep.explore.tables import Conditions, Table, batches, conditions, open_table
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.objective import Objective

__all__ = ["BestVariants", "best_variants"]


@dataclass(frozen=True)
class BestVariants:
    """The best variants by one objective.

    Attributes
    ----------
    table : polars.DataFrame
        Every column of the study, and the objective where it is an expression; best first, of
        equal ones that with the lowest number.
    objective : Objective
        What they are best in.
    within : int
        How many variants lie within the limits.
    ties : int
        How many of them have the very best value.
    """

    table: pl.DataFrame
    objective: Objective
    within: int
    ties: int

    def __repr__(self) -> str:
        sense = "greatest" if self.objective.maximise else "least"
        tied = f", {self.ties:,} share the best value" if self.ties > 1 else ""
        return (
            f"<BestVariants: {self.table.height} of {self.within:,} within the limits, "
            f"{sense} {self.objective.column} first{tied}>"
        )


def best_variants(
    table: Table,
    objective: Objectives,
    limits: Conditions | None = None,
    *,
    rows: int = 10,
    progress: bool | None = None,
) -> BestVariants:
    """Find the best variants by one objective.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows with a column ``variant``, as for :func:`cyclosweep.pareto_front`.
    objective : Objective, mapping or str
        One column or expression: ``"twist_1tn_deg"`` is minimised,
        ``"max output_stiffness_nm_per_arcmin"`` maximised.
    limits : mapping, sequence of str or str, optional
        As for :func:`cyclosweep.pareto_front`.
    rows : int
        How many are wanted.
    progress : bool, optional
        Whether there is a progress bar; by default on a terminal, after two seconds.

    Returns
    -------
    BestVariants

    Raises
    ------
    InputError
        For an unknown column, several objectives, or rows without ``variant``.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9, 10])
    >>> found = best_variants(space, "max output_pin_count", "hole_web_mm > 5", rows=2)
    >>> found.table["output_pin_count"].to_list(), found.within
    ([10, 9], 4)
    """
    rows = whole_number("rows", rows, least=1, most=2**32 - 1)
    source = open_table(table)
    if "variant" not in source.schema:
        raise InputError("table: no column variant, expected the rows of a study")
    wanted = objectives_of(objective, source.schema, where="objective")
    if len(wanted) > 1:
        raise InputError(f"objective: found {len(wanted)}, expected one; a front takes several")
    [goal] = wanted
    value = number(goal.column, source.schema, where="objective")
    kept = conditions(limits, source.schema)
    columns = [
        pl.col("variant"),
        value.alias("__value"),
        pl.all_horizontal(*kept, value.is_not_nan()).fill_null(False).alias("__inside"),
    ]
    best = pl.DataFrame(schema={"variant": pl.UInt64(), "__value": pl.Float64()})
    within = ties = 0
    extreme: float | None = None
    for batch in batches(source, columns, "best variants", progress=progress):
        inner = batch.filter("__inside").select("variant", "__value")
        if inner.is_empty():
            continue
        within += inner.height
        here = inner["__value"].max() if goal.maximise else inner["__value"].min()
        assert isinstance(here, float)
        if extreme is None or (here > extreme if goal.maximise else here < extreme):
            extreme, ties = here, 0
        ties += inner.filter(pl.col("__value") == extreme).height
        best = pl.concat([best, inner]).bottom_k(
            rows, by=["__value", "variant"], reverse=[goal.maximise, False]
        )
    whole = rows_at(source.frame, "variant", best["variant"].to_numpy())
    made = {} if goal.column in source.schema else {goal.column: value}
    whole = whole.with_columns(**made).sort(
        value, "variant", descending=[goal.maximise, False], maintain_order=True
    )
    return BestVariants(whole, goal, within, ties)
