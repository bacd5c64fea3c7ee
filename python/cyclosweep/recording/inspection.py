"""What is understood of a recording before it is diagnosed: columns, units, runs, clock, gaps."""

import tomllib
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.checks import GAP_FACTOR
from cyclosweep.recording.choosing import choose, numbers_of
from cyclosweep.recording.columns import stem
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.metadata_text import to_toml
from cyclosweep.recording.opening import open_table
from cyclosweep.recording.proposal import propose
from cyclosweep.recording.proposed import Known, Proposal
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.structure import HOLD_SAMPLES

__all__ = ["ColumnFacts", "Inspection", "inspect"]

DWELL_BAND = 0.02
"""Band of the torque, of its range, in which a dwell stays: noise of a sensor is less."""

DWELL_FACTOR = 5.0
"""A dwell stays in the band for so many times the samples that a ramp usually does."""


@dataclass(frozen=True, slots=True)
class ColumnFacts:
    """One column of the file.

    Attributes
    ----------
    name : str
        Its name.
    unit : str or None
        As stated or proposed.
    role : str or None
        Canonical column that it is read as.
    low, high : float
        Range in the file's unit.
    step : float
        Smallest difference of two values, in the file's unit; 0 where all are equal.
    missing : int
        Rows without a value.
    rows : int
        Rows in all.
    """

    name: str
    unit: str | None
    role: str | None
    low: float
    high: float
    step: float
    missing: int
    rows: int


@dataclass(slots=True)
class Inspection:
    """What was understood of a file, and the metadata file that says so.

    Attributes
    ----------
    path : Path
        The file.
    columns : list of ColumnFacts
        Its columns of numbers.
    text_columns : list of str
        The others.
    proposal : Proposal
        What is proposed, assumed and open.
    toml : str
        The metadata file.
    recording : Recording or None
        The file read by it; None where something is open.
    notes : list of str
        What was recognised.
    facts : dict of str to str
        Runs, torque, angle, clock and so on, one line each.
    """

    path: Path
    columns: list[ColumnFacts]
    text_columns: list[str]
    proposal: Proposal
    toml: str
    recording: Recording | None = None
    notes: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)

    @property
    def unread_columns(self) -> list[str]:
        """Columns of numbers that the proposed metadata do not read."""
        selected = self.proposal.meta.get("select", {})
        return [c.name for c in self.columns if c.role is None and c.name not in selected]

    def as_dict(self) -> dict[str, Any]:
        """Content for JSON."""
        recording = self.recording
        return {
            "schema": "cyclosweep.inspection/1",
            "file": str(self.path),
            "columns": [asdict(column) for column in self.columns],
            "text_columns": self.text_columns,
            "unread_columns": self.unread_columns,
            "facts": self.facts,
            "notes": self.notes,
            "faults": [
                {"kind": f.kind, "verdict": f.verdict, "reason": f.reason}
                for f in (recording.faults if recording else ())
            ],
            "assumed": self.proposal.assumed,
            "open": self.proposal.open,
            "metadata": self.proposal.meta,
            "toml": self.toml,
        }


def inspect(
    path: Path, known: Known, given: dict[str, str | None], meta_path: Path | None = None
) -> Inspection:
    """Look at a recording and propose the metadata file with which it is read.

    Parameters
    ----------
    path : Path
        The recording's file.
    known : Known
        What the user says of it.
    given : dict of str to str or None
        Columns that the user names, by canonical column.
    meta_path : Path, optional
        Where the metadata file is to stand; a drive file is named relative to it.

    Returns
    -------
    Inspection

    Raises
    ------
    InputError
        The file cannot be read as a table.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    table = open_table(path, known.table, [name for name in given.values() if name])
    numbers = numbers_of(table)
    choice = choose(table, numbers, given)
    made = propose(table, numbers, choice, known)
    text = to_toml(made, path.name)
    roles = {named.column: (role, named.unit) for role, named in choice.roles.items()}
    for role, column in made.meta.get("columns", {}).items():
        if isinstance(column, dict) and "unit" in column:
            roles[column["column"]] = (role, column["unit"])
    found = Inspection(
        path,
        [_column_facts(name, values, *roles.get(name, (None, table.units.get(name))))
         for name, values in numbers.items()],
        [name for name in table.header if name and name not in numbers],
        made,
        text,
        notes=list(table.notes),
    )  # fmt: skip
    if not made.open:
        beside = meta_path or path.with_name(f"{stem(path)}.toml")
        meta = Metadata.model_validate(tomllib.loads(text))
        found.recording = Recording.read_as(path, meta, beside)
        found.notes = list(found.recording.notes)
        found.facts = _facts(found.recording)
    return found


def _column_facts(name: str, values: Floats, role: str | None, unit: str | None) -> ColumnFacts:
    """Range, step and missing values of a column.

    Parameters
    ----------
    name : str
        The column.
    values : ndarray of float, shape (rows,)
        Its numbers.
    role, unit : str or None
        Canonical column and unit.

    Returns
    -------
    ColumnFacts
    """
    known = values[np.isfinite(values)]
    levels = np.unique(known)
    steps = np.diff(levels)
    span = float(levels[-1] - levels[0]) if len(levels) else 0.0
    steps = steps[steps > 1e-9 * span]
    return ColumnFacts(
        name,
        unit,
        role,
        float(levels[0]) if len(levels) else 0.0,
        float(levels[-1]) if len(levels) else 0.0,
        float(steps.min()) if len(steps) else 0.0,
        len(values) - len(known),
        len(values),
    )


def _facts(recording: Recording) -> dict[str, str]:
    """Describe a recording that was read, one line for each thing."""
    torque = recording.torque_nm
    if not len(torque):
        return {"samples": "none"}
    facts = {"samples": f"{len(recording)} of {recording.path.name if recording.path else ''}"}
    both = torque.min() < 0 < torque.max()
    facts["torque"] = (
        f"{torque.min():.4g} to {torque.max():.4g} N m at the {recording.side} shaft, "
        f"{'both directions' if both else 'one direction'}, "
        f"{len(recording.structure.reversals)} reversals"
    )
    if recording.angle_deg is not None:
        angle = recording.angle_deg
        step = recording.angle_resolution_deg
        facts["angle"] = f"{angle.min():.4g} to {angle.max():.4g} deg, " + (
            f"steps of {step:g} deg" if step else "continuous"
        )
    facts["runs"] = _run_facts(recording)
    facts["dwells"] = _dwell_facts(recording)
    facts["clock"] = _clock_facts(recording)
    if recording.temperature_c is not None:
        warm = recording.temperature_c
        facts["temperature"] = f"{warm.min():.3g} to {warm.max():.3g} deg C"
    if recording.crank_deg is not None:
        facts["mesh positions"] = f"{len(np.unique(recording.crank_deg))}"
    return facts


def _dwell_facts(recording: Recording) -> str:
    """Number of dwells and how long they last, equal torques or torques equal but for noise."""
    spans = [(hold.start, hold.stop) for hold in recording.structure.holds]
    spans = spans or _noisy_dwells(recording.torque_nm)
    if not spans:
        return "none"
    time = recording.time_s
    if time is None:
        return f"{len(spans)} at constant torque"
    known = [float(time[stop - 1] - time[start]) for start, stop in spans]
    return f"{len(spans)} at constant torque, {min(known):.3g} to {max(known):.3g} s"


def _noisy_dwells(torque: Floats) -> list[tuple[int, int]]:
    """Find stretches in which the torque stays in one band for far longer than elsewhere.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque [N m].

    Returns
    -------
    list of tuple of int
        First sample, and the one after the last.
    """
    band = DWELL_BAND * float(np.ptp(torque))
    bounds, low, high = [0], float(torque[0]), float(torque[0])
    for place, value in enumerate(torque.tolist()):
        low, high = min(low, value), max(high, value)
        if high - low > band:
            bounds.append(place)
            low = high = value
    spans = list(pairwise([*bounds, len(torque)]))
    usual = float(np.median([stop - start for start, stop in spans]))
    least = max(HOLD_SAMPLES, DWELL_FACTOR * usual)
    return [
        (start, stop)
        for start, stop in spans
        if stop - start >= least and _is_level(torque[start:stop], band)
    ]


def _is_level(torque: Floats, band: float) -> bool:
    """Whether a stretch is level; at the crest of a wave the middle lies above the ends.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque of the stretch [N m].
    band : float
        Band in which it stays [N m].

    Returns
    -------
    bool
    """
    first, middle, last = (float(part.mean()) for part in np.array_split(torque, 3))
    return max(abs(middle - first), abs(middle - last)) < 0.2 * band


def _run_facts(recording: Recording) -> str:
    """Number of runs, their samples and torques."""
    shown = []
    for run in recording.runs[:8]:
        part = recording.torque_nm[recording.run == run]
        shown.append(f"{run} ({len(part)} samples, {part.min():.3g} to {part.max():.3g} N m)")
    more = len(recording.runs) - len(shown)
    return f"{len(recording.runs)}: " + ", ".join(shown) + (f" and {more} more" if more else "")


def _clock_facts(recording: Recording) -> str:
    """Rate, length and gaps of the clock."""
    time = recording.time_s
    if time is None or len(time) < 2:
        return "none: only the order of rows is known, effects of rate cannot be tested"
    step = np.diff(time)
    within = (np.diff(recording.run) == 0) & (step > 0)
    if not within.any():
        return "stands still"
    median = float(np.median(step[within]))
    gaps = np.count_nonzero(within & (step > GAP_FACTOR * median))
    text = f"{1 / median:.4g} Hz (a sample every {median:.4g} s), {np.ptp(time):.4g} s long"
    return f"{text}, {gaps or 'no'} gaps"
