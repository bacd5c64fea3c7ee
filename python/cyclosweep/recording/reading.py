"""From a file and its metadata to the parts of a recording in canonical names and units."""

import hashlib
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from numpy.typing import NDArray

from cyclosweep.errors import InputError
from cyclosweep.recording import table
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.metadata import CANONICAL_COLUMNS, Column, Metadata
from cyclosweep.recording.signals import (
    angle_lattice,
    merge_same_time,
    sign_is_reversed,
    unwrap,
    wraps_at_360,
)

Floats = NDArray[np.float64]

MISSING_SHARE = 1 / 3
"""Share of samples without a value above which a recording is faulty."""


@np.errstate(all="ignore")
def read(path: Path, meta_path: Path | None) -> dict[str, Any]:
    """Read the parts of a recording, as keyword arguments of `Recording`.

    Raises
    ------
    InputError
        The file cannot be read as a recording.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    beside = path.with_name(f"{stem(path)}.toml")
    if meta_path is None and beside.is_file() and beside != path:
        meta_path = beside
    meta = Metadata() if meta_path is None else Metadata.read(meta_path)
    sources = _sources(meta)
    frame, notes = _load(path, meta_path, meta, sources)
    columns = _canonical(path, frame, sources, notes)
    columns["unscored"] = _beyond(meta.score.abs_max, columns, frame)
    columns = _select(path, meta_path, meta, columns, frame, notes)
    if meta.merge.same_time:
        columns = _merge(path, columns, notes)
    elif columns["time_s"] is not None:
        columns = _drop_repeated(columns, notes)
    columns, faults = drop_missing(columns, notes)
    _recognise_angle(columns, meta, notes)
    run = columns.pop("run")
    assert run is not None  # _canonical makes one where the file has none
    beyond = columns.pop("unscored")
    unscored = None if beyond is None else beyond > 0.5
    if unscored is not None and unscored.any():
        notes.append(
            f"{np.count_nonzero(unscored)} of {len(unscored)} samples lie beyond the limits of "
            "[score]: simulated for what they do to the drive, neither fitted nor scored."
        )
    resolution = meta.angle_resolution_deg
    if resolution == 0 and columns["angle_deg"] is not None:
        resolution = angle_lattice(columns["angle_deg"])
        if resolution:
            notes.append(f"Angles lie on steps of {resolution:g} deg: taken as the resolution.")
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
        "history": meta.history,
        "reset_between_runs": meta.reset_between_runs,
        "conditioning_runs": tuple(meta.conditioning_runs),
        "holdout_runs": tuple(meta.holdout_runs),
        "notes": tuple(notes),
        "faults": faults,
        "sha256": _sha256(path),
    }


def stem(path: Path) -> str:
    """Name of a file without its endings .gz, .csv and the like.

    Examples
    --------
    >>> stem(Path("ramp.v2.csv.gz"))
    'ramp.v2'
    """
    return re.sub(r"(?i)(\.(csv|tsv|txt|dat|parquet|pq))?(\.gz)?$", "", path.name) or path.name


def _sources(meta: Metadata) -> dict[str, Column]:
    """File column of each canonical one; its own name where the metadata are silent."""
    return {
        name: meta.columns.get(name) or Column(column=name)  # type: ignore[call-overload]
        for name in CANONICAL_COLUMNS
    }


def _load(
    path: Path, meta_path: Path | None, meta: Metadata, sources: dict[str, Column]
) -> tuple[pl.DataFrame, list[str]]:
    """Read the file columns that are needed, all of them numbers but those selected by text."""
    if parquet := table.is_parquet(path):
        header = table.parquet_columns(path)
    else:
        text = table.open_csv(path)
        header = text.header
    found = _listed(header)
    for name, source in sources.items():
        if name in meta.columns and source.column not in header:
            raise InputError(
                f"{meta_path}, key columns.{name}: column {source.column!r} is not in {path}, "
                f"found {found}"
            )
    if sources["torque_nm"].column not in header:
        raise InputError(
            f"{path}: no column torque_nm, found {found}; name it under [columns] in "
            f"{meta_path or stem(path) + '.toml'}"
        )
    wanted = {source.column for source in sources.values() if source.column in header}
    words: set[str] = set()
    for key, values in meta.keep.items():
        column = sources[key].column if key in sources else key
        if column not in header:
            raise InputError(f"{meta_path}, key select.{key}: not a column of {path}: {found}")
        is_text = bool(values) and all(isinstance(value, str) for value in values)
        if is_text and column in wanted:
            raise InputError(f"{meta_path}, key select.{key}: found text, expected numbers")
        (words if is_text else wanted).add(column)
    for table_name, limits in (("select", meta.abs_max), ("score", meta.score.abs_max)):
        for key in limits:
            column = sources[key].column if key in sources else key
            if column not in header:
                raise InputError(
                    f"{meta_path}, key {table_name}.abs_max.{key}: not a column of {path}: {found}"
                )
            wanted.add(column)
    if both := wanted & words:
        raise InputError(f"{meta_path}, key select: {min(both)} is selected as text and as number")
    if parquet:
        return table.read_parquet(path, sorted(wanted), sorted(words)), []
    return table.read_csv(path, text, sorted(wanted), sorted(words)), list(text.notes)


def _canonical(
    path: Path, frame: pl.DataFrame, sources: dict[str, Column], notes: list[str]
) -> dict[str, Floats | None]:
    """Scale and unwrap every column; a missing run column is one run."""
    columns: dict[str, Floats | None] = {}
    for name, source in sources.items():
        if source.column not in frame.columns:
            columns[name] = None
            continue
        values = frame[source.column].to_numpy().astype(np.float64) * source.scale + source.offset
        if source.modulo is not None:
            values, count = unwrap(values, source.modulo)
            notes.append(f"{name} is known modulo {source.modulo:g}: {count} wraps undone.")
        columns[name] = values
    run = columns["run"]
    if run is None:
        columns["run"] = np.ones(frame.height)
    else:
        wrong = np.flatnonzero(~(np.isfinite(run) & (run == np.rint(run)) & (abs(run) < 2**53)))
        if len(wrong):
            raise InputError(
                f"{path}, data row {wrong[0] + 1}, column {sources['run'].column}: found "
                f"{run[wrong[0]]:g}, expected an integer"
            )
    return columns


def _beyond(
    limits: Mapping[str, float], columns: dict[str, Floats | None], frame: pl.DataFrame
) -> Floats | None:
    """One where a row does not count, zero where it does; None without limits."""
    if not limits:
        return None
    beyond = np.zeros(frame.height)
    for key, limit in limits.items():
        own = columns.get(key)
        values = frame[key].to_numpy() if own is None else own
        beyond[np.abs(values) > limit] = 1.0
    return beyond


def _select(
    path: Path,
    meta_path: Path | None,
    meta: Metadata,
    columns: dict[str, Floats | None],
    frame: pl.DataFrame,
    notes: list[str],
) -> dict[str, Floats | None]:
    """Keep the rows asked for."""
    keep = np.ones(frame.height, dtype=bool)

    def values_of(key: str) -> NDArray[Any]:
        own = columns.get(key)
        return frame[key].to_numpy() if own is None else own

    for key, allowed in meta.keep.items():
        mask = np.isin(values_of(key), np.array(allowed))
        if not mask.any() and frame.height:
            raise InputError(f"{meta_path}, key select.{key}: no row of {path} has {allowed}")
        keep &= mask
    for key, limit in meta.abs_max.items():
        keep &= np.abs(values_of(key)) <= limit
    if keep.all():
        return columns
    notes.append(f"Selection keeps {keep.sum()} of {len(keep)} rows.")
    return {name: None if a is None else a[keep] for name, a in columns.items()}


def _merge(
    path: Path, columns: dict[str, Floats | None], notes: list[str]
) -> dict[str, Floats | None]:
    """Average neighbouring rows of one run that share a clock tick."""
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


def _drop_repeated(columns: dict[str, Floats | None], notes: list[str]) -> dict[str, Floats | None]:
    """Drop rows that repeat the one before them in everything, the clock included."""
    present = [values for values in columns.values() if values is not None]
    repeated = np.logical_and.reduce([values[1:] == values[:-1] for values in present])
    if not repeated.any() or repeated.all():  # all of them: the checks say it better
        return columns
    keep = np.r_[True, ~repeated]
    notes.append(f"{np.count_nonzero(repeated)} rows that repeat the one before dropped.")
    return {name: None if a is None else a[keep] for name, a in columns.items()}


def drop_missing(
    columns: dict[str, Floats | None], notes: list[str]
) -> tuple[dict[str, Floats | None], tuple[Fault, ...]]:
    """Drop samples without a finite torque, angle or time; a sparse extra column is left out.

    More than `MISSING_SHARE` of them missing is a fault: what is left is not the test any more.
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
        text = f"{dropped} of {len(keep)} samples without a finite value dropped."
        notes.append(text)
        if dropped > MISSING_SHARE * len(keep):
            faults = (Fault("missing_values", "DATA_FAULT", text),)
    for name in ("crank_deg", "temperature_c"):
        values = columns[name]
        if values is not None and not np.isfinite(values[keep]).all():
            columns = {**columns, name: None}
            notes.append(f"Column {name} has missing values: left out.")
    if not dropped:
        return columns, faults
    return {name: None if a is None else a[keep] for name, a in columns.items()}, faults


def _recognise_angle(columns: dict[str, Floats | None], meta: Metadata, notes: list[str]) -> None:
    """Undo a dial that wraps at 360 deg and a reversed sign."""
    angle, torque, run = columns["angle_deg"], columns["torque_nm"], columns["run"]
    if angle is None or torque is None or run is None:
        return
    told = meta.columns.get("angle_deg")
    if (told is None or told.modulo is None) and wraps_at_360(angle, torque):
        angle, count = unwrap(angle, 360.0)
        angle = angle - 360.0 * np.rint(np.median(angle) / 360.0)
        notes.append(f"Dial wraps at 360 deg: {count} wraps undone.")
    if sign_is_reversed(torque, angle, run):
        angle = -angle
        notes.append("Angle falls where torque rises: its sign is reversed.")
    columns["angle_deg"] = angle


def _drive(meta: Metadata, meta_path: Path | None) -> str | None:
    """Built-in name, or the whole path of a drive file beside the metadata."""
    if meta.drive is None or meta_path is None:
        return meta.drive
    beside = meta_path.parent / meta.drive
    if beside.is_file():
        return str(beside.resolve())
    if meta.drive.endswith(".toml"):
        raise InputError(f"{meta_path}, key drive: no file {meta.drive!r} beside it")
    return meta.drive


def _listed(header: list[str]) -> str:
    """Column names for a message."""
    names = ", ".join(header[:12])
    return names if len(header) <= 12 else f"{names} and {len(header) - 12} more"


def _sha256(path: Path) -> str:
    """Hash of a file's bytes."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
