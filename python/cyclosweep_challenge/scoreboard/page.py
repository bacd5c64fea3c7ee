"""The scoreboard as tables: in the terminal, in Markdown, and as the page of the documentation."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence

from rich.table import Table

from cyclosweep_challenge.record.markdown import table
from cyclosweep_challenge.scoreboard.line import Line, Summary
from cyclosweep_challenge.scoreboard.run import Board

HEADS = (
    "line",
    "right",
    "verdict",
    "effects",
    "explained",
    "compliance",
    "rms before / after [deg]",
    "processor [s]",
    "what is wrong",
)
HOW = """\
One command diagnoses every recording of this page and says which answers are right:

```make
make scoreboard
```

or, in parts and with files of one's own choice,

    python -m cyclosweep_challenge.scoreboard --out build/scoreboard --only 'wall-*' 'coulomb-*'

It writes `scoreboard.json` and `scoreboard.md` into the folder, and shows the tables. It goes on
where it stopped: a line that was diagnosed with the code as it is is not diagnosed again, and
checks that have changed since are applied to what is kept. `CYCLOSWEEP_SHARED` names the folder
that holds `recordings/` (default: `shared` beside the project); measured recordings are read there
and never copied, and their lines are left out where they are absent. `--page docs/scoreboard.md`
writes this page from what is kept. `--exchanged` asks of the printed drive the same with the ramps
in each other's place: the one that is kept back here is fitted, and the other one forecast.
"""
EVERY = """\
Every answer, whatever the recording, must also agree with itself: no stiffness at or below zero;
NOTHING_MISSING and IDENTIFIED only where the error is at most twice the noise that is stated; a
repaired model that forecasts readings not fitted no worse than the calibrated one.
"""


def marks(lines: Sequence[Line], board: Board) -> tuple[int, int]:
    """Lines that are right and lines that are judged, among those that were diagnosed."""
    judged = [line for line in lines if line.checks and line.name in board.outcomes]
    return sum(not line.failed(board.outcomes[line.name]) for line in judged), len(judged)


def rows(lines: Iterable[Line], board: Board) -> list[tuple[str, ...]]:
    """One row a line: verdict, effects, share, compliance, errors, time, what is wrong."""
    found = []
    for line in lines:
        outcome = board.outcomes.get(line.name)
        if outcome is None:
            found.append((line.name, "–", *([""] * 6), "not diagnosed"))
            continue
        wrong = line.failed(outcome)
        right = ("no" if wrong else "yes") if line.checks else "–"
        notes = "; ".join(wrong)
        if "over_floor" in outcome.figures:
            notes = f"{notes}; " if notes else ""
            notes += (
                f"(forecast {_number(outcome.figures['forecast_deg'])} deg, "
                f"{outcome.figures['over_floor']:.2f} of the floor; remainder repeats "
                f"{outcome.figures.get('repeats', float('nan')):.2f})"
            )
        found.append(
            (
                line.name,
                right,
                outcome.verdict,
                ", ".join(name.replace("_", " ") for name in outcome.named) or "–",
                "–" if outcome.share is None else f"{100 * outcome.share:.0f} %",
                _number(outcome.scale_repaired or outcome.scale_calibrated),
                f"{_number(outcome.rms_calibrated_deg)} / {_number(outcome.rms_repaired_deg)}",
                f"{outcome.seconds:.1f}",
                notes,
            )
        )
    return found


def summary_rows(summaries: Iterable[Summary], board: Board) -> list[tuple[str, ...]]:
    """One row a check over several lines that were all diagnosed."""
    found: list[tuple[str, ...]] = []
    for each in summaries:
        outcomes = {name: board.outcomes[name] for name in each.of if name in board.outcomes}
        if len(outcomes) < len(each.of):
            found.append((each.name, "–", each.asks, "not all diagnosed"))
            continue
        right, words = each.judged(outcomes)
        found.append((each.name, "yes" if right else "no", each.asks, words))
    return found


def _number(value: float | None) -> str:
    """Number to three digits, or a dash."""
    return "–" if value is None else f"{value:.3g}"


def terminal(lines: Sequence[Line], summaries: Sequence[Summary], board: Board) -> list[Table]:
    """Tables for the terminal."""
    tables = []
    for group, members in itertools.groupby(lines, key=lambda line: line.group):
        some = list(members)
        right, judged = marks(some, board)
        title = f"{group}: {right} of {judged} right" if judged else group
        shown = Table(*HEADS, title=title)
        for row in rows(some, board):
            shown.add_row(*row, style={"yes": "green", "no": "red"}.get(row[1]))
        tables.append(shown)
    over = Table("check over several lines", "right", "asks", "found")
    for row in summary_rows(summaries, board):
        over.add_row(*row, style={"yes": "green", "no": "red"}.get(row[1]))
    return [*tables, over]


def markdown(lines: Sequence[Line], summaries: Sequence[Summary], board: Board) -> str:
    """Result tables with date and class of machine."""
    right, judged = marks(lines, board)
    parts = [
        f"{right} of {judged} lines right; diagnosed on {board.date or '–'}, one process, "
        f"{board.machine['cores']} cores of {board.machine['processor']}, "
        f"{board.machine['memory_gb']} GB; code "
        f"`{board.code[:12]}`."
    ]
    for group, members in itertools.groupby(lines, key=lambda line: line.group):
        some = list(members)
        right, judged = marks(some, board)
        count = f": {right} of {judged} right" if judged else ""
        parts.append(f"### {group}{count}\n\n{table(HEADS, rows(some, board))}")
    heads = ("check", "right", "asks", "found")
    parts.append(f"### Checks over several lines\n\n{table(heads, summary_rows(summaries, board))}")
    return "\n\n".join(parts) + "\n"


def page(lines: Sequence[Line], summaries: Sequence[Summary], board: Board) -> str:
    """Page of the documentation: what each line asks, the right answer, how to run, results."""
    asked = [
        f"### {group}\n\n"
        + table(
            ("line", "recording", "right answer", "source"),
            ((line.name, line.asks, line.answer, line.source) for line in members),
        )
        for group, members in itertools.groupby(lines, key=lambda line: line.group)
    ]
    return "\n\n".join(
        (
            "# Scoreboard of real recordings",
            "Recordings of real devices, and small made ones for what failed elsewhere, each "
            "with its right answer in words and as checks that can fail. It is no proof "
            "([proof.md](proof.md) is): it shows where the diagnosis stands on what it was "
            "not made for.",
            f"## How to run it\n\n{HOW}",
            f"## What each line asks\n\n{EVERY}",
            *asked,
            f"## Results\n\n{markdown(lines, summaries, board)}",
        )
    )
