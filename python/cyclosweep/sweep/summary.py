"""Summary of a sweep: counts by status, ranges of the results, the best variants."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import polars as pl

from cyclosweep.design.json_files import JsonSource, json_object, name_of
from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError
from cyclosweep.notebook import html_table
from cyclosweep.sweep.derived import constants
from cyclosweep.sweep.expressions import names_in, number
from cyclosweep.sweep.leaders import VALUE, Leaders, leaders, merge_leaders

if TYPE_CHECKING:
    import numpy.typing as npt
    from rich.console import RenderableType

    from cyclosweep.sweep.objective import Objective
    from cyclosweep.sweep.study import Study

__all__ = [
    "PartSummary",
    "Summary",
    "leaders_of_part",
    "merge",
    "summarise",
    "summary_of_part",
]


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
    leaders : list of Leaders
        Its best variants by each of the study's objectives.
    """

    start: int
    stop: int
    status: dict[str, int]
    ranges: dict[str, tuple[float, float]]
    leaders: list[Leaders] = field(default_factory=list)

    @property
    def best(self) -> list[dict[str, Any]]:
        """The best variants by the first objective, best first."""
        return self.leaders[0].best if self.leaders else []

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values."""
        return {
            "start": self.start,
            "stop": self.stop,
            "status": self.status,
            "ranges": self.ranges,
            "leaders": [each.to_json() for each in self.leaders],
        }

    @classmethod
    def from_json(cls, value: dict[str, Any]) -> PartSummary:
        """Read what :meth:`to_json` returned."""
        ranges = {name: (low, high) for name, (low, high) in value["ranges"].items()}
        leaders = [Leaders.from_json(each) for each in value.get("leaders", [])]
        return cls(value["start"], value["stop"], value["status"], ranges, leaders)


def summary_of_part(
    rows: pl.DataFrame,
    start: int,
    stop: int,
    study: Study,
    results: Mapping[str, npt.NDArray[Any]] | None = None,
) -> PartSummary:
    """Summarise the rows of one part.

    Parameters
    ----------
    rows : polars.DataFrame
        All columns of the study.
    start, stop : int
        First variant of the part, and the one after its last.
    study : Study
        What they belong to; its objective decides which are best.
    results : mapping of str to ndarray, optional
        Some columns of the rows as real numbers, NaN where there is none: their ranges take less
        time.

    Returns
    -------
    PartSummary
    """
    counts = rows["status"].value_counts().sort("status")
    status = dict(zip(counts["status"].to_list(), counts["count"].to_list(), strict=True))
    names = [name for name in study.ranged() if name in rows.columns]
    given = results or {}
    ranges = {}
    for name in names:
        values = given.get(name)
        low: Any
        high: Any
        if values is not None:
            low, high = np.fmin.reduce(values), np.fmax.reduce(values)
        else:
            low, high = rows[name].min(), rows[name].max()
        if low is not None and not math.isnan(low):
            ranges[name] = (float(low), float(high))
    return PartSummary(start, stop, status, ranges, leaders_of_part(rows, study))


def leaders_of_part(rows: pl.DataFrame, study: Study) -> list[Leaders]:
    """Best variants of one part by each of a study's objectives.

    Parameters
    ----------
    rows : polars.DataFrame
        The columns that objectives read, and the inputs that vary.
    study : Study
        What they belong to.

    Returns
    -------
    list of Leaders

    Raises
    ------
    InputError
        When the rows lack a column that an objective reads.
    """
    found = []
    drive, varying = study.space.drive, [n for n in rows.columns if n in study.space.varying]
    built = rows.filter(pl.col("status") == "ok") if study.objectives else rows
    for objective in study.objectives:
        name = objective.column
        fixed = [n for n in names_in(name) if n in drive.every_input() and n not in rows.columns]
        table = built.with_columns(constants(drive, fixed))
        value = number(name, dict(table.schema), where="objective").fill_nan(None)
        table = table.select("variant", value.alias(VALUE), *varying).drop_nulls(VALUE)
        found.append(leaders(table, name, objective.maximise))
    return found


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
        The ten best variants by the study's first objective, best first.
    objective : str or None
        "minimise column" or "maximise column".
    leaders : dict of str to Leaders
        The best variants by every objective, by its words.
    remarks : list of str
        What to know of them: an objective that nothing moves, several variants that are equal.
    units : dict of str to str
        Unit of each result.
    """

    rows: int
    status: dict[str, int]
    ranges: dict[str, tuple[float, float]]
    best: list[dict[str, Any]]
    objective: str | None
    leaders: dict[str, Leaders] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    units: dict[str, str] = field(default_factory=dict)

    def to_json(self) -> dict[str, Any]:
        """Plain JSON values."""
        return {
            "rows": self.rows,
            "status": self.status,
            "ranges": {name: list(pair) for name, pair in self.ranges.items()},
            "objective": self.objective,
            "best": self.best,
            "objectives": {words: each.to_json() for words, each in self.leaders.items()},
            "remarks": self.remarks,
            "units": self.units,
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
            found = value.get("objectives", {}).items()
            leaders = {words: Leaders.from_json(each) for words, each in found}
            status, best = dict(value["status"]), list(value["best"])
            remarks, units = list(value.get("remarks", [])), dict(value.get("units", {}))
            return cls(rows, status, ranges, best, objective, leaders, remarks, units)
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
            ranges.add_row(name, f"{low:.5g}", f"{high:.5g}", self.units.get(name, ""))
        for table in (status, ranges):
            table.columns[0].overflow = "fold"
            for column in table.columns[1:3]:
                column.justify = "right"
        yield status
        yield ranges
        for words, leading in self.leaders.items():
            if not leading.best:
                continue
            target = words.partition(" ")[2]
            best = Table(box=box.SIMPLE_HEAD, title=f"Best, {words}")
            best.add_column("variant", justify="right")
            best.add_column(self.units.get(target, "value"), justify="right")
            best.add_column("where")
            for row in leading.best:
                axes = (f"{k} {_short(v)}" for k, v in row.items() if k not in ("variant", target))
                best.add_row(f"{row['variant']}", _short(row[target]), ", ".join(axes))
            yield best
        yield from (f"Note: {remark}" for remark in self.remarks)


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
    units = {name: about["unit"] for name, about in study.units().items()}
    return merge(summaries, study.ranged(), study.objectives, units)


def merge(
    summaries: Iterable[PartSummary],
    columns: Sequence[str],
    objectives: Sequence[Objective],
    units: Mapping[str, str],
) -> Summary:
    """Put the summaries of parts together without the study that they belong to.

    Parameters
    ----------
    summaries : iterable of PartSummary
        One for each part.
    columns : sequence of str
        Results in the order in which their ranges are listed.
    objectives : sequence of Objective
        What the best variants are best in; a part summarised for others gives none.
    units : mapping of str to str
        Unit of each result.

    Returns
    -------
    Summary
    """
    parts = list(summaries)
    rows = 0
    status: dict[str, int] = {}
    ranges: dict[str, tuple[float, float]] = {}
    for summary in parts:
        rows += summary.stop - summary.start
        for name, count in summary.status.items():
            status[name] = status.get(name, 0) + count
        for name, (low, high) in summary.ranges.items():
            seen = ranges.get(name, (low, high))
            ranges[name] = (min(low, seen[0]), max(high, seen[1]))
    order = {name: k for k, name in enumerate(columns)}
    ranges = dict(sorted(ranges.items(), key=lambda item: order.get(item[0], len(order))))
    status = dict(sorted(status.items(), key=lambda item: -item[1]))
    merged = {}
    for objective in objectives:
        column = objective.column
        of_parts = [each for part in parts for each in part.leaders if each.column == column]
        merged[str(objective)] = merge_leaders(of_parts, objective.maximise)
    remarks = [remark for words, each in merged.items() for remark in each.remarks(words)]
    first = next(iter(merged), None)
    best = merged[first].best if first is not None else []
    return Summary(rows, status, ranges, best, first, merged, remarks, dict(units))
