"""What is understood of a recording before it is diagnosed: columns, units, runs, clock, gaps."""

import tomllib
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import DesignError, InputError, refuse_no_file
from cyclosweep.recording.choosing import Choice, choose, numbers_of
from cyclosweep.recording.columns import file_columns, stem
from cyclosweep.recording.facts import facts_of
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.in_force import InForce
from cyclosweep.recording.lengths import length_notes
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.metadata_text import to_toml
from cyclosweep.recording.opening import open_table
from cyclosweep.recording.proposal import propose
from cyclosweep.recording.proposed import Known, Proposal
from cyclosweep.recording.recording import Recording
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.stated_units import stated_unit
from cyclosweep.recording.units import CANONICAL_UNITS

__all__ = ["ColumnFacts", "Inspection", "inspect"]


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
    settings : Path or None
        Metadata file in force; `recording` and `facts` are as that reads the file.
    suggested : list of str
        What the file suggests otherwise.
    stops : str or None
        Why the settings alone do not read the file; the proposal does.
    """

    path: Path
    columns: list[ColumnFacts]
    text_columns: list[str]
    proposal: Proposal
    toml: str
    recording: Recording | None = None
    notes: list[str] = field(default_factory=list)
    facts: dict[str, str] = field(default_factory=dict)
    settings: Path | None = None
    suggested: list[str] = field(default_factory=list)
    stops: str | None = None

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
            "checks": self.proposal.checks,
            "assumed": self.proposal.assumed,
            "open": self.proposal.open,
            "settings": None if self.settings is None else str(self.settings),
            "suggested": self.suggested,
            "stops": self.stops,
            "metadata": self.proposal.meta,
            "toml": self.toml,
        }


def inspect(
    path: Path,
    known: Known,
    given: dict[str, str | None],
    meta_path: Path | None = None,
    settings: Path | None = None,
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
    settings : Path, optional
        Metadata file in force: the recording is shown as that reads it, and what the file suggests
        otherwise is listed.

    Returns
    -------
    Inspection

    Raises
    ------
    InputError
        The file cannot be read as a table, the settings do not fit it, or the drive cannot be
        built.
    """
    refuse_no_file(path)
    _refuse_drive(known)
    in_force = None if settings is None else InForce.read(settings, known, given)
    if in_force is not None:
        known = in_force.known
    asked = given if in_force is None else in_force.names(given)
    table = open_table(path, known.table, [name for name in asked.values() if name])
    if in_force is not None:
        in_force.refuse_missing_columns(path, table)
    numbers, bad = numbers_of(table)
    if numbers and not any(len(values) for values in numbers.values()):
        raise InputError(f"{path}: only the names of columns, expected readings below them")
    choice = choose(table, numbers, asked)
    made = propose(
        table, numbers, choice, known, bad, {} if in_force is None else in_force.columns(table)
    )
    twice = [name for name in dict.fromkeys(table.header) if name and table.header.count(name) > 1]
    if twice:
        made.assumed.append(
            f"{', '.join(twice)}: more than one column of that name, not read; rename all but one "
            "to use it."
        )
    if "angle_deg" not in {*choice.roles, *made.meta.get("columns", {})}:
        read = {named.column for named in choice.roles.values()}
        made.assumed += length_notes(table, [name for name in numbers if name not in read])
    suggested: list[str] = []
    if in_force is not None:
        by_file = choose(table, numbers, given).roles
        suggested = in_force.suggestions(by_file, made)
        in_force.put_into(made)
    text = to_toml(made, path.name)
    words = [name for name in table.header if name and name not in (*numbers, *twice)]
    found = Inspection(
        path, [], words, made, text,
        notes=list(table.notes), settings=settings, suggested=suggested,
    )  # fmt: skip
    meta = None
    if not made.open:
        meta = Metadata.model_validate(tomllib.loads(text))
        beside = meta_path or path.with_name(f"{stem(path)}.toml")
        if in_force is not None and not in_force.is_overridden:
            found.recording, found.stops = in_force.recording(path)
            meta = meta if found.recording is None else in_force.meta
        if found.recording is None:
            found.recording = Recording.read_as(path, meta, beside)
        found.notes = list(found.recording.notes)
        found.facts = facts_of(found.recording)
    roles = _roles(choice, made) if meta is None else _roles_read(table, meta)
    found.columns = [
        _column_facts(name, values, *roles.get(name, (None, table.units.get(name))))
        for name, values in numbers.items()
    ]
    return found


def _refuse_drive(known: Known) -> None:
    """Refuse a drive that cannot be built, or has no line to compare the recording with.

    Raises
    ------
    InputError
        With the reason.
    """
    if known.drive is None:
        return
    try:
        known.drive.nominal_line("output")
        why = known.drive.explain()  # a stiffness of its own gives any drive a line
    except DesignError as error:
        why = str(error)
    if why is not None:
        raise InputError(f"drive {known.drive_name or known.drive.name}: {why}")


def _roles(choice: Choice, made: Proposal) -> dict[str, tuple[str, str | None]]:
    """Role and unit of each column that was chosen.

    Parameters
    ----------
    choice : Choice
        The columns.
    made : Proposal
        With the units that were found.

    Returns
    -------
    dict of str to tuple
    """
    roles = {named.column: (role, named.unit) for role, named in choice.roles.items()}
    for role, column in made.meta.get("columns", {}).items():
        if isinstance(column, dict) and "unit" in column:
            roles[column["column"]] = (role, column["unit"])
    return roles


def _roles_read(table: FileTable, meta: Metadata) -> dict[str, tuple[str, str | None]]:
    """Role and unit of each column as metadata read it.

    Parameters
    ----------
    table : FileTable
        The file.
    meta : Metadata
        What is read, and how.

    Returns
    -------
    dict of str to tuple
    """
    roles: dict[str, tuple[str, str | None]] = {}
    for role, source in file_columns(meta).items():
        if source.column in table.header:
            stated = stated_unit(table, source.column)
            unit = source.unit or (stated[0] if stated else None) or CANONICAL_UNITS.get(role)
            roles[source.column] = (role, unit)
    return roles


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
