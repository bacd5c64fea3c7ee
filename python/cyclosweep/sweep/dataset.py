"""A study on disk: Parquet parts, each with its origin in the footer, and a manifest of them."""

from __future__ import annotations

import contextlib
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import polars as pl
from filelock import FileLock, Timeout

import cyclosweep._core as _core
from cyclosweep.atomic import unfinished, write_text
from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError, path_of
from cyclosweep.sweep.kernel_columns import stretch_arrays
from cyclosweep.sweep.part_file import write_arrays, write_rows
from cyclosweep.sweep.rows import frame
from cyclosweep.sweep.study import Study
from cyclosweep.sweep.summary import PartSummary, leaders_of_part, summary_of_part

__all__ = [
    "ROWS_PER_PART",
    "SOLVED_ROWS_PER_PART",
    "Dataset",
    "Part",
    "dataset_of",
    "read_manifest",
    "scan_dataset",
]

ROWS_PER_PART = 2**18
SOLVED_ROWS_PER_PART = 2**14
"""Variants a part whose equilibria are solved: some seconds' work."""
_FOOTER = "cyclosweep"
_FORMAT = "cyclosweep.dataset/1"
_MANIFEST = "_manifest.json"
_FORMER_MANIFEST = "manifest.json"  # no underscore: read as a part by other programs
_UNFINISHED = "*part-*.tmp"  # of today with a leading dot, of former versions without
_LOCKS = ".part-*.lock"
_PART_NAME = re.compile(r"part-(\d+)\.parquet")


@dataclass(frozen=True)
class Part:
    """One file of a dataset.

    Attributes
    ----------
    index : int
        Its number.
    start, stop : int
        Variants it holds.
    """

    index: int
    start: int
    stop: int

    @property
    def stem(self) -> str:
        """Name of the file without its ending."""
        return f"part-{self.index:06d}"

    @property
    def name(self) -> str:
        """Name of the file."""
        return f"{self.stem}.parquet"


@dataclass(frozen=True)
class Dataset:
    """A folder that holds, or will hold, one study.

    Attributes
    ----------
    study : Study
        What is in it.
    folder : Path
        Where it is.
    rows_per_part : int
        Variants a part; with the study it decides every part's boundaries.
    """

    study: Study
    folder: Path
    rows_per_part: int = ROWS_PER_PART

    @property
    def part_count(self) -> int:
        """Number of parts of the finished dataset."""
        return -(-len(self.study) // self.rows_per_part)

    def part(self, index: int) -> Part:
        """Return part number ``index``."""
        start = self.study.space.start + index * self.rows_per_part
        return Part(index, start, min(start + self.rows_per_part, self.study.space.stop))

    def parts(self) -> Iterator[Part]:
        """All parts in order."""
        return (self.part(index) for index in range(self.part_count))

    def present(self) -> list[Part]:
        """Parts of which there is a file, whole or not, in order."""
        names = (path.name for path in self.folder.glob("part-*.parquet"))
        numbers = {int(match[1]) for name in names if (match := _PART_NAME.fullmatch(name))}
        return [self.part(number) for number in sorted(numbers) if number < self.part_count]

    def prepare(self, *, resume: bool, fresh: bool) -> None:
        """Make the folder ready, or refuse it before anything in it is touched.

        Parameters
        ----------
        resume : bool
            Keep what is whole.
        fresh : bool
            Delete what an earlier sweep left, whatever its study.

        Raises
        ------
        InputError
            When the folder holds another study, or this one and neither flag is given.
        """
        self.check(resume=resume, fresh=fresh)
        self.folder.mkdir(parents=True, exist_ok=True)
        if fresh:
            for path in [*self._found(), *self.folder.glob(_UNFINISHED)]:
                path.unlink(missing_ok=True)
        if read_manifest(self.folder) is None:
            self.write_manifest([])

    def check(self, *, resume: bool, fresh: bool) -> None:
        """Refuse a folder that :meth:`prepare` would refuse, and touch nothing."""
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"{self.folder}: is a file, expected a folder")
        found = self._found()
        parts = [path for path in found if path.suffix == ".parquet"]
        if foreign := next(filter(_is_foreign, parts), None):
            raise InputError(f"{foreign}: not written by cyclosweep, expected an empty folder")
        if fresh:
            return
        if found and not resume:
            raise InputError(f"{self.folder}: holds a study, expected an empty folder")
        self._refuse_another_study(parts)

    def _found(self) -> list[Path]:
        """Parts, whole or not, and manifests that are there."""
        manifests = (self.folder / name for name in (_MANIFEST, _FORMER_MANIFEST))
        parts = sorted(self.folder.glob("part-*.parquet"))
        return [*parts, *filter(Path.exists, manifests)]

    def _refuse_another_study(self, found: list[Path]) -> None:
        # Broken files are passed over; the first whole part stands for the others.
        footer = next(filter(None, map(read_footer, found)), None)
        for identity in filter(None, [read_manifest(self.folder), footer]):
            if identity.get("study") != self.study.hash:
                self._refuse_another_stretch(identity)
                raise InputError(
                    f"{self.folder}: holds another study, expected this one or an empty folder; "
                    "--fresh deletes what is there"
                )
            if identity.get("rows_per_part") != self.rows_per_part:
                raise InputError(
                    f"{self.folder}: parts of {identity.get('rows_per_part')} variants, "
                    f"expected {self.rows_per_part}; --fresh deletes what is there"
                )

    def _refuse_another_stretch(self, identity: dict[str, Any]) -> None:
        """Refuse a folder that holds other variants of the same study, as `--rows` makes them."""
        there, here = identity.get("definition"), self.study.definition()
        whole = {"start": 0, "stop": 0}
        if not isinstance(there, dict) or {**there, **whole} != {**here, **whole}:
            return
        held, asked = (
            f"{each.get('start', 0):,} to {each.get('stop', 0) - 1:,}" for each in (there, here)
        )
        raise InputError(
            f"{self.folder}: holds variants {held} of this study, found {asked} asked for; "
            "expected the same, another folder, or --fresh, which deletes what is there"
        )

    def is_whole(self, part: Part) -> bool:
        """Whether a part is there and belongs to this study."""
        return self.summary(part) is not None

    def summary(self, part: Part) -> PartSummary | None:
        """Read the summary in a part's footer; None unless the part is whole and of this study."""
        footer = read_footer(self.folder / part.name)
        if footer is None or footer.get("study") != self.study.hash:
            return None
        summary = PartSummary.from_json(footer["record"])
        if (summary.start, summary.stop) != (part.start, part.stop):
            return None
        if footer.get("objectives") != self._objectives():
            # Another objective changes no numbers, only which variants are best.
            rows = pl.read_parquet(self.folder / part.name)
            return replace(summary, leaders=leaders_of_part(rows, self.study))
        return summary

    @contextlib.contextmanager
    def lock(self, part_stem: str, timeout: float = -1) -> Iterator[None]:
        """Keep other writers from a part; the lock ends with its process.

        Raises
        ------
        filelock.Timeout
            When another writer holds it for longer than ``timeout`` [s].
        """
        path = self.folder / f".{part_stem}.lock"
        with FileLock(path, timeout=timeout):
            try:
                yield
            finally:
                path.unlink(missing_ok=True)

    def write(self, part: Part) -> PartSummary:
        """Compute a part and put it in place, whole or not at all.

        Parameters
        ----------
        part : Part
            Which one.

        Returns
        -------
        PartSummary
            A summary of its rows, small enough to be sent between processes.

        Raises
        ------
        OSError
            When it cannot be written; nothing is left behind.
        """
        study, names = self.study, self.study.computed()
        arrays, results = None, None
        if study.is_extended or study.only_ok:
            rows = frame(study, part.start, part.stop, names)
        else:
            arrays = stretch_arrays(study, names, part.start, part.stop)
            rows, results = pl.DataFrame(arrays.series(names)), arrays.reals()
        summary = summary_of_part(rows, part.start, part.stop, study, results)
        footer = self._footer(summary)
        with unfinished(self.folder / part.name) as file:
            if arrays is None:
                write_rows(study.select(rows), file, footer, ROWS_PER_PART)
            else:
                write_arrays(arrays, study.select(rows), file, footer, ROWS_PER_PART)
        return summary

    def _footer(self, summary: PartSummary) -> dict[str, str]:
        """What stands in a part's footer, as text under the package's key."""
        objectives, record = self._objectives(), summary.to_json()
        footer = {**self._identity(), "objectives": objectives, "record": record}
        return {_FOOTER: json.dumps(footer)}

    def _identity(self) -> dict[str, Any]:
        return {
            "format": _FORMAT,
            "study": self.study.hash,
            "version": _core.__version__,
            "rows_per_part": self.rows_per_part,
            "columns": self._units(),
        }

    def _units(self) -> dict[str, dict[str, str]]:
        units = self.study.units()
        return {name: units[name] for name in self.study.given()}

    def _objectives(self) -> list[list[str | bool]]:
        return [[each.column, each.maximise] for each in self.study.objectives]

    def summaries(self) -> list[PartSummary]:
        """Return the summaries of all whole parts, in order."""
        return [summary for part in self.present() if (summary := self.summary(part)) is not None]

    def finish(self, summaries: list[PartSummary]) -> None:
        """Write the manifest of the parts that are there and delete what killed writers left."""
        # A writer killed just after a part was in place leaves its lock.
        for path in [*self.folder.glob(_UNFINISHED), *self.folder.glob(_LOCKS)]:
            stem = path.name.lstrip(".").split(".")[0]
            with contextlib.suppress(Timeout), self.lock(stem, timeout=0):
                path.unlink(missing_ok=True)
        self.write_manifest(summaries)

    def write_manifest(self, summaries: list[PartSummary]) -> None:
        """Write the manifest of the parts with these summaries."""
        rows = sum(summary.stop - summary.start for summary in summaries)
        manifest = {
            **self._identity(),
            "definition": self.study.definition(),
            "drive": json.loads(self.study.space.drive.to_json()),
            "objective": next(iter(self._objectives()), None),
            "objectives": self._objectives(),
            "variants": len(self.study),
            "rows": rows,
            "complete": rows == len(self.study),
            "parts": [
                {"file": self.part(k).name, "start": r.start, "stop": r.stop}
                for k, r in sorted(
                    ((r.start - self.study.space.start) // self.rows_per_part, r) for r in summaries
                )
            ],
        }
        write_text(self.folder / _MANIFEST, json.dumps(manifest, indent=1))
        (self.folder / _FORMER_MANIFEST).unlink(missing_ok=True)


def dataset_of(study: Study, folder: str | Path, rows_per_part: int | None = None) -> Dataset:
    """Return the dataset of a study in a folder, which need not exist.

    Parameters
    ----------
    study : Study
        What is in it.
    folder : str or Path
        Where it is.
    rows_per_part : int, optional
        Variants a part, by default what a thread computes in seconds.

    Returns
    -------
    Dataset
    """
    if rows_per_part is None:
        rows_per_part = ROWS_PER_PART if study.model == "published" else SOLVED_ROWS_PER_PART
    return Dataset(
        study, path_of("folder", folder), whole_number("rows_per_part", rows_per_part, least=1)
    )


def read_footer(path: Path) -> dict[str, Any] | None:
    """Read what cyclosweep wrote into a Parquet footer; None for a broken or foreign file."""
    try:
        text = pl.read_parquet_metadata(path).get(_FOOTER)
        footer = json.loads(text) if text is not None else None
    except (OSError, ValueError, pl.exceptions.PolarsError):
        return None
    return footer if isinstance(footer, dict) and footer.get("format") == _FORMAT else None


def read_manifest(folder: Path) -> dict[str, Any] | None:
    """Read a study's manifest, also under its former name; None where it is missing or broken."""
    for name in (_MANIFEST, _FORMER_MANIFEST):
        with contextlib.suppress(OSError, ValueError):
            manifest = json.loads((folder / name).read_text(encoding="utf-8"))
            if isinstance(manifest, dict):
                return manifest
    return None


def _is_foreign(path: Path) -> bool:
    """Whether a file is whole and not of a sweep, so that it must not be touched."""
    try:
        return _FOOTER not in pl.read_parquet_metadata(path)
    except (OSError, pl.exceptions.PolarsError):
        return False


def parts_of(folder: Path) -> list[Path]:
    """All whole parts in a folder, in order of their variants."""
    found = sorted(folder.glob("part-*.parquet"), key=lambda path: (len(path.name), path))
    return [path for path in found if read_footer(path) is not None]


def scan_dataset(folder: str | Path) -> pl.LazyFrame:
    """Read a finished or unfinished study lazily.

    Parameters
    ----------
    folder : str or Path
        Where a sweep was written.

    Returns
    -------
    polars.LazyFrame
        Rows of all whole parts, in order of their variants.

    Raises
    ------
    InputError
        When the folder holds no part of a study.
    """
    paths = parts_of(path_of("folder", folder))
    if not paths:
        raise InputError(f"{folder}: no parts of a study there")
    return pl.scan_parquet(paths)
