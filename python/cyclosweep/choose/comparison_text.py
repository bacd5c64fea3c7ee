"""A comparison of drives as tables for a terminal."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import polars as pl
from rich import box
from rich.table import Table
from rich.text import Text

from cyclosweep.choose.budget import BudgetItem
from cyclosweep.choose.comparison import Comparison

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = ["renderables"]

_STYLES = {"error": "bold red", "warning": "yellow", "note": "dim"}


def renderables(found: Comparison, *, everything: bool) -> Iterable[RenderableType]:
    """Remarks, inputs, results and budgets.

    Parameters
    ----------
    found : Comparison
        What is shown.
    everything : bool
        Of several drives also the inputs in which they agree.

    Yields
    ------
    rich.console.RenderableType
    """
    labels = [each.label for each in found.figures]
    inputs = found.inputs
    title = "Inputs"
    if len(labels) > 1 and not everything:
        differs = pl.concat_list(labels).list.n_unique() > 1
        inputs = inputs.filter(differs)
        title = "Inputs that differ"
    if inputs.height:
        yield _numbers(title, inputs, labels)
    if found.results.height:
        yield _numbers("Results", found.results, labels)
    yield from _budgets(found)
    yield from _remarks(found)


def _table(title: str, *columns: str) -> Table:
    table = Table(*columns, box=box.SIMPLE_HEAD, title=title, title_justify="left")
    table.columns[0].overflow = "fold"
    return table


def _numbers(title: str, frame: pl.DataFrame, labels: list[str]) -> Table:
    table = _table(title, "")
    for label in labels:
        table.add_column(Text(label), justify="right", overflow="fold")
    table.add_column("unit", no_wrap=True)
    for row in frame.iter_rows(named=True):
        values = ("–" if row[label] is None else f"{row[label]:.6g}" for label in labels)
        table.add_row(row["key"], *values, row["unit"] if row["unit"] != "1" else "")
    return table


def _budgets(found: Comparison) -> Iterator[Table]:
    for title, budgets in (
        ("Compliance by parts, published model", [each.published for each in found.figures]),
        (
            "Compliance by parts, component model at rated torque",
            [each.components for each in found.figures],
        ),
    ):
        parts = dict.fromkeys(item.part for budget in budgets for item in budget)
        if not parts:
            continue
        table = _table(title, "")
        for each in found.figures:
            table.add_column(Text(f"{each.label}\nN m/arcmin"), justify="right", overflow="fold")
            table.add_column("share", justify="right")
        for part in parts:
            cells = []
            for budget in budgets:
                item = next((item for item in budget if item.part == part), None)
                cells += ["–", "–"] if item is None else [_stiffness(item), f"{item.share:.1%}"]
            table.add_row(part, *cells)
        totals = []
        for budget in budgets:
            whole = sum(item.compliance_arcmin_per_nm for item in budget)
            totals += [f"{1 / whole:.4g}", "100 %"] if whole else ["–", "–"]
        table.add_row("all together", *totals, style="bold")
        yield table


def _stiffness(item: BudgetItem) -> str:
    found = item.stiffness_nm_per_arcmin
    return "rigid" if found is None else f"{found:.4g}"


def _remarks(found: Comparison) -> Iterator[RenderableType]:
    for each in found.figures:
        if not each.remarks:
            continue
        yield Text(each.label, style="bold")
        lines = Table.grid(padding=(0, 1))
        for remark in each.remarks:
            lines.add_row(Text(f"  {remark.level}:", style=_STYLES[remark.level]), remark.text)
        yield lines
