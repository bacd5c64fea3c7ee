"""Diagnose the lines of the scoreboard, one after the other; what is done is not done again."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import cyclosweep as cs
from cyclosweep.atomic import write_text
from cyclosweep_challenge.record.code import PYTHON, diagnosis_hash, source_hash
from cyclosweep_challenge.record.machine import machine
from cyclosweep_challenge.scoreboard.line import Line
from cyclosweep_challenge.scoreboard.outcome import FAILURE, Outcome

SCHEMA = "cyclosweep.scoreboard/1"
MAKERS = (
    "cyclosweep_challenge.scoreboard.made",
    "cyclosweep_challenge.scoreboard.printed_drive",
    "cyclosweep_challenge.scoreboard.outcome",
)
"""Modules that, with what they import of the challenge, decide what an outcome holds; what the
checks ask is applied anew to every outcome that is kept."""
OTHERS = ("cyclosweep",)
"""Package that the hash of the diagnosis covers."""


@dataclass
class Board:
    """Outcomes of lines with the code and the machine they were made with.

    Attributes
    ----------
    file : pathlib.Path
        Where they are kept, as JSON.
    code : str
        Hash over all that decides them.
    outcomes : dict
        Outcome of every line that was diagnosed with this code, by name.
    date : str
        Day of the last diagnosis.
    machine : dict
        Kind of machine of the last diagnosis.
    """

    file: Path
    code: str
    outcomes: dict[str, Outcome] = field(default_factory=dict)
    date: str = ""
    machine: dict[str, Any] = field(default_factory=machine)

    @classmethod
    def open(cls, file: Path, code: str | None = None) -> Board:
        """Read what is there and was made with this code; outcomes of other code are dropped.

        Parameters
        ----------
        file : pathlib.Path
            JSON file of a scoreboard, or where it will be.
        code : str, optional
            Hash of the code; default: of the code that this process runs.
        """
        board = cls(file, code or code_hash())
        content = json.loads(file.read_text()) if file.is_file() else {}
        if content.get("code") == board.code:
            board.date = str(content.get("date", ""))
            board.machine = content.get("machine", board.machine)
            for name, outcome in content.get("lines", {}).items():
                board.outcomes[name] = Outcome.from_dict(outcome)
        return board

    def write(self) -> None:
        """Write the file, whole or not at all."""
        content: dict[str, Any] = {
            "schema": SCHEMA,
            "code": self.code,
            "date": self.date,
            "machine": self.machine,
            "lines": {name: outcome.as_dict() for name, outcome in self.outcomes.items()},
        }
        self.file.parent.mkdir(parents=True, exist_ok=True)
        write_text(self.file, json.dumps(content, indent=1) + "\n")


def code_hash(python: Path = PYTHON) -> str:
    """SHA-256 over what diagnoses, and over what makes the recordings of the scoreboard."""
    return f"{diagnosis_hash(python)[:32]}{source_hash(python, MAKERS, OTHERS)[:32]}"


def run(
    board: Board,
    lines: Sequence[Line],
    recordings: Path,
    say: Callable[[str], None],
    *,
    full: bool = True,
) -> None:
    """Diagnose what is not there yet; the file is written after every line.

    Parameters
    ----------
    board : Board
        Where outcomes go.
    lines : sequence of Line
        Lines to diagnose.
    recordings : pathlib.Path
        Shared folder of recordings; lines whose file is absent there are left out.
    say : callable
        Gets a line of progress.
    full : bool
        Whether the diagnosis makes its held-out proof and self-check, as it does for a user.
    """
    for line in lines:
        if line.name in board.outcomes:
            continue
        if line.file and not (recordings / line.file).is_file():
            say(f"{line.name}: {recordings / line.file} is absent")
            continue
        board.outcomes[line.name] = outcome = diagnosed(line, recordings, full=full)
        board.machine = machine()
        board.date = datetime.now(UTC).date().isoformat()
        board.write()
        wrong = line.failed(outcome)
        words = "right" if not wrong else f"wrong: {'; '.join(wrong)}"
        say(f"{line.name}: {outcome.verdict}, {words if line.checks else 'only stated'}")


def diagnosed(line: Line, recordings: Path, *, full: bool = True) -> Outcome:
    """Diagnose the recording of a line.

    Parameters
    ----------
    line : Line
        The line.
    recordings : pathlib.Path
        Shared folder of recordings.
    full : bool
        Whether the diagnosis makes its held-out proof and self-check.

    Returns
    -------
    Outcome
        A diagnosis that ends in an error is an outcome, too: ``FAILURE`` with its words.
    """
    start = time.process_time()
    try:
        recording = line.recording(recordings)
        start = time.process_time()
        found = cs.diagnose(recording, full=full and not line.verdict_only)
        seconds = time.process_time() - start
        figures: Mapping[str, float] = line.figures(found, recordings)
    except Exception as error:
        words = f"{type(error).__name__}: {error}"
        return Outcome(FAILURE, words, seconds=round(time.process_time() - start, 2))
    return Outcome.of(found, seconds, figures)
