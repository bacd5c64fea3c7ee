"""Recordings of real devices and made ones with large effects get the right answer.

The scoreboard (docs/scoreboard.md) says for each line what the right answer is, and who says so.
"""

from pathlib import Path

import pytest

from cyclosweep_challenge.scoreboard.line import Line
from cyclosweep_challenge.scoreboard.lines import all_lines
from cyclosweep_challenge.scoreboard.run import diagnosed

MADE = (
    "coulomb-dahl",
    "load-friction-creep",
    "load-friction-thermal-drift",
    "loud-load-asymmetry",
    "loud-datum-drift",
    "overload-softening-d400",
    "thermal-drift-d400",
    "creep-d400",
    "ar97-nothing-1",
    "ar97-nothing-2",
    "long-2000",
)
"""Made recordings that take seconds."""
MEASURED = (
    "conic_1pre5",
    "damper-30lb-1in-0.5Hz",
    "damper-36lb-1in-0.25Hz",
    "wall-no-clock",
    "wall-row-clock",
)
"""Recordings of the shared folder."""


def line_of(name: str, recordings: Path) -> Line:
    """Line of the scoreboard."""
    (line,) = (line for line in all_lines(recordings) if line.name == name)
    return line


@pytest.mark.parametrize("name", MADE)
def test_made_recording(name: str, tmp_path: Path) -> None:
    line = line_of(name, tmp_path)
    outcome = diagnosed(line, tmp_path, full=False)
    assert line.failed(outcome) == [], outcome.statement


@pytest.mark.shared
@pytest.mark.parametrize("name", MEASURED)
def test_measured_recording(name: str, shared_recordings: Path) -> None:
    line = line_of(name, shared_recordings)
    outcome = diagnosed(line, shared_recordings, full=False)
    assert line.failed(outcome) == [], outcome.statement
