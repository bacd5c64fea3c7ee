"""Summary of a sweep: counts by status, ranges of the results, the best variants."""

from __future__ import annotations

import heapq
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import polars as pl

from cyclosweep.design.json_files import JsonSource, json_object, name_of
from cyclosweep.design.numbers import whole_number
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError
from cyclosweep.notebook import html_table

if TYPE_CHECKING:
    from rich.console import RenderableType

    from cyclosweep.sweep.objective import Objective
    from cyclosweep.sweep.study import Study

__all__ = ["BEST", "PartSummary", "Summary", "merge", "summarise", "summary_of_part"]

BEST = 10


@dataclass(frozen=True)
class PartSummary:
    """Summary of one part, small enough to be sent between processes.

    Attributes
    ----------
    start, stop : int
        Its variants.
    status : dict
        Rows by status.
    ranges : dict
        Least and greatest value of each result.
    best : list of dict
        Its best variants by the study's objective, best first.
    """

    start: int
    stop: int
    status: dict[str, int]
    ranges: dict[str, tuple[float, float]]
    best: list[dict[str, Any]] = field(default_factory=list)

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values."""
        return {
            "start": self.start,
            "stop": self.stop,
            "status": self.status,
            "ranges": self.ranges,
            "best": self.best,
        }

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> PartSummary:
        """Read what :meth:`to_json` returned."""
        ranges = {name: (low, high) for name, (low, high) in value["ranges"].items()}
        return cls(value["start"], value["stop"], value["status"], ranges, value["best"])


def summary_of_part(rows: pl.DataFrame, start: int, stop: int, study: Study) -> PartSummary:
    """Summarise the rows of one part.

    Parameters
    ----------
    rows : polars.DataFrame
        All columns of the study.
    start, stop : int
        First variant of the part, and the one after its last.
    study : Study
        What they belong to; its objective decides which are best.

    Returns
    -------
    PartSummary
    """
    counts = rows["status"].value_counts().sort("status")
    status = dict(zip(counts["status"].to_list(), counts["count"].to_list(), strict=True))
    names = [name for name, kind in study.outputs.items() if kind not in ("flag", "solver")]
    lows = rows.select(pl.col(names).min()).row(0)
    highs = rows.select(pl.col(names).max()).row(0)
    ranges = {
        name: (float(low), float(high))
        for name, low, high in zip(names, lows, highs, strict=True)
        if low is not None
    }
    best: list[dict[str, Any]] = []
    if (objective := study.objective) is not None:
        is_number = pl.col(objective.column).cast(pl.Float64).is_not_nan()
        kept = rows.select(*_best_columns(study), "status").filter(
            pl.col("status") == "ok", is_number
        )
        by, reverse = [objective.column, "variant"], [objective.maximise, False]
        best = kept.bottom_k(BEST, by=by, reverse=reverse).drop("status").to_dicts()
    return PartSummary(start, stop, status, ranges, best)


def _best_columns(study: Study) -> list[str]:
    assert study.objective is not None
    axes = [axis.name for axis in study.space.axes]
    return list(dict.fromkeys(["variant", study.objective.column, *axes]))


@dataclass(frozen=True)
class Summary:
    """Summary of a whole sweep.

    Attributes
    ----------
    rows : int
        Variants there.
    status : dict
        Rows by status, most frequent first.
    ranges : dict
        Least and greatest value of each result among variants that can be built.
    best : list of dict
        The ten best variants by the study's objective, best first.
    objective : str or None
        "minimise column" or "maximise column".
    """

    rows: int
    status: dict[str, int]
    ranges: dict[str, tuple[float, float]]
    best: list[dict[str, Any]]
    objective: str | None

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values."""
        return {
            "rows": self.rows,
            "status": self.status,
            "ranges": {name: list(pair) for name, pair in self.ranges.items()},
            "objective": self.objective,
            "best": self.best,
        }

    @classmethod
    def from_json(cls, source: JsonSource) -> Summary:
        """Read what :meth:`to_json` returned, or a file or text of it.

        Parameters
        ----------
        source : str, Path or mapping
            The decoded content, its text or a file; ``cyclosweep sweep --json`` prints one.

        Returns
        -------
        Summary

        Raises
        ------
        InputError
            It is no summary.
        """
        value = json_object(source)
        try:
            ranges = {name: (low, high) for name, (low, high) in value["ranges"].items()}
            rows, objective = whole_number("rows", value["rows"]), value["objective"]
            return cls(rows, dict(value["status"]), ranges, list(value["best"]), objective)
        except (KeyError, TypeError, ValueError, AttributeError) as error:
            raise InputError(f"{name_of(source)}: not a summary of a sweep: {error}") from None

    def __repr__(self) -> str:
        best = self.best[0] if self.best else None
        found = f", {self.objective}: variant {best['variant']}" if best else ""
        return f"<Summary: {self.rows:,} variants, {self._share('ok')} ok{found}>"

    def _share(self, status: str) -> str:
        return f"{self.status.get(status, 0) / max(self.rows, 1):.1%}"

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {"variants": f"{self.rows:,}"}
        rows |= {status: f"{self._share(status)} ({n:,})" for status, n in self.status.items()}
        if self.best:
            axes = ", ".join(f"{name} {_short(value)}" for name, value in self.best[0].items())
            rows[f"{self.objective}, best"] = axes
        return html_table("Sweep", rows)

    def renderables(self) -> Iterable[RenderableType]:
        """Tables for a terminal."""
        from rich import box
        from rich.table import Table

        status = Table("status", "variants", "share", box=box.SIMPLE_HEAD, title="Status")
        for name, count in self.status.items():
            status.add_row(name, f"{count:,}", f"{count / max(self.rows, 1):.1%}")
        ranges = Table("result", "least", "greatest", "unit", box=box.SIMPLE_HEAD, title="Ranges")
        for name, (low, high) in self.ranges.items():
            ranges.add_row(name, f"{low:.5g}", f"{high:.5g}", quantity(name).unit)
        for table in (status, ranges):
            table.columns[0].overflow = "fold"
            for column in table.columns[1:3]:
                column.justify = "right"
        yield status
        yield ranges
        if self.best:
            target = (self.objective or "").split()[-1]
            best = Table(box=box.SIMPLE_HEAD, title=f"Best, {self.objective}")
            best.add_column("variant", justify="right")
            best.add_column(quantity(target).unit, justify="right")
            best.add_column("where")
            for row in self.best:
                axes = (f"{k} {_short(v)}" for k, v in row.items() if k not in ("variant", target))
                best.add_row(f"{row['variant']}", _short(row[target]), ", ".join(axes))
            yield best


def _short(value: object) -> str:
    return f"{value:.5g}" if isinstance(value, float) else f"{value}"


def summarise(summaries: Iterable[PartSummary], study: Study) -> Summary:
    """Put the summaries of a sweep's parts together.

    Parameters
    ----------
    summaries : iterable of PartSummary
        One for each part.
    study : Study
        What they belong to; its objective decides which variants are best.

    Returns
    -------
    Summary
    """
    return merge(summaries, list(study.outputs), study.objective)


def merge(
    summaries: Iterable[PartSummary], columns: Sequence[str], objective: Objective | None
) -> Summary:
    """Put the summaries of parts together without the study that they belong to.

    Parameters
    ----------
    summaries : iterable of PartSummary
        One for each part.
    columns : sequence of str
        Results in the order in which their ranges are listed.
    objective : Objective, optional
        What the best variants are best in; a part summarised for another one gives none.

    Returns
    -------
    Summary
    """
    rows = 0
    status: dict[str, int] = {}
    ranges: dict[str, tuple[float, float]] = {}
    best: list[dict[str, Any]] = []
    for summary in summaries:
        rows += summary.stop - summary.start
        for name, count in summary.status.items():
            status[name] = status.get(name, 0) + count
        for name, (low, high) in summary.ranges.items():
            seen = ranges.get(name, (low, high))
            ranges[name] = (min(low, seen[0]), max(high, seen[1]))
        if objective is not None:
            best.extend(row for row in summary.best if objective.column in row)
    order = {name: k for k, name in enumerate(columns)}
    ranges = dict(sorted(ranges.items(), key=lambda item: order[item[0]]))
    status = dict(sorted(status.items(), key=lambda item: -item[1]))
    wanted = None
    if objective is not None:
        column, sign = objective.column, -1 if objective.maximise else 1
        best = heapq.nsmallest(BEST, best, key=lambda row: (sign * row[column], row["variant"]))
        wanted = str(objective)
    return Summary(rows, status, ranges, best, wanted)
