"""The report in a terminal, from 40 columns up."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from rich.console import Console, ConsoleOptions, Group, RenderableType
from rich.padding import Padding
from rich.panel import Panel
from rich.table import Table as RichTable
from rich.text import Text

from cyclosweep.report import sentences
from cyclosweep.report.data import ReportData
from cyclosweep.report.summary import RECORD_NEXT, do_now, summary_of
from cyclosweep.report.tables import play_table
from cyclosweep.report.wording import (
    angle,
    interval,
    number,
    probability,
    verdict_words,
)
from cyclosweep.result import FoundEffect
from cyclosweep.result.words import readable, telling_digits

NARROW = 60
"""Columns below which tables are written as lines, each with its own words."""
MOST_NOTES = 4
"""Notes on how a recording was read that are shown; all are in diagnosis.json."""
FRAME = 6
"""Columns that the frame takes of a line with a title."""


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
    code, words, tone = verdict_words(result)
    statement = Text(summary_of(result))
    now = do_now(result)
    if now:
        statement.append(f"\n\n{now}")
    yield _Framed(f"{words} ({code})", statement, data.recording.name, tone.terminal)
    facts = _facts(data)
    if facts:
        yield _Facts(facts)
    if result.effects:
        yield Text("")
        yield _Effects(result.effects)
    rest = sentences.unknown(data)
    for heading, lines in (
        ("What to look at on the drive", sentences.look_at(data)),
        ("What the loop shows", sentences.findings(data)),
        ("What remains without a name", [rest] if rest else []),
        ("Where simulation and recording differ", sentences.regions(data)[:3]),
        (sentences.explanations_heading(data), _first(sentences.explanations(data), 4)),
        ("Possible at most (95 % upper bound)", _first(sentences.possible(data))),
        ("Not found (95 % upper bound)", _first(sentences.bounds(data))),
        ("What this recording cannot show", _first(sentences.untestable(data))),
        ("Remarks on the recording", _remarks(data)),
        ("How it was read", _notes(data)),
    ):
        if lines:
            yield _bullets(heading, lines)
    plan = sentences.next_experiment(data)
    if plan and plan.casefold() != now.removeprefix(RECORD_NEXT).lstrip().casefold():
        yield Text.assemble(("\nNext experiment\n", "bold"), plan)
    said = result.statement.removeprefix(f"{data.recording.name}: ")
    if said.casefold() != summary_of(result).casefold():
        yield Text.assemble(("\nThe answer in full\n", "bold"), result.statement)


def _first(lines: list[str], most: int = 6) -> list[str]:
    """First lines of a list, and the names with which the others begin."""
    if len(lines) <= most + 1:
        return lines
    names = ", ".join(line.partition(":")[0] for line in lines[most:])
    return [*lines[:most], f"and {len(lines) - most} more: {names}"]


def _remarks(data: ReportData) -> list[str]:
    """What the diagnosis asks, and first remarks without the verdict's own statement."""
    reasons = [fault.reason for fault in data.recording.faults]
    return [*sentences.asked(data), *_unsaid(data, reasons)][:4]


def _notes(data: ReportData) -> list[str]:
    """First notes on how the recording was read, without what is said elsewhere."""
    said = {*sentences.asked(data), *(fault.reason for fault in data.recording.faults)}
    notes = [note for note in data.result.notes if note not in said]
    return _unsaid(data, notes)[:MOST_NOTES]


def _unsaid(data: ReportData, lines: Sequence[str]) -> list[str]:
    """Lines that the statement of the verdict does not hold already."""
    statement = data.result.statement.casefold()
    return [line for line in lines if line.rstrip(".").casefold() not in statement]


def _facts(data: ReportData) -> list[tuple[str, str]]:
    """Errors before and after beside the noise, then play, stiffness and friction."""
    rows = [(label, value) for value, label, _ in sentences.headline(data)]
    if data.result.mismatch.p_value is not None:
        rows.append(("mismatch before, p", probability(data.result.mismatch.p_value)))
    if data.result.sufficiency.p_value is not None:
        left = "after" if data.result.unknown is None else "beside what has no name"
        rows.append((f"mismatch {left}, p", probability(data.result.sufficiency.p_value)))
    if (play := play_table(data)) is not None:
        rows += [(label, f"{value}  {ends}") for label, value, ends in play.rows]
    return rows


@dataclass(frozen=True)
class _Framed:
    """Verdict and statement in a frame; the verdict stands inside where it is wider than that."""

    title: str
    statement: Text
    name: str
    style: str

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        title, bold = self.title, f"bold {self.style}"
        fits = len(title) + FRAME <= options.max_width
        yield Panel(
            self.statement if fits else Text.assemble((title, bold), "\n\n", self.statement),
            title=Text(title, style=bold) if fits else None,
            title_align="left",
            border_style=self.style,
            subtitle=Text(self.name, style="dim", overflow="ellipsis", no_wrap=True),
            subtitle_align="right",
        )


@dataclass(frozen=True)
class _Facts:
    """Figures beside their labels, or in a narrow terminal below them."""

    rows: list[tuple[str, str]]

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        if options.max_width < NARROW:
            for label, value in self.rows:
                yield Text(label, style="dim")
                yield Padding(Text(value), (0, 0, 0, 2))
            return
        grid = RichTable.grid(padding=(0, 2))
        grid.add_column(style="dim")
        grid.add_column(justify="right")
        for label, value in self.rows:
            grid.add_row(label, value)
        yield grid


@dataclass(frozen=True)
class _Effects:
    """The accepted effects as a table, or in a narrow terminal as a few lines each."""

    effects: Sequence[FoundEffect]

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        table = RichTable(box=None, padding=(0, 2, 0, 0), header_style="bold")
        table.add_column("effect", overflow="fold", ratio=1)
        table.add_column("size", justify="right")
        table.add_column("95 % (deg)", justify="right", no_wrap=True)
        table.add_column("p", justify="right", no_wrap=True)
        table.add_column("e", justify="right", no_wrap=True)
        for effect in self.effects:
            digits = telling_digits(effect.size_deg.estimate, effect.size_deg.ci95, 2)
            size = angle(effect.size_deg.estimate, digits)
            ends = interval(effect.size_deg.ci95, digits)
            p, e = probability(effect.p_value), number(effect.e_value, 2)
            if options.max_width < NARROW:
                yield Text(readable(effect.name), style="bold")
                yield Padding(Text(f"{size}\n95 %: {ends} deg\np {p}, e {e}"), (0, 0, 0, 2))
            else:
                table.add_row(Text(readable(effect.name)), size, ends, p, e)
        if table.row_count:
            yield table


def _bullets(heading: str, lines: list[str]) -> RenderableType:
    """Heading and bullets with a hanging indent."""
    grid = RichTable.grid(padding=(0, 1))
    grid.add_column(width=1)
    grid.add_column(ratio=1, overflow="fold")
    for line in lines:
        grid.add_row("•", Text(line[:1].upper() + line[1:]))
    return Group(Text(f"\n{heading}", style="bold"), grid)
