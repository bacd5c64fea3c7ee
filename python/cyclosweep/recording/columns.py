"""From the columns of a file to canonical columns: found by name, scaled, unwrapped."""

from collections.abc import Iterable, Mapping
from itertools import combinations
from pathlib import Path

import numpy as np
import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.recording.endings import ENDINGS
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.metadata import APART, CANONICAL_COLUMNS, Column, Metadata, conversion
from cyclosweep.recording.opening import open_table
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import unwrap
from cyclosweep.recording.stated_units import take_stated_units
from cyclosweep.recording.unread_columns import unread_columns
from cyclosweep.recording.wrapping import unwrap_with_torque

__all__ = ["Columns", "canonical_columns", "file_columns", "load", "refuse_missing_columns", "stem"]

Columns = dict[str, Floats | None]
"""Canonical columns by name, each of shape (rows,); None where the file has none."""


def stem(path: Path) -> str:
    """Name of a file without its endings .gz, .csv and the like.

    Examples
    --------
    >>> stem(Path("ramp.v2.csv.gz"))
    'ramp.v2'
    """
    name = path.name[:-3] if path.name.lower().endswith(".gz") else path.name
    main, dot, ending = name.rpartition(".")
    if dot and ending.lower() in ENDINGS:
        name = main
    return name or path.name


def metadata_path(path: Path, given: Path | None = None) -> Path | None:
    """Metadata file of a recording: the one given, or the one of its name beside it.

    Parameters
    ----------
    path : Path
        The recording.
    given : Path, optional
        What the user names.

    Returns
    -------
    Path or None
        None where there is none.
    """
    beside = path.with_name(f"{stem(path)}.toml")
    if given is None and beside.is_file() and beside != path:
        return beside
    return given


def file_columns(meta: Metadata) -> dict[str, Column]:
    """File column of each canonical one; its own name where the metadata do not say."""
    return {
        name: meta.columns.get(name) or Column(column=name)  # type: ignore[call-overload]
        for name in CANONICAL_COLUMNS
    }


def load(
    path: Path, meta_path: Path | None, meta: Metadata, sources: dict[str, Column]
) -> tuple[pl.DataFrame, list[str], list[Fault]]:
    """Read the file columns that are needed, all of them numbers but those selected by text.

    Parameters
    ----------
    path : Path
        The recording's file, CSV or Parquet.
    meta_path : Path or None
        The metadata file, for messages.
    meta : Metadata
        What it says.
    sources : dict of str to Column
        File column of each canonical one.

    Returns
    -------
    frame : polars.DataFrame
        The file columns, in the file's units.
    notes : list of str
        What was recognised.
    remarks : list of Fault
        Names that speak against the settings.

    Raises
    ------
    InputError
        For a column that is missing, a unit that the file contradicts, or a cell that is not of
        its kind.
    """
    wanted = {source.column for source in sources.values()}
    table = open_table(path, meta.table, wanted)
    refuse_missing_columns(path, meta_path, meta, sources, table.header)
    _refuse_without_torque(path, meta_path, sources["torque_nm"], table.header)
    numbers, words = _needed(path, meta_path, meta, sources, table.header)
    frame = table.read(sorted(numbers), sorted(words))
    notes = list(table.notes)
    frame = _without_broken_end(frame, notes)
    remarks = take_stated_units((path, meta_path), meta, table, sources, notes)
    remarks += unread_columns(meta, sources, table)
    return frame, notes, remarks


def _without_broken_end(frame: pl.DataFrame, notes: list[str]) -> pl.DataFrame:
    """Pass over a last row that lacks a value no other row lacks, as where a logger was stopped.

    Parameters
    ----------
    frame : polars.DataFrame
        The file columns.
    notes : list of str
        What was passed over is added to it.

    Returns
    -------
    polars.DataFrame
    """
    if frame.height < 2:
        return frame
    lacking = [name for name in frame.columns if frame[name].null_count() == 1]
    broken = [name for name in lacking if frame[name][-1] is None]
    if not broken:
        return frame
    notes.append(
        f"The last row, data row {frame.height}, is incomplete (no {', '.join(broken)}): passed "
        "over."
    )
    return frame.head(-1)


def refuse_missing_columns(
    path: Path,
    meta_path: Path | None,
    meta: Metadata,
    sources: Mapping[str, Column],
    header: list[str],
) -> None:
    """Refuse a file without a column that the metadata name, or one that is read as two things.

    Parameters
    ----------
    path, meta_path, meta, sources
        As for `load`.
    header : list of str
        Columns of the file.

    Raises
    ------
    InputError
        With the columns that were found.
    """
    found = _listed(header)
    for name, source in sources.items():
        if name in meta.columns and source.column not in header:
            raise InputError(
                f"{meta_path}, key columns.{name}: column {source.column!r} is not in {path}, "
                f"found {found}"
            )
    for name, other in combinations([role for role in APART if role in sources], 2):
        if sources[name].column == sources[other].column:
            key = name if name in meta.columns else other
            raise InputError(
                f"{meta_path}, key columns.{key}: found column {sources[key].column!r}, which "
                f"{other if key == name else name} reads, too; expected a column of its own"
            )


def _refuse_without_torque(
    path: Path, meta_path: Path | None, source: Column, header: list[str]
) -> None:
    """Refuse a file without the torque.

    Parameters
    ----------
    path, meta_path
        As for `load`.
    source : Column
        File column of the torque.
    header : list of str
        Columns of the file.

    Raises
    ------
    InputError
        With the columns that were found.
    """
    found = _listed(header)
    if source.column not in header:
        raise InputError(
            f"{path}: no column torque_nm, found {found}; name it under [columns] in "
            f"{meta_path or stem(path) + '.toml'}, or let `cyclosweep inspect` propose that file"
        )


def _needed(
    path: Path,
    meta_path: Path | None,
    meta: Metadata,
    sources: dict[str, Column],
    header: list[str],
) -> tuple[set[str], set[str]]:
    """Decide which file columns are read as numbers and which as text.

    Parameters
    ----------
    path, meta_path, meta, sources
        As for `load`.
    header : list of str
        Columns of the file.

    Returns
    -------
    numbers, words : set of str
        Names of file columns; no column is in both.

    Raises
    ------
    InputError
        For a selection or limit on a column that is not there or not of that kind.
    """
    found = _listed(header)
    numbers = {source.column for source in sources.values() if source.column in header}
    words: set[str] = set()
    for key, values in meta.keep.items():
        column = sources[key].column if key in sources else key
        if column not in header:
            raise InputError(f"{meta_path}, key select.{key}: not a column of {path}: {found}")
        is_text = bool(values) and all(isinstance(value, str) for value in values)
        if is_text and column in numbers:
            raise InputError(f"{meta_path}, key select.{key}: found text, expected numbers")
        (words if is_text else numbers).add(column)
    for table_name, limits in (("select", meta.abs_max), ("score", meta.score.abs_max)):
        for key in limits:
            column = sources[key].column if key in sources else key
            if column not in header:
                raise InputError(
                    f"{meta_path}, key {table_name}.abs_max.{key}: not a column of {path}: {found}"
                )
            numbers.add(column)
    if both := numbers & words:
        raise InputError(f"{meta_path}, key select: {min(both)} is selected as text and as number")
    return numbers, words


def canonical_columns(
    path: Path, frame: pl.DataFrame, sources: dict[str, Column], notes: list[str]
) -> Columns:
    """Scale and unwrap every column; a missing run column is one run.

    Parameters
    ----------
    path : Path
        The recording's file, for messages.
    frame : polars.DataFrame
        What `load` read, in the file's units.
    sources : dict of str to Column
        File column, scale, offset and period of each canonical column.
    notes : list of str
        What was changed is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (rows,), or None
        In canonical units.

    Raises
    ------
    InputError
        For a run that is no whole number.
    """
    columns: Columns = {}
    for name, source in sources.items():
        if source.column not in frame.columns:
            columns[name] = None
            continue
        factor, offset = conversion(name, source)
        values = frame[source.column].to_numpy().astype(np.float64) * factor + offset
        if source.modulo is not None and name != "angle_deg":
            values, count = unwrap(values, source.modulo)
            notes.append(f"{name} is known modulo {source.modulo:g}: {count} wraps undone.")
        columns[name] = values
    run = columns["run"]
    if run is None:
        columns["run"] = np.ones(frame.height)
    else:
        wrong = np.flatnonzero(~(np.isfinite(run) & (run == np.rint(run)) & (abs(run) < 2**53)))
        if len(wrong):
            value = run[wrong[0]]
            raise InputError(
                f"{path}, data row {wrong[0] + 1}, column {sources['run'].column}: found "
                f"{'no number' if np.isnan(value) else f'{value:g}'}, expected an integer"
            )
    _unwrap_angle(columns, sources["angle_deg"].modulo, notes)
    return columns


def _unwrap_angle(columns: Columns, modulo: float | None, notes: list[str]) -> None:
    """Put together an angle that is known modulo a period only.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns; the angle is changed in place.
    modulo : float or None
        The period [deg].
    notes : list of str
        What was done is added to it.
    """
    angle, torque, run = columns["angle_deg"], columns["torque_nm"], columns["run"]
    if modulo is None or angle is None or torque is None or run is None:
        return
    columns["angle_deg"], wraps, by_torque = unwrap_with_torque(angle, torque, run, modulo)
    notes.append(f"angle_deg is known modulo {modulo:g}: {wraps} wraps undone.")
    if by_torque:
        notes.append(
            f"{by_torque} steps through zero torque are longer than half the modulo: taken in the "
            "direction of the torque."
        )


def _listed(header: Iterable[str]) -> str:
    """Column names for a message."""
    names = list(header)
    shown = ", ".join(names[:12])
    return shown if len(names) <= 12 else f"{shown} and {len(names) - 12} more"
