"""Lines of the practice recordings, which are only stated: good results there prove nothing."""

from __future__ import annotations

import json
from pathlib import Path

from cyclosweep.recording import Recording
from cyclosweep_challenge.scoreboard.line import Line

GROUP = "Practice recordings (only stated)"
CASES = 9
"""Number of practice recordings."""


def truth_of(recordings: Path, case: str) -> str:
    """Return the effects of a practice recording, as its answer file says."""
    content = json.loads((recordings / "practice" / "truth.json").read_text())
    return ", ".join(content[case]["effects"]) or "nothing"


def practice_lines(recordings: Path) -> list[Line]:
    """Lines of the practice recordings; none where they are absent.

    Parameters
    ----------
    recordings : pathlib.Path
        Shared folder of recordings.
    """
    if not (recordings / "practice" / "truth.json").is_file():
        return []
    lines = []
    for number in range(CASES):
        case = f"case-{number:03d}"
        file = f"practice/{case}/recording.csv"

        def read(shared: Path, file: str = file) -> Recording:
            return Recording.read(shared / file)

        lines.append(
            Line(
                f"practice-{number:03d}",
                GROUP,
                "Made by a rig that is not part of the project.",
                f"At work: {truth_of(recordings, case)}.",
                "its truth.json",
                read,
                file=file,
                verdict_only=True,
            )
        )
    return lines
