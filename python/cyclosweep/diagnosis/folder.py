"""Diagnosis of every recording of a folder, in parallel and resumable, with a table across them."""

import hashlib
import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import polars as pl

import cyclosweep._core as _core
from cyclosweep import plugins
from cyclosweep.atomic import unfinished, write_text
from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import whole_number
from cyclosweep.diagnosis.diagnose import diagnose
from cyclosweep.diagnosis.inputs import check_options, considered_effects
from cyclosweep.diagnosis.series import (
    Row,
    columns_of,
    conditions_of,
    row_of,
    small_loops_of,
    trends,
)
from cyclosweep.diagnosis.series_steps import own_order, steps_in_common, steps_kept, steps_of
from cyclosweep.display import Steps, shown_steps
from cyclosweep.errors import (
    DesignError,
    InputError,
    instance_of,
    one_of,
    path_of,
    refuse_no_file,
)
from cyclosweep.recording import Recording
from cyclosweep.recording.columns import metadata_path, stem
from cyclosweep.recording.endings import ENDINGS, is_recording_name
from cyclosweep.recording.metadata import Metadata
from cyclosweep.report.series_page import write_series_page
from cyclosweep.result.series import StepsInCommon, Trend
from cyclosweep.simulation.effects import effects

_LOG = logging.getLogger(__name__)

OPTIONS = ("tolerance_deg", "seed", "without")
"""Arguments of a diagnosis that those of a folder share, beside ``full``."""
OF_A_SERIES = ("table.csv", "table.parquet", "index.html")
"""Files that compare the recordings of a folder."""
ROW_FILE = "row.json"
"""File of a finished recording's row, with the hash of all that it was made from."""


@dataclass(frozen=True, kw_only=True)
class Series:
    """Diagnoses of the recordings of a folder.

    Attributes
    ----------
    table : polars.DataFrame
        A row for each recording: its conditions, verdict, effects and sizes with 95 % intervals;
        where there is no diagnosis, ``status`` is ``"failed"`` and ``reason`` says why.
    conditions : tuple of str
        Columns of the table that the metadata name.
    trends : tuple of Trend
        What rises or falls with which condition.
    steps : StepsInCommon or None
        Order that the steps of the torque share; None where fewer than two recordings have any.
    """

    table: pl.DataFrame
    conditions: tuple[str, ...] = ()
    trends: tuple[Trend, ...] = field(default=())
    steps: StepsInCommon | None = None

    @property
    def failed(self) -> int:
        """Number of recordings without a diagnosis."""
        return int((self.table["status"] != "ok").sum())


def recordings_in(folder: str | Path) -> list[Path]:
    """List the recordings of a folder, by name; tables that a series left there are none.

    Raises
    ------
    InputError
        There is none.
    """
    folder = path_of("recordings", folder)
    if not folder.is_dir():
        raise InputError(f"{folder}: no such folder, expected recordings in it")
    own = OF_A_SERIES if all((folder / name).is_file() for name in OF_A_SERIES) else ()
    found = sorted(
        path
        for path in folder.iterdir()
        if is_recording_name(path.name) and path.is_file() and path.name not in own
    )
    if not found:
        endings = ", ".join(f".{ending}" for ending in sorted(ENDINGS))
        raise InputError(f"{folder}: found no recording, expected files that end in {endings}")
    return found


def _listed(recordings: Sequence[Path]) -> list[Path]:
    """Recordings that a caller lists; InputError for none, and for what is no list of paths."""
    instance_of("recordings", recordings, Sequence)
    if not recordings:
        raise InputError("recordings: found none, expected a folder or at least one file")
    return [path_of("recordings", path) for path in recordings]


def _check_options(drive: Drive | None, full: bool, options: Mapping[str, Any]) -> None:
    """Refuse what :func:`cyclosweep.diagnose` would refuse of every recording.

    Parameters
    ----------
    drive : Drive or None
        The drive of all recordings.
    full : bool
        Whether the diagnoses are whole.
    options : mapping of str to object
        Further keyword arguments of the diagnosis.

    Raises
    ------
    InputError
        For an argument that it does not have, or a value that it does not take.
    """
    for name in options:
        one_of("option", name, OPTIONS)
    if drive is not None:
        instance_of("drive", drive, Drive)
    check_options(options.get("tolerance_deg"), options.get("seed", 0), full)
    considered_effects(options.get("without", ()))


def refuse_same_names(paths: Sequence[Path]) -> None:
    """Refuse recordings whose results would be written into one folder.

    Raises
    ------
    InputError
        With two of them.
    """
    by_name: dict[str, Path] = {}
    for path in paths:
        other = by_name.setdefault(stem(path), path)
        if other is not path:
            raise InputError(
                f"recordings: found {other} and {path}, expected names that differ, as each has a "
                "folder of its name in DIR"
            )


def diagnose_folder(
    recordings: str | Path | Sequence[Path],
    out: str | Path,
    *,
    drive: Drive | None = None,
    meta: str | Path | None = None,
    workers: int = 1,
    resume: bool = True,
    full: bool = True,
    progress: Steps = None,
    **options: Any,
) -> Series:
    """Diagnose every recording of a folder and compare them.

    Each is written into a folder of its name in `out`, as soon as it is done; the table across
    them is ``table.csv``, ``table.parquet`` and ``index.html``. A recording that cannot be
    diagnosed keeps its row, with the reason.

    Parameters
    ----------
    recordings : path or sequence of paths
        A folder, or the recordings themselves.
    out : path
        Folder of the results.
    drive : Drive, optional
        The drive; default: the one in the metadata.
    meta : path, optional
        How to read the files; default: the TOML file beside each.
    workers : int
        Processes that work at the same time.
    resume : bool
        Whether to keep results in `out` that were made from the same recording, metadata, drive,
        options and version.
    full : bool
        False leaves out report, held-out proof, self-check and next experiment.
    progress : bool or callable, optional
        True shows the recording that was done last; a callable is called with a line for each.
    **options
        Further keyword arguments of :func:`cyclosweep.diagnose`.

    Returns
    -------
    Series

    Raises
    ------
    InputError
        There is no recording, two share a name, `workers` is below one, or an option is none that
        :func:`cyclosweep.diagnose` takes. Nothing is written then.
    """
    workers = whole_number("workers", workers, least=1)
    _check_options(drive, full, options)
    if isinstance(recordings, (str, Path)):
        paths = recordings_in(recordings)
    else:
        paths = _listed(recordings)
    refuse_same_names(paths)
    target = path_of("out", out)
    target.mkdir(parents=True, exist_ok=True)
    task = _Task(
        drive,
        None if meta is None else path_of("meta", meta),
        target,
        resume,
        full,
        options,
        tuple(plugins.LOADED),
    )
    rows: dict[Path, Row] = {}
    with shown_steps(f"{len(paths)} recordings", progress, _LOG) as say:
        for path, row in _rows(paths, task, workers):
            rows[path] = row
            said = row["verdict"] if row["status"] == "ok" else row["reason"]
            say(f"{len(rows)} of {len(paths)}: {stem(path)}: {said}")
    _LOG.info("%d recordings diagnosed, written to %s", len(rows), target)
    ordered = [rows[path] for path in paths]
    named = {name for path in paths for name in _condition_names(path, task.meta)}
    done = [str(row["recording"]) for row in ordered if row["status"] == "ok"]
    kept = steps_kept({name: target / name / ROW_FILE for name in done})
    steps = steps_in_common(kept, options.get("seed", 0))
    series = _series(ordered, named, options.get("seed", 0), steps)
    _write(series, target)
    return series


@dataclass(frozen=True)
class _Task:
    """What all recordings of a folder have in common; it travels to the workers."""

    drive: Drive | None
    meta: Path | None
    out: Path
    resume: bool
    full: bool
    options: dict[str, Any]
    plugins: tuple[str, ...] = ()


def _rows(paths: Sequence[Path], task: _Task, workers: int) -> Iterator[tuple[Path, Row]]:
    """Rows of the recordings as they are done."""
    if workers == 1 or len(paths) == 1:
        for path in paths:
            yield path, _row(path, task)
        return
    with ProcessPoolExecutor(
        max(1, min(workers, len(paths))), mp_context=get_context("spawn")
    ) as pool:
        waiting = {pool.submit(_row, path, task): path for path in paths}
        try:
            for done in as_completed(waiting):
                yield waiting[done], done.result()
        except BaseException:
            pool.shutdown(cancel_futures=True, wait=False)
            raise


def _row(path: Path, task: _Task) -> Row:
    """Diagnose one recording, write its results and return its row; every failure is a row."""
    row: Row = {"recording": stem(path)}
    for module in task.plugins:  # a worker has not loaded them yet
        plugins.load(module)
    try:
        refuse_no_file(path)
        meta = _metadata(path, task.meta)
        row |= conditions_of(stem(path), meta)
        folder = task.out / stem(path)
        key = _key(path, task, meta)
        kept = _kept(folder, key) if task.resume else None
        if kept is not None:
            return kept
        recording: Recording = Recording.read(path, task.meta)
        found = diagnose(recording, task.drive, full=task.full, **task.options)
        found.write(folder, report=task.full)
        row |= row_of(found) | small_loops_of(path, meta, metadata_path(path, task.meta))
        content = {"key": key, "row": row, "steps": steps_of(found)}
        write_text(folder / ROW_FILE, json.dumps(content))
    except Exception as error:  # one bad file must not stop the others
        named = str(error)
        if not isinstance(error, (InputError, DesignError)):
            _LOG.exception("%s: no diagnosis", path)
            named = f"{type(error).__name__}: {error}"
        row |= {"status": "failed", "verdict": None, "reason": " ".join(named.split())}
    return row


def _metadata(path: Path, meta: Path | None) -> Metadata:
    """Metadata of a recording."""
    file = metadata_path(path, meta)
    return Metadata() if file is None else Metadata.read(file)


def _condition_names(path: Path, meta: Path | None) -> list[str]:
    """Conditions that a recording has; none where it cannot be read."""
    try:
        return list(conditions_of(stem(path), _metadata(path, meta)))
    except InputError:
        return []


def _key(path: Path, task: _Task, meta: Metadata) -> str:
    """Hash of all that a result depends on."""
    digest = hashlib.sha256(path.read_bytes())
    file = metadata_path(path, task.meta)
    if file is not None:
        digest.update(file.read_bytes())
        beside = None if meta.drive is None else file.parent / meta.drive
        if beside is not None and beside.is_file():
            digest.update(beside.read_bytes())
    drive = None if task.drive is None else task.drive.to_json()
    considered = [effect.name for effect in effects()]
    said = (drive, task.full, sorted(task.options.items()), considered, _core.__version__)
    digest.update(repr(said).encode())
    return digest.hexdigest()


def _kept(folder: Path, key: str) -> Row | None:
    """Row of an earlier diagnosis of the same things; None where there is none."""
    try:
        kept = json.loads((folder / ROW_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    # A file without steps is of a version that did not look for them.
    same = isinstance(kept, dict) and kept.get("key") == key and "steps" in kept
    whole = same and (folder / "diagnosis.json").is_file()
    return dict(kept["row"]) if whole else None


def _series(rows: list[Row], named: set[str], seed: int, steps: StepsInCommon | None) -> Series:
    """Table and trends of all rows.

    Parameters
    ----------
    rows : list of dict
        One a recording.
    named : set of str
        Columns that are conditions.
    seed : int
        Seed of the random orders by which the trends are judged.
    steps : StepsInCommon or None
        Order that the steps share.

    Returns
    -------
    Series
    """
    rows = [row | own_order(steps, str(row["recording"])) for row in rows]
    names = columns_of(rows)
    conditions = tuple(name for name in names if name in named)
    varied = [name for name in conditions if len({row.get(name) for row in rows}) > 1]
    if len({row.get("mean_temperature_c") for row in rows}) > 2:
        varied.append("mean_temperature_c")
    table = pl.DataFrame({name: [row.get(name) for row in rows] for name in names}, strict=False)
    found = tuple(trends(rows, varied, seed))
    return Series(table=table, conditions=conditions, trends=found, steps=steps)


def _write(series: Series, out: Path) -> None:
    """Write the table and its page, each whole or not at all."""
    csv, parquet, page = (out / name for name in OF_A_SERIES)
    write_text(csv, series.table.write_csv())
    with unfinished(parquet) as file:
        series.table.write_parquet(file)
    rows = series.table.to_dicts()
    write_series_page(page, rows, series.conditions, series.trends, series.steps)
