"""The report in a terminal, from 60 columns up."""

from collections.abc import Iterator

from rich.console import Console, Group, RenderableType
from rich.panel import Panel
from rich.table import Table as RichTable
from rich.text import Text

from cyclosweep.report import tables
from cyclosweep.report.data import ReportData
from cyclosweep.report.wording import (
    angle,
    interval,
    number,
    plain,
    probability,
    verdict_words,
)

_STYLES = {
    "IDENTIFIED": "green",
    "NOTHING_MISSING": "green",
    "AMBIGUOUS": "yellow",
    "INSUFFICIENT_DATA": "yellow",
    "UNKNOWN_PHYSICS": "magenta",
    "DATA_FAULT": "red",
}


def print_summary(data: ReportData, console: Console | None = None) -> None:
    """Print the summary.

    Parameters
    ----------
    data : ReportData
        What to report.
    console : Console, optional
        Where; default: standard output, as wide as the terminal.
    """
    (console or Console()).print(summary(data))


def summary(data: ReportData) -> RenderableType:
    """Verdict, place, effects, errors and next experiment as a rich renderable."""
    return Group(*_parts(data))


def _parts(data: ReportData) -> Iterator[RenderableType]:
    """Parts of the summary from top to bottom."""
    result = data.result
    code, words, _ = verdict_words(result)
    style = _STYLES.get(code, "cyan")
    statement = Text(str(result.get("statement") or ""))
    title = Text(f"{words} ({code})", style=f"bold {style}")
    yield Panel(
        statement, title=title, title_align="left", border_style=style,
        subtitle=Text(data.recording.name, style="dim", overflow="ellipsis", no_wrap=True),
        subtitle_align="right",
    )  # fmt: skip
    yield from _facts(data)
    if effects := result.get("effects"):
        yield Text("")
        yield _effects(effects)
    rest = tables.unknown(data)
    for heading, lines in (
        ("What the loop shows", tables.findings(data)),
        ("What remains without a name", [rest] if rest else []),
        ("Where simulation and recording differ", tables.regions(data)[:3]),
        ("Explanations that fit", tables.explanations(data)[:4]),
        ("Not found (95 % upper bound)", tables.bounds(data)[:6]),
        ("What this recording cannot show", tables.untestable(data)[:4]),
        ("Remarks on the recording", [fault.reason for fault in data.recording.faults][:4]),
    ):
        if lines:
            yield _bullets(heading, lines)
    if plan := tables.next_experiment(data):
        yield Text.assemble(("\nNext experiment\n", "bold"), plan)


def _facts(data: ReportData) -> Iterator[RenderableType]:
    """Errors before and after beside the noise."""
    grid = RichTable.grid(padding=(0, 2))
    grid.add_column(style="dim")
    grid.add_column(justify="right")
    rows = [(label, value) for value, label, _ in tables.headline(data)]
    mismatch = data.result.get("mismatch") or {}
    if mismatch.get("p_value") is not None:
        rows.append(("mismatch before, p", probability(mismatch["p_value"])))
    sufficiency = data.result.get("sufficiency") or {}
    if sufficiency.get("p_value") is not None:
        rows.append(("mismatch after, p", probability(sufficiency["p_value"])))
    for label, value in rows:
        grid.add_row(label, value)
    if rows:
        yield grid


def _effects(effects: list[dict[str, object]]) -> RenderableType:
    """Table of the accepted effects, narrow enough for 60 columns."""
    table = RichTable(box=None, padding=(0, 2, 0, 0), header_style="bold")
    table.add_column("effect", overflow="fold", ratio=1)
    table.add_column("size", justify="right")
    table.add_column("95 % (deg)", justify="right", no_wrap=True)
    table.add_column("p", justify="right", no_wrap=True)
    table.add_column("e", justify="right", no_wrap=True)
    for effect in effects:
        size = effect.get("size_deg")
        size = size if isinstance(size, dict) else {}
        table.add_row(
            Text(plain(str(effect.get("name")))),
            angle(size.get("estimate"), 2),
            interval(size.get("ci95"), 2),
            probability(effect.get("p_value")),
            number(effect.get("e_value"), 2),
        )
    return table


def _bullets(heading: str, lines: list[str]) -> RenderableType:
    """Heading and bullets with a hanging indent."""
    grid = RichTable.grid(padding=(0, 1))
    grid.add_column(width=1)
    grid.add_column(ratio=1, overflow="fold")
    for line in lines:
        grid.add_row("•", Text(line[:1].upper() + line[1:]))
    return Group(Text(f"\n{heading}", style="bold"), grid)
