"""Which code a record was made with: hashes over files, and the commit where there is one."""

from __future__ import annotations

import hashlib
import subprocess
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "cyclosweep"
SCORED_BY = ("opponents", "scoring", "board", "record", "runner", "measured")
"""Parts of the challenge that neither make recordings nor diagnose them."""


def _hash(files: list[Path], root: Path) -> str:
    """One hash over names and contents."""
    lines = "".join(
        f"{file.relative_to(root).as_posix()} {hashlib.sha256(file.read_bytes()).hexdigest()}\n"
        for file in sorted(files)
    )
    return hashlib.sha256(lines.encode()).hexdigest()


def diagnosis_hash(package: Path = PACKAGE) -> str:
    """SHA-256 over all that diagnoses and predicts: the package but its challenge, Rust included.

    Reports and the command line are left out: they show what was found and decide nothing.
    """
    left_out = {"report", "cli"}
    files = [
        file for file in package.rglob("*.py") if file.relative_to(package).parts[0] not in left_out
    ]
    rust = package.parents[1] / "rust"
    files += rust.rglob("*.rs") if rust.is_dir() else []
    return _hash(files, package.parents[1])


def rig_hash(package: Path = PACKAGE) -> str:
    """SHA-256 over all that makes recordings and answers."""
    root = package.parent / "cyclosweep_challenge"
    files = [
        file
        for file in root.rglob("*.py")
        if not file.relative_to(root).parts[0].startswith(SCORED_BY)
    ]
    return _hash(files, package.parents[1])


def commit(package: Path = PACKAGE) -> str:
    """Commit of the source tree, with a plus where files differ from it; empty without one."""

    def git(*words: str) -> str:
        done = subprocess.run(
            ["git", *words], cwd=package, capture_output=True, text=True, check=False
        )
        return done.stdout.strip() if done.returncode == 0 else ""

    try:
        name = git("rev-parse", "HEAD")
        changed = git("status", "--porcelain", "--", ".")
    except OSError:
        return ""
    return name + ("+" if name and changed else "")


def code(package: Path = PACKAGE) -> dict[str, str]:
    """Hashes that must not change within a record."""
    return {"diagnosis": diagnosis_hash(package), "rig": rig_hash(package)}
