"""A line of the scoreboard: one recording, its right answer in words, and as checks."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.recording import Recording
from cyclosweep_challenge.scoreboard.outcome import Outcome


@dataclass(frozen=True)
class Check:
    """Something that is true of a right answer.

    Attributes
    ----------
    words : str
        What is true, in a few words.
    holds : callable
        Whether it is true of an outcome.
    """

    words: str
    holds: Callable[[Outcome], bool]


def _no_figures(found: Diagnosis, recordings: Path) -> Mapping[str, float]:
    """Measure nothing beside what the diagnosis says."""
    return {}


@dataclass(frozen=True)
class Line:
    """One recording with its right answer.

    Attributes
    ----------
    name, group : str
        Name of the line, and which table it belongs to.
    asks : str
        What the recording is and what the diagnosis is asked.
    answer : str
        The right answer in words.
    source : str
        Who says that this is the right answer.
    recording : callable
        Makes or reads the recording; the argument is the shared folder of recordings.
    checks : sequence of Check
        What a right answer holds; none where the line is only stated.
    figures : callable
        What is measured on the recording and the repaired model; gets the diagnosis and the shared
        folder of recordings.
    file : str
        File below the shared folder, where the recording is read; empty where it is made.
    verdict_only : bool
        Diagnose without held-out proof and self-check, which take about half of the time.
    """

    name: str
    group: str
    asks: str
    answer: str
    source: str
    recording: Callable[[Path], Recording]
    checks: Sequence[Check] = ()
    figures: Callable[[Diagnosis, Path], Mapping[str, float]] = _no_figures
    file: str = ""
    verdict_only: bool = False

    def failed(self, outcome: Outcome) -> list[str]:
        """What a right answer would hold and this one does not."""
        return [check.words for check in self.checks if not check.holds(outcome)]


@dataclass(frozen=True)
class Summary:
    """A check over several lines.

    Attributes
    ----------
    name, group, asks, source : str
        As of `Line`.
    of : sequence of str
        Names of the lines.
    judged : callable
        Whether the outcomes of those lines are right together, and the figure that says so; gets
        the outcomes that there are, by name.
    """

    name: str
    group: str
    asks: str
    source: str
    of: Sequence[str]
    judged: Callable[[Mapping[str, Outcome]], tuple[bool, str]] = field(repr=False)
