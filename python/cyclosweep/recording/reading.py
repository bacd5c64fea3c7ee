"""From a file and its metadata to what a recording is made of, in canonical names and units."""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.errors import InputError, refuse_no_file
from cyclosweep.recording.cleaning import (
    beyond_limits,
    drop_missing,
    drop_repeated,
    few_selected,
    keep_selected,
    merge_ticks,
    put_angle_right,
    without_stopped_clock,
)
from cyclosweep.recording.columns import (
    Columns,
    canonical_columns,
    file_columns,
    load,
    metadata_path,
    stem,
)
from cyclosweep.recording.decimation import merge_neighbours
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.shared_ticks import spread_ticks
from cyclosweep.recording.signals import angle_lattice

__all__ = ["read", "stem"]


@np.errstate(all="ignore")
def read(path: Path, meta_path: Path | None, meta: Metadata | None = None) -> dict[str, Any]:
    """Read what a recording is made of.

    Parameters
    ----------
    path : Path
        CSV or Parquet file.
    meta_path : Path or None
        TOML file that says how to read it; None: the file of the same stem beside it, where
        there is one.
    meta : Metadata, optional
        What that file is to say; it is not read then.

    Returns
    -------
    dict
        Keyword arguments of :class:`cyclosweep.Recording`.

    Raises
    ------
    InputError
        The file cannot be read as a recording.
    """
    refuse_no_file(path)
    meta_path = metadata_path(path, meta_path)
    if meta is None:
        meta = Metadata() if meta_path is None else Metadata.read(meta_path)
    notes: list[str] = []
    columns, faults = _clean_columns(path, meta_path, meta, notes)
    run, beyond = columns.pop("run"), columns.pop("unscored")
    assert run is not None  # canonical_columns makes one where the file has none
    unscored = None if beyond is None else beyond > 0.5
    if unscored is not None and unscored.any():
        notes.append(
            f"{np.count_nonzero(unscored)} of {len(unscored)} samples lie beyond the limits of "
            "[score]: simulated for what they do to the drive, neither fitted nor scored."
        )
    resolution = _resolution(meta, columns, run, notes)
    if meta.side is None and columns["angle_deg"] is not None:
        notes.append("Side not given: taken as the input shaft.")
    return {
        "name": stem(path),
        "path": path,
        **columns,
        "run": run.astype(np.int64),
        "unscored": unscored,
        "side": meta.side or "input",
        "drive": _drive(meta, meta_path),
        "torque_from": meta.torque_from,
        "angle_resolution_deg": resolution,
        "angle_modulo_deg": _modulo(meta),
        "history": meta.history,
        "reset_between_runs": meta.reset_between_runs,
        "conditioning_runs": tuple(meta.conditioning_runs),
        "holdout_runs": tuple(meta.holdout_runs),
        "notes": tuple(notes),
        "faults": faults,
        "sha256": _sha256(path),
    }


def _clean_columns(
    path: Path, meta_path: Path | None, meta: Metadata, notes: list[str]
) -> tuple[Columns, tuple[Fault, ...]]:
    """Read the canonical columns: selected, merged, complete, the angle put right.

    Parameters
    ----------
    path : Path
        The recording's file.
    meta_path : Path or None
        The metadata file, for messages.
    meta : Metadata
        What it says.
    notes : list of str
        What was recognised and changed is added to it.

    Returns
    -------
    columns : dict of str to ndarray of float, shape (n,), or None
        With ``unscored``, 1 where a sample is not scored.
    faults : tuple of Fault
        Of samples that are missing or not selected, and of names that speak against the metadata.

    Raises
    ------
    InputError
        The file cannot be read as a recording.
    """
    sources = file_columns(meta)
    frame, recognised, remarks = load(path, meta_path, meta, sources)
    notes += recognised
    columns = canonical_columns(path, frame, sources, notes)
    columns["unscored"] = beyond_limits(meta.score.abs_max, columns, frame)
    columns = keep_selected((path, meta_path), meta, columns, frame, notes)
    few = few_selected(frame.height, columns)
    clock = columns["time_s"]
    columns = without_stopped_clock(columns, notes)
    if meta.merge.same_time and (clock is None or columns["time_s"] is not None):
        columns = merge_ticks(path, columns, notes)
    elif columns["time_s"] is not None:
        columns = drop_repeated(columns, notes)
    columns, faults = drop_missing(columns, notes)
    columns = spread_ticks(columns, notes)
    columns["angle_deg"] = put_angle_right(columns, meta, notes)
    if meta.merge.neighbours > 1:
        columns = merge_neighbours(columns, meta.merge.neighbours, notes)
    return columns, (*few, *faults, *remarks)


def _resolution(meta: Metadata, columns: Columns, run: Floats, notes: list[str]) -> float:
    """Step of the angle reading: the metadata's, or one that all readings are multiples of.

    Parameters
    ----------
    meta : Metadata
        What the metadata file says.
    columns : dict of str to ndarray of float, shape (n,), or None
        Canonical columns.
    run : ndarray of float, shape (n,)
        Trial each sample belongs to.
    notes : list of str
        A step that was recognised is added to it.

    Returns
    -------
    float
        Step [deg]; 0 where the angle is continuous.
    """
    angle, torque = columns["angle_deg"], columns["torque_nm"]
    if meta.angle_resolution_deg or angle is None or torque is None:
        return meta.angle_resolution_deg
    resolution = angle_lattice(angle, torque, run)
    if resolution:
        notes.append(f"Angles lie on steps of {resolution:g} deg: taken as the resolution.")
    return resolution


def _modulo(meta: Metadata) -> float | None:
    """Period of the angle [deg] that the metadata give."""
    source = meta.columns.get("angle_deg")
    return None if source is None else source.modulo


def _drive(meta: Metadata, meta_path: Path | None) -> str | None:
    """Return a built-in name, or the whole path of a drive file beside the metadata.

    Parameters
    ----------
    meta : Metadata
        What the metadata file says.
    meta_path : Path or None
        The metadata file.

    Returns
    -------
    str or None
        None where the metadata name no drive.

    Raises
    ------
    InputError
        When the drive file is not there.
    """
    if meta.drive is None or meta_path is None:
        return meta.drive
    beside = meta_path.parent / meta.drive
    if beside.is_file():
        return str(beside.resolve())
    if meta.drive.endswith(".toml"):
        raise InputError(f"{meta_path}, key drive: no file {meta.drive!r} beside it")
    return meta.drive


def _sha256(path: Path) -> str:
    """Hash of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
