"""Folders of a run, and the lock that keeps them to one process."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from cyclosweep_challenge.trial.seal import root_hash

LOCK = ".lock"
"""File by which a process has a run's folder to itself."""


@contextmanager
def alone(out: Path) -> Iterator[None]:
    """Lock a run's folder for this process; the lock ends with the process.

    Raises
    ------
    ValueError
        If another process is at work there.
    """
    out.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(out / LOCK, timeout=0):
            yield
    except Timeout:
        raise ValueError(f"{out}: another process is at work there; let it finish") from None


class Folders:
    """Folders of a run; recordings and answers lie in different ones."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.recordings = out / "recordings"
        self.answers = out / "answers"
        self.diagnoses = out / "diagnoses"
        self.opponents = out / "opponents"
        for folder in (self.recordings, self.answers, self.diagnoses, self.opponents):
            folder.mkdir(parents=True, exist_ok=True)

    def answer(self, key: str) -> Path:
        """File of one answer."""
        return self.answers / f"{key}.json"

    def hashes(self) -> dict[str, str]:
        """Return the published hash of every answer, by key."""
        file = self.answers / "HASHES.txt"
        lines = file.read_text().splitlines() if file.exists() else []
        return dict(line.split(" ", 1) for line in lines if line)

    def publish(self, hashes: dict[str, str]) -> str:
        """Write all hashes and their root; return the root."""
        text = "".join(f"{key} {hashes[key]}\n" for key in sorted(hashes))
        partial = self.answers / "HASHES.tmp"
        partial.write_text(text)
        partial.replace(self.answers / "HASHES.txt")
        root = root_hash(hashes.items())
        (self.answers / "ROOT.txt").write_text(f"{root} {len(hashes)} answers\n")
        return root
