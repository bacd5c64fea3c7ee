"""All lines of the scoreboard, and the checks over several of them."""

from __future__ import annotations

import os
from fnmatch import fnmatchcase
from pathlib import Path

from cyclosweep.errors import InputError
from cyclosweep_challenge.scoreboard.line import Line, Summary
from cyclosweep_challenge.scoreboard.made_lines import made_lines, made_summaries
from cyclosweep_challenge.scoreboard.other_rigs import other_rig_lines
from cyclosweep_challenge.scoreboard.practice import practice_lines
from cyclosweep_challenge.scoreboard.printed_drive import (
    printed_drive_lines,
    printed_drive_summaries,
)
from cyclosweep_challenge.scoreboard.turned_lines import turned_lines

SHARED = "CYCLOSWEEP_SHARED"
"""Environment variable that names the shared folder."""


def shared_recordings() -> Path:
    """Folder of recordings that are not part of the project; it need not be there."""
    beside = Path(__file__).parents[4] / "shared"
    return Path(os.environ.get(SHARED, beside)) / "recordings"


def all_lines(recordings: Path) -> list[Line]:
    """Return every line, also those whose recording is absent.

    Parameters
    ----------
    recordings : pathlib.Path
        Shared folder of recordings.
    """
    return [
        *printed_drive_lines(),
        *other_rig_lines(),
        *made_lines(),
        *turned_lines(),
        *practice_lines(recordings),
    ]


def all_summaries() -> list[Summary]:
    """Return every check over several lines."""
    return [*printed_drive_summaries(), *made_summaries()]


def chosen(lines: list[Line], patterns: list[str]) -> list[Line]:
    """Return the lines that some names or patterns ask for; all where there are none.

    Raises
    ------
    InputError
        A pattern fits no line.
    """
    for pattern in patterns:
        if not any(fnmatchcase(line.name, pattern) for line in lines):
            known = ", ".join(line.name for line in lines)
            raise InputError(f"--only {pattern}: no such line; there are {known}")
    return [
        line
        for line in lines
        if not patterns or any(fnmatchcase(line.name, pattern) for pattern in patterns)
    ]
