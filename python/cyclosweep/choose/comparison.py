"""Drives side by side: numbers with units, compliance budgets, and what to be careful about."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import polars as pl

from cyclosweep.choose.budget import (
    BudgetItem,
    budget_of_components,
    budget_of_published,
    budget_table,
)
from cyclosweep.choose.remarks import Remark, remarks_on
from cyclosweep.design.drive import Drive
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError, instance_of
from cyclosweep.notebook import html_table
from cyclosweep.sweep.scan import sweep
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Study

__all__ = ["Comparison", "DriveFigures", "compare"]


@dataclass(frozen=True)
class DriveFigures:
    """Everything that is computed of one drive.

    Attributes
    ----------
    label : str
        What it is called in a comparison.
    drive : Drive
        The drive.
    results : dict
        Every result column, None where it does not apply.
    published, components : list of BudgetItem
        Compliance by parts, by the published model and by the component model at rated torque.
    remarks : list of Remark
        What to be careful about.
    """

    label: str
    drive: Drive
    results: dict[str, float | None]
    published: list[BudgetItem]
    components: list[BudgetItem]
    remarks: list[Remark]


@dataclass(frozen=True, repr=False)
class Comparison:
    """Drives side by side.

    Attributes
    ----------
    figures : tuple of DriveFigures
        One for each drive.
    """

    figures: tuple[DriveFigures, ...]

    @property
    def inputs(self) -> pl.DataFrame:
        """Inputs of the drives: ``key``, ``unit``, ``meaning``, and a column for each drive."""
        given = [{**each.drive.values(), **each.drive.part_values()} for each in self.figures]
        known = dict.fromkeys(key for row in given for key in row if key != "criterion")
        kept = [
            key for key in known if any(not math.isnan(row.get(key, math.nan)) for row in given)
        ]
        return self._table(kept, given)

    @property
    def results(self) -> pl.DataFrame:
        """Results of the drives: ``key``, ``unit``, ``meaning``, and a column for each drive."""
        rows = [each.results for each in self.figures]
        known = dict.fromkeys(key for row in rows for key in row)
        kept = [key for key in known if any(row.get(key) is not None for row in rows)]
        return self._table(kept, rows)

    @property
    def budget(self) -> pl.DataFrame:
        """Compliance by parts of every drive and model, a row an item."""
        items = [
            (each.label, model, item)
            for each in self.figures
            for model, budget in (("published", each.published), ("components", each.components))
            for item in budget
        ]
        return budget_table(items)

    def _table(self, keys: list[str], rows: Sequence[Mapping[str, float | None]]) -> pl.DataFrame:
        columns: dict[str, list[Any]] = {
            "key": keys,
            "unit": [quantity(key).unit for key in keys],
            "meaning": [quantity(key).meaning for key in keys],
        }
        schema: dict[str, pl.DataType] = dict.fromkeys(columns, pl.String())
        for each, row in zip(self.figures, rows, strict=True):
            found = [row.get(key) for key in keys]
            columns[each.label] = [None if v is None or math.isnan(v) else v for v in found]
            schema[each.label] = pl.Float64()
        return pl.DataFrame(columns, schema=schema)

    @property
    def table(self) -> pl.DataFrame:
        """Inputs and results in one table, as ``--out`` writes it."""
        return pl.concat(
            [
                self.inputs.select(pl.lit("input").alias("kind"), pl.all()),
                self.results.select(pl.lit("result").alias("kind"), pl.all()),
            ]
        )

    def to_json(self) -> str:
        """JSON of all drives: inputs, results, budgets and remarks by the drive's label."""
        return json.dumps({"schema": "cyclosweep.comparison/1", "drives": self._contents()})

    def _contents(self) -> list[dict[str, Any]]:
        def items(budget: list[BudgetItem]) -> list[dict[str, Any]]:
            return [
                {
                    "part": item.part,
                    "compliance_arcmin_per_nm": item.compliance_arcmin_per_nm,
                    "stiffness_nm_per_arcmin": item.stiffness_nm_per_arcmin,
                    "share": item.share,
                }
                for item in budget
            ]

        return [
            {
                "label": each.label,
                "drive": json.loads(each.drive.to_json()),
                "results": each.results,
                "budget": {
                    "published": items(each.published),
                    "components": items(each.components),
                },
                "remarks": [{"level": r.level, "text": r.text} for r in each.remarks],
            }
            for each in self.figures
        ]

    def __repr__(self) -> str:
        names = ", ".join(each.label for each in self.figures)
        warnings = sum(r.level != "note" for each in self.figures for r in each.remarks)
        said = f", {warnings} warnings" if warnings != 1 else ", 1 warning"
        return f"<Comparison of {names}: {self.results.height} results{said}>"

    def _repr_html_(self) -> str:
        rows: dict[str, object] = {}
        for row in self.results.iter_rows(named=True):
            values = (row[each.label] for each in self.figures)
            shown = " | ".join("–" if value is None else f"{value:.5g}" for value in values)
            rows[row["key"]] = f"{shown} {row['unit'] if row['unit'] != '1' else ''}"
        return html_table(" | ".join(each.label for each in self.figures), rows)


def compare(drives: Sequence[Drive | str | Path] | Drive | str | Path) -> Comparison:
    """Compute everything about some drives and put them side by side.

    Parameters
    ----------
    drives : Drive, str or Path, or a sequence of them
        Drives, names of built-in ones, or drive files.

    Returns
    -------
    Comparison
        A drive that cannot be built is in it, with the reason among its remarks. The component
        model's results are there for each drive that gives its numbers.

    Raises
    ------
    InputError
        For a file that is no drive, or no drive at all.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> found = cs.compare([cs.Drive.reference_87(), cs.Drive.reference_87().replace(ratio=43)])
    >>> found.inputs.height, found.budget["part"][0]
    (35, 'shaft segment 1, keyway')
    """
    instance_of("drives", drives, Drive, str, Path, Sequence)
    given = [drives] if isinstance(drives, (Drive, str, Path)) else list(drives)
    if not given:
        raise InputError("drives: none, expected at least one")
    loaded = [each if isinstance(each, Drive) else Drive.load(each) for each in given]
    labels: list[str] = []
    for drive in loaded:
        times = sum(other.name == drive.name for other in loaded[: len(labels)])
        labels.append(f"{drive.name} ({times + 1})" if times else drive.name)
    return Comparison(tuple(map(_figures, labels, loaded)))


def _figures(label: str, drive: Drive) -> DriveFigures:
    reason = drive.explain()
    parts_reason = None if reason else drive.part_study().explain(drive.study(), 0)
    has_parts = reason is None and parts_reason is None
    space = Space.grid(drive)
    study = Study.of(space, model="components", solver="full") if has_parts else Study.of(space)
    row = sweep(study).row(0, named=True)
    results = {
        name: None if row[name] is None else float(row[name])
        for name, kind in study.outputs.items()
        if kind != "solver"
    }
    results = {
        name: None if value is None or math.isnan(value) else value
        for name, value in results.items()
    }
    return DriveFigures(
        label,
        drive,
        results,
        [] if reason else budget_of_published(drive, results),
        budget_of_components(drive, results) if has_parts else [],
        remarks_on(drive, results, reason, parts_reason),
    )
