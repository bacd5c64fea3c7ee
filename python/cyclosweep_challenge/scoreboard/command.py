"""`python -m cyclosweep_challenge.scoreboard`: diagnose, and show which answers are right."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from cyclosweep.atomic import write_text
from cyclosweep.errors import InputError
from cyclosweep_challenge.scoreboard.lines import (
    SHARED,
    all_lines,
    all_summaries,
    chosen,
    shared_recordings,
)
from cyclosweep_challenge.scoreboard.page import markdown, page, terminal
from cyclosweep_challenge.scoreboard.printed_drive import all_forecasts, exchanged_lines
from cyclosweep_challenge.scoreboard.run import Board, run


def _parser() -> argparse.ArgumentParser:
    """Parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m cyclosweep_challenge.scoreboard",
        description="Diagnose recordings whose right answer is known; the same command goes on.",
    )
    add = parser.add_argument
    add("--out", type=Path, default=Path("build/scoreboard"), metavar="DIR", help="folder")
    add("--only", nargs="+", default=[], metavar="LINE", help="names of lines, * and ? allowed")
    add("--shared", type=Path, metavar="DIR", help=f"shared folder (default ${SHARED})")
    add("--quick", action="store_true", help="without held-out proof and self-check")
    add("--fresh", action="store_true", help="diagnose again what is there")
    add("--list", action="store_true", help="show the lines and do nothing else")
    what = parser.add_mutually_exclusive_group()
    what.add_argument(
        "--page", type=Path, metavar="FILE", help="write the page of the documentation there"
    )
    what.add_argument(
        "--exchanged", action="store_true",
        help="instead of all that, the printed drive with fitted and forecast ramp exchanged",
    )  # fmt: skip
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; bad input is one line and status 2."""
    given = _parser().parse_args(arguments)
    try:
        _run(given)
    except InputError as error:
        print(f"scoreboard: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("scoreboard: interrupted; the same command goes on", file=sys.stderr)
        sys.exit(1)


def _run(given: argparse.Namespace) -> None:
    """Run what the command line asks for."""
    recordings = given.shared / "recordings" if given.shared else shared_recordings()
    lines = exchanged_lines() if given.exchanged else all_lines(recordings)
    wanted = chosen(lines, given.only)
    if given.list:
        for line in wanted:
            print(f"{line.name}: {line.asks} -> {line.answer}")
        return
    # What is piped or stored is not cut to the 80 columns of no terminal.
    width = None if sys.stdout.isatty() else 250
    console, progress = Console(width=width), Console(stderr=True, soft_wrap=True)
    stem = "exchanged-" if given.exchanged else ""
    file = given.out / (stem + ("quick.json" if given.quick else "scoreboard.json"))
    board = Board.open(file)
    if given.fresh:
        for line in wanted:
            board.outcomes.pop(line.name, None)
    run(
        board,
        wanted,
        recordings,
        lambda text: progress.print(text, markup=False, highlight=False),
        full=not given.quick,
    )
    summaries = [all_forecasts(lines)] if given.exchanged else all_summaries()
    for table in terminal(wanted, [] if given.only else summaries, board):
        console.print(table)
    given.out.mkdir(parents=True, exist_ok=True)
    write_text(file.with_suffix(".md"), markdown(lines, summaries, board))
    if given.page:
        write_text(given.page, page(lines, summaries, board))
