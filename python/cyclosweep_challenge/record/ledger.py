"""An append-only log in which every line holds the hash of the line before."""

from __future__ import annotations

import hashlib
import json
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from cyclosweep_challenge.trial.seal import SealError

START = "0" * 64


def digest(line: str) -> str:
    """SHA-256 of a line [hex]."""
    return hashlib.sha256(line.encode()).hexdigest()


class Ledger:
    """What happened to a record, in order: a line of JSON each.

    Parameters
    ----------
    file : pathlib.Path
        File of the log; made at the first line.
    repair : bool
        Take a last line that a kill cut short out of the file; it never counted.

    Raises
    ------
    SealError
        If a line was changed or taken out.
    """

    def __init__(self, file: Path, *, repair: bool = True) -> None:
        self.file = file
        self.head = START
        self.lines: list[dict[str, Any]] = []
        text = file.read_text() if file.exists() else ""
        whole, _, cut = text.rpartition("\n")
        if cut and repair:
            file.write_text(whole + "\n" if whole else "")
        for number, line in enumerate(whole.splitlines(), start=1):
            entry = json.loads(line)
            if entry["before"] != self.head:
                raise SealError(f"{file.name}: line {number} does not follow the line before")
            self.head = digest(line)
            self.lines.append(entry)

    def append(self, event: str, **content: Any) -> None:
        """Add a line, on disk before this returns."""
        entry = {
            "time": datetime.now(UTC).isoformat(timespec="milliseconds"),
            "event": event,
            **content,
            "before": self.head,
        }
        line = json.dumps(entry)
        with self.file.open("a") as out:
            out.write(line + "\n")
        self.head = digest(line)
        self.lines.append(entry)

    def find(self, event: str, part: str, first: int) -> dict[str, Any] | None:
        """Line of an event of the slice that begins at a case; None if there is none."""
        for entry in self.lines:
            if (entry["event"], entry.get("part"), entry.get("first")) == (event, part, first):
                return entry
        return None

    def done(self, part: str) -> int:
        """Cases of a part that are diagnosed, from its first on."""
        last = [e["last"] for e in self.lines if e["event"] == "diagnosed" and e["part"] == part]
        return max(last, default=0)
