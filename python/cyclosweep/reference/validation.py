"""The validation printed on a terminal and written as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.reference import criteria, paper_87
from cyclosweep.reference.facts import COUNTED
from cyclosweep.reference.rows import broken_rows, broken_table, tally, validate

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.table import Table

__all__ = ["report_json", "report_tables", "summary", "untouched", "validate"]

NARROW = 90
"""Columns of a terminal below which words of the tables would be cut."""


def report_json(drive: Drive | None = None, *, broken_models: bool = False) -> dict[str, Any]:
    """Return the validation as plain JSON values, sector lists and pulsation included.

    Parameters
    ----------
    drive : Drive, optional
        The built-in 87:1 drive by default.
    broken_models : bool
        Whether to add what deliberate errors break.
    """
    table = validate(drive)
    mean, sectors = paper_87.ideal_sectors()
    drive = drive or Drive.reference_87()
    counts = tally(table)
    report: dict[str, Any] = {
        "schema": "cyclosweep.validation/1",
        "drive": drive.name,
        "ok": not any(counts[kind]["fail"] for kind in COUNTED),
        "counts": counts,
        "counted": list(COUNTED),
        "facts": table.to_dicts(),
        "sectors": {
            "published": list(paper_87.PRINTED_SECTORS),
            "ours": list(paper_87.IDEAL_SECTORS),
            "reconstruction_ideal": sectors,
            "reconstruction_ideal_mean": mean,
            "this_drive": drive.active_pins("published-map").sectors.to_dicts(),
        },
        "pulsation": criteria.pulsation(drive).to_dicts(),
    }
    if broken_models:
        rows = broken_rows()
        report["broken_models"] = broken_table(rows).to_dicts()
        report["broken_by_none"] = untouched(rows)
        report["ok"] = report["ok"] and all(
            sum(found[kind] for kind in COUNTED) > 0 for found in report["broken_models"]
        )
    return report


def untouched(rows: pl.DataFrame) -> list[str]:
    """Counted rows that fail by no deliberate error, by name."""
    hit = pl.any_horizontal(pl.exclude("kind", "group", "fact"))
    return rows.filter(~hit)["fact"].to_list()


def summary(counts: dict[str, dict[str, int]], drive: Drive | None = None) -> str:
    """Say in a few lines what counts and what does not.

    Parameters
    ----------
    counts : dict
        As :func:`cyclosweep.reference.rows.tally` returns them.
    drive : Drive, optional
        The drive they are of; the built-in one by default.
    """
    identity = counts["identity"]
    lines = [
        _outcomes("evidence, numbers of named publications", counts["evidence"]),
        _outcomes("independent solutions, in no named publication", counts["independent solution"]),
        f"Counted, identities of the code: {identity['agree']} hold, {identity['fail']} do not.",
        "Not counted: "
        + ", ".join(
            f"{sum(found.values())} {kind}" for kind, found in counts.items() if kind not in COUNTED
        )
        + ".",
    ]
    others = sum(found["fail"] for kind, found in counts.items() if kind not in COUNTED)
    if others:
        lines.append(f"{others} rows that do not count differ from the print: another drive.")
    if drive is not None and not paper_87.is_reference_case(drive):
        lines.append(f"What the paper prints of its own 87:1 drive was not asked of {drive.name}.")
    return "\n".join(lines)


def _outcomes(what: str, found: dict[str, int]) -> str:
    return (
        f"Counted, {what}: {found['agree']} agree, {found['explained']} disagree and are "
        f"explained, {found['fail']} disagree unexplained."
    )


def report_tables(
    drive: Drive | None = None, *, broken_models: bool = False
) -> Iterable[RenderableType]:
    """Tables for a terminal.

    Parameters
    ----------
    drive : Drive, optional
        The built-in 87:1 drive by default.
    broken_models : bool
        Whether to add what deliberate errors break.
    """
    table = validate(drive)
    for (group,), rows in table.group_by("group", maintain_order=True):
        yield _Group(str(group), rows)
    pulsation = criteria.pulsation(drive or Drive.reference_87())
    names = [name.replace("_", " ") for name in pulsation.columns]
    title = "McIver's claim: (greatest - least) / mean over one turn"
    shown = _table(title, names[0], tuple(names[1:]))
    for cells in pulsation.iter_rows():
        shown.add_row(*(f"{v:.3f}" if isinstance(v, float) else f"{v}" for v in cells))
    yield shown
    if broken_models:
        yield from _broken_tables()


@dataclass(frozen=True)
class _Group:
    """Rows of one group: a table, or in a narrow terminal one paragraph a row."""

    title: str
    rows: pl.DataFrame

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        if options.max_width < NARROW:
            yield f"[italic]{self.title}[/]"
            for row in self.rows.iter_rows(named=True):
                yield _paragraph(row)
            yield ""
            return
        shown = _table(self.title, "fact", ("expected", "computed"), ("unit", "kind, basis"))
        shown.add_column("ok")
        for row in self.rows.iter_rows(named=True):
            shown.add_row(
                "\n".join([row["fact"], *_remarks(row)]),
                _number(row["published"]),
                _number(row["computed"]),
                row["unit"],
                row["kind"] + f"\n[dim]{row['mark']}[/]",
                _outcome(row["ok"], row["counted"], row["explanation"]),
            )
        yield shown


def _paragraph(row: dict[str, Any]) -> RenderableType:
    """One row of the validation as lines that wrap between words."""
    from rich.padding import Padding

    outcome = _outcome(row["ok"], row["counted"], row["explanation"])
    numbers = f"expected {_number(row['published'])}, computed {_number(row['computed'])}"
    unit = "" if row["unit"] == "1" else f" {row['unit']}"
    lines = [
        f"{row['fact']}: {outcome}",
        f"  {numbers}{unit}",
        f"  [dim]{row['kind']}, {row['mark']}[/]",
    ]
    text = "\n".join([*lines, *(f"  {remark}" for remark in _remarks(row))])
    return Padding(text, (0, 0, 1, 0))


def _remarks(row: dict[str, Any]) -> list[str]:
    return [f"[dim]{row[name]}[/]" for name in ("note", "source", "explanation") if row[name]]


def _broken_tables() -> Iterable[RenderableType]:
    rows = broken_rows()
    title = f"deliberate errors, and how many of the {rows.height} rows that count each breaks"
    shown = _table(title, "error", COUNTED, ("one of them",))
    for row in broken_table(rows).iter_rows(named=True):
        name = f"{row['model']}\n[dim]{row['error']}[/]"
        shown.add_row(name, *(str(row[kind]) for kind in COUNTED), row["first"])
    yield shown
    left = untouched(rows)
    yield "Broken by none of them: " + ("; ".join(left) if left else "no row") + "."


def _table(title: str, first: str, right: tuple[str, ...], left: tuple[str, ...] = ()) -> Table:
    from rich import box
    from rich.table import Table

    shown = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left")
    shown.add_column(first, ratio=3, overflow="fold")
    for name in right:
        shown.add_column(name, justify="right")
    for name in left:
        shown.add_column(name)
    return shown


def _outcome(ok: bool | None, counted: bool, explanation: str) -> str:
    if ok is None:
        return "-"
    if ok:
        return "yes" if counted else "[dim](yes)[/]"
    return "no" if explanation else "[bold red]NO[/]"


def _number(value: float | None) -> str:
    return "-" if value is None else f"{value:.6g}"
