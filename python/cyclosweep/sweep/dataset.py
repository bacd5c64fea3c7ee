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
from cyclosweep.atomic import nearest_existing, unfinished, write_text
from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError, path_of
from cyclosweep.sweep.dataset_files import (
    FOOTER,
    FORMAT,
    FORMER_MANIFEST,
    MANIFEST,
    is_foreign,
    read_footer,
    read_manifest,
    scan_dataset,
)
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
    "read_footer",
    "scan_dataset",
]

ROWS_PER_PART = 2**18
SOLVED_ROWS_PER_PART = 2**14
"""Variants a part whose equilibria are solved: some seconds' work."""
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
        nearest = nearest_existing(self.folder)
        if not nearest.is_dir():
            raise InputError(f"{nearest}: is a file, expected a folder")
        found = self._found()
        parts = [path for path in found if path.suffix == ".parquet"]
        if foreign := next(filter(is_foreign, found), None):
            raise InputError(f"{foreign}: not written by cyclosweep, expected an empty folder")
        # Broken files are passed over; the first whole part stands for the others.
        footer = next(filter(None, map(read_footer, parts)), None)
        identities = list(filter(None, [read_manifest(self.folder), footer]))
        if parts and not identities:
            raise InputError(
                f"{parts[0]}: cannot be read, and no manifest tells that a sweep has written it; "
                "expected an empty folder"
            )
        if fresh:
            return
        if found and not resume:
            raise InputError(f"{self.folder}: holds a study, expected an empty folder")
        self._refuse_another_study(identities)

    def _found(self) -> list[Path]:
        """Parts, whole or not, and manifests that are there."""
        manifests = (self.folder / name for name in (MANIFEST, FORMER_MANIFEST))
        parts = sorted(self.folder.glob("part-*.parquet"))
        return [*parts, *filter(Path.exists, manifests)]

    def _refuse_another_study(self, identities: list[dict[str, Any]]) -> None:
        for identity in identities:
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
        return self._own_footer(part) is not None

    def _own_footer(self, part: Part) -> dict[str, Any] | None:
        footer = read_footer(self.folder / part.name)
        if footer is None or footer.get("study") != self.study.hash:
            return None
        record = footer["record"]
        return footer if (record["start"], record["stop"]) == (part.start, part.stop) else None

    def summary(self, part: Part) -> PartSummary | None:
        """Read the summary in a part's footer; None unless the part is whole and of this study."""
        footer = self._own_footer(part)
        if footer is None:
            return None
        summary = PartSummary.from_json(footer["record"])
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
        return {FOOTER: json.dumps(footer)}

    def _identity(self) -> dict[str, Any]:
        return {
            "format": FORMAT,
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
        write_text(self.folder / MANIFEST, json.dumps(manifest, indent=1))
        (self.folder / FORMER_MANIFEST).unlink(missing_ok=True)


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
