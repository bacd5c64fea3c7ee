"""Which rows of a recording become samples, and angles put right; what was done is noted."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep.errors import InputError
from cyclosweep.recording.checks import MIN_SAMPLES
from cyclosweep.recording.columns import Columns
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.metadata import Metadata
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import merge_same_time, sign_is_reversed, unwrap, wraps_at_360

__all__ = [
    "MISSING_SHARE",
    "REVERSED",
    "beyond_limits",
    "drop_missing",
    "drop_repeated",
    "few_selected",
    "keep_selected",
    "merge_ticks",
    "put_angle_right",
]

REVERSED = "Angle falls where torque rises: its sign is reversed."
"""Note on a recording whose angle was turned round when it was read."""
MISSING_SHARE = 1 / 3
"""Share of samples without a value above which a recording is faulty."""


def beyond_limits(
    limits: Mapping[str, float], columns: Columns, frame: pl.DataFrame
) -> Floats | None:
    """Mark the rows whose magnitudes lie beyond limits.

    Parameters
    ----------
    limits : mapping of str to float
        Largest magnitude by column, canonical or of the file, in that column's unit.
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    frame : polars.DataFrame
        Columns of the file, as many rows.

    Returns
    -------
    ndarray of float, shape (rows,), or None
        1 where a row lies beyond, 0 where it does not; None without limits.
    """
    if not limits:
        return None
    beyond = np.zeros(frame.height)
    for key, limit in limits.items():
        beyond[np.abs(_values(key, columns, frame)) > limit] = 1.0
    return beyond


def keep_selected(
    paths: tuple[Path, Path | None],
    meta: Metadata,
    columns: Columns,
    frame: pl.DataFrame,
    notes: list[str],
) -> Columns:
    """Keep the rows that ``[select]`` of the metadata asks for.

    Parameters
    ----------
    paths : tuple of Path and Path or None
        The recording's file and the metadata file, for messages.
    meta : Metadata
        Values and largest magnitudes to keep.
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    frame : polars.DataFrame
        Columns of the file, as many rows.
    notes : list of str
        How many rows are kept is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (kept rows,), or None

    Raises
    ------
    InputError
        When no row has one of the values, or none is within the limits.
    """
    path, meta_path = paths
    keep = np.ones(frame.height, dtype=bool)
    for key, allowed in meta.keep.items():
        mask = np.isin(_values(key, columns, frame), np.array(allowed))
        if not mask.any() and frame.height:
            raise InputError(f"{meta_path}, key select.{key}: no row of {path} has {allowed}")
        keep &= mask
    for key, limit in meta.abs_max.items():
        mask = np.abs(_values(key, columns, frame)) <= limit
        if not mask.any() and frame.height:
            raise InputError(
                f"{meta_path}, key select.abs_max.{key}: found {limit:g}, which no row of {path} "
                "is within"
            )
        keep &= mask
    if not keep.any() and frame.height:
        raise InputError(f"{meta_path}, key select: no row of {path} fits all that it asks for")
    if keep.all():
        return columns
    notes.append(f"Selection keeps {keep.sum()} of {len(keep)} rows.")
    return _rows(columns, keep)


def few_selected(before: int, columns: Columns) -> tuple[Fault, ...]:
    """Find a recording of which ``[select]`` keeps too little.

    Parameters
    ----------
    before : int
        Rows of the file.
    columns : dict of str to ndarray of float, shape (kept rows,), or None
        What is kept.

    Returns
    -------
    tuple of Fault
        Empty where the file is too short by itself.
    """
    run = columns["run"]
    kept = 0 if run is None else len(run)
    if columns["angle_deg"] is None or not kept < MIN_SAMPLES <= before:
        return ()
    reason = (
        f"[select] keeps {kept} of {before} rows: at least {MIN_SAMPLES} are needed to tell "
        "stiffness, free play and datum from scatter."
    )
    return (Fault("too_few_selected", "INSUFFICIENT_DATA", reason),)


def without_stopped_clock(columns: Columns, notes: list[str]) -> Columns:
    """Leave out a recording's clock that shows the same time at every row; a programme's stays.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    notes : list of str
        That the clock is left out is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (rows,), or None
    """
    time = columns["time_s"]
    if columns["angle_deg"] is None or time is None or len(time) < 2:
        return columns
    shown = time[np.isfinite(time)]
    if not len(shown) or np.ptp(shown) > 0.0:
        return columns
    notes.append(
        f"The clock stands at {shown[0]:g} s in every row and is left out: only the order "
        "of the rows is known."
    )
    return {**columns, "time_s": None}


def merge_ticks(path: Path, columns: Columns, notes: list[str]) -> Columns:
    """Average neighbouring rows of one run that share a clock tick.

    Parameters
    ----------
    path : Path
        The recording's file, for messages.
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    notes : list of str
        How many rows became one is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (samples,), or None

    Raises
    ------
    InputError
        Without a clock.
    """
    time, run = columns["time_s"], columns["run"]
    if time is None or run is None:
        raise InputError(f"{path}: merge.same_time needs a column time_s, found none")
    merged, largest = merge_same_time(columns, time, run)
    before, after = len(time), len(merged["run"] if merged["run"] is not None else ())
    if after < before:
        notes.append(
            f"Rows that share a clock tick averaged: {before} rows became {after} samples "
            f"(up to {largest} in one)."
        )
    return merged


def drop_repeated(columns: Columns, notes: list[str]) -> Columns:
    """Drop rows that repeat the one before them in everything, the clock included.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    notes : list of str
        How many rows are dropped is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (kept rows,), or None
    """
    present = [values for values in columns.values() if values is not None]
    repeated = np.logical_and.reduce([values[1:] == values[:-1] for values in present])
    if not repeated.any() or repeated.all():  # all of them: a check has the better message
        return columns
    notes.append(f"{np.count_nonzero(repeated)} rows that repeat the one before dropped.")
    return _rows(columns, np.r_[True, ~repeated])


def drop_missing(columns: Columns, notes: list[str]) -> tuple[Columns, tuple[Fault, ...]]:
    """Drop samples without a finite torque, angle or time; a sparse extra column is left out.

    Parameters
    ----------
    columns : dict of str to ndarray, shape (rows,), or None
        Canonical columns.
    notes : list of str
        What is dropped or left out is added to it.

    Returns
    -------
    columns : dict of str to ndarray, shape (kept rows,), or None
    faults : tuple of Fault
        One when more than `MISSING_SHARE` of the samples are missing: what is left is not the
        test any more.
    """
    faults: tuple[Fault, ...] = ()
    run = columns["run"]
    keep = np.ones(0 if run is None else len(run), dtype=bool)
    for name in ("torque_nm", "angle_deg", "time_s"):
        values = columns[name]
        if values is None:
            continue
        finite = np.isfinite(values)
        if name != "torque_nm" and len(finite) and not finite.any():
            columns = {**columns, name: None}
            notes.append(f"Column {name} has no values: left out.")
            continue
        keep &= finite
    if dropped := int((~keep).sum()):
        text = (
            f"{dropped} of {len(keep)} samples without a finite value dropped, the first of them "
            f"sample {int(np.argmin(keep)) + 1}."
        )
        notes.append(text)
        if dropped > MISSING_SHARE * len(keep):
            faults = (Fault("missing_values", "DATA_FAULT", text),)
    for name in ("crank_deg", "temperature_c"):
        values = columns[name]
        if values is not None and not np.isfinite(values[keep]).all():
            columns = {**columns, name: None}
            notes.append(f"Column {name} has missing values: left out.")
    return (_rows(columns, keep) if dropped else columns), faults


def put_angle_right(columns: Columns, meta: Metadata, notes: list[str]) -> Floats | None:
    """Undo a dial that wraps at 360 deg and a reversed sign.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (n,), or None
        Canonical columns, without missing values.
    meta : Metadata
        Where it gives the period of the angle, no wrap is looked for.
    notes : list of str
        What is undone is added to it.

    Returns
    -------
    ndarray of float, shape (n,), or None
        The angle [deg]; None for a load programme.
    """
    angle, torque, run = columns["angle_deg"], columns["torque_nm"], columns["run"]
    if angle is None or torque is None or run is None:
        return angle
    source = meta.columns.get("angle_deg")
    has_period = source is not None and source.modulo is not None
    if not has_period and wraps_at_360(angle, torque):
        angle, count = unwrap(angle, 360.0)
        angle = angle - 360.0 * np.rint(np.median(angle) / 360.0)
        notes.append(f"Dial wraps at 360 deg: {count} wraps undone.")
    if sign_is_reversed(torque, angle, run):
        angle = -angle
        notes.append(REVERSED)
    return angle


def _values(key: str, columns: Columns, frame: pl.DataFrame) -> NDArray[Any]:
    """Return a canonical column where there is one of that name, else the file's.

    Parameters
    ----------
    key : str
        Name of the column.
    columns : dict of str to ndarray of float, shape (rows,), or None
        Canonical columns.
    frame : polars.DataFrame
        Columns of the file, as many rows.

    Returns
    -------
    ndarray, shape (rows,)
    """
    own = columns.get(key)
    return frame[key].to_numpy() if own is None else own


def _rows(columns: Columns, keep: NDArray[np.bool_]) -> Columns:
    """Return the rows of every column that a mask keeps.

    Parameters
    ----------
    columns : dict of str to ndarray, shape (rows,), or None
        The columns.
    keep : ndarray of bool, shape (rows,)
        The mask.

    Returns
    -------
    dict of str to ndarray, shape (kept rows,), or None
    """
    return {name: None if a is None else a[keep] for name, a in columns.items()}
