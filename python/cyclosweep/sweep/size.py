"""How large a study will be on disk and how long it takes, from a few of its variants."""

from __future__ import annotations

import io
import os
import shutil
import time
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from cyclosweep.atomic import nearest_existing
from cyclosweep.sweep.dataset import dataset_of
from cyclosweep.sweep.part_file import COMPRESSION
from cyclosweep.sweep.rows import frame
from cyclosweep.sweep.study import Study

__all__ = ["Estimate", "estimate", "rows_left"]

_PLACES = 4
"""Places of the study where some variants are computed: its ends need not be alike."""
_ROWS = 1024
"""Variants computed at each place."""
_SOLVED_ROWS = 512
"""The same where equilibria are solved, up to a millisecond each: so many that what a table costs
by itself, some ten milliseconds and kilobytes, does not count."""


@dataclass(frozen=True)
class Estimate:
    """Size of what a sweep has still to do.

    Attributes
    ----------
    rows : int
        Variants.
    needed_bytes, free_bytes : int
        On disk.
    seconds : float
        With one process on this machine.
    """

    rows: int
    needed_bytes: int
    free_bytes: int
    seconds: float

    @property
    def fits(self) -> bool:
        """Whether the disk has room for it."""
        return self.needed_bytes <= self.free_bytes

    def __str__(self) -> str:
        return (
            f"{self.rows:,} variants, about {_bytes(self.needed_bytes)} and "
            f"{_duration(self.seconds)}; {_bytes(self.free_bytes)} free"
        )


def estimate(study: Study, folder: str | Path, rows: int | None = None) -> Estimate:
    """Estimate what a sweep needs.

    Parameters
    ----------
    study : Study
        What is swept.
    folder : str or Path
        Where it goes; it need not exist.
    rows : int, optional
        Variants that are still to be computed; all by default.

    Returns
    -------
    Estimate
        From the size and time of some variants. Time is for two threads, as :func:`cyclosweep.sink`
        uses, without what else the machine does.
    """
    first, last = study.space.start, study.space.stop
    count = last - first
    at_once = min(_ROWS if study.model == "published" else _SOLVED_ROWS, count)
    places = sorted({first + (count - at_once) * k // (_PLACES - 1) for k in range(_PLACES)})
    columns = study.computed()
    frame(study, first, first + min(1, count), columns)  # tables are made once
    began = time.perf_counter()
    tables = [study.select(frame(study, at, at + at_once, columns)) for at in places]
    file = io.BytesIO()
    pl.concat(tables).write_parquet(file, compression=COMPRESSION)
    seconds = (time.perf_counter() - began) / max(len(places) * at_once, 1)
    share = file.tell() / max(len(places) * at_once, 1)
    left = count if rows is None else rows
    threads = min(2, os.cpu_count() or 1)
    return Estimate(left, round(left * share), _free_bytes(Path(folder)), left * seconds / threads)


def rows_left(study: Study, folder: str | Path) -> int:
    """Variants of a study of which a folder has no whole part yet.

    Parameters
    ----------
    study : Study
        What is swept.
    folder : str or Path
        Where it goes; it need not exist.

    Returns
    -------
    int
    """
    dataset = dataset_of(study, folder)
    space = study.space
    whole = filter(dataset.is_whole, dataset.present())
    return space.stop - space.start - sum(part.stop - part.start for part in whole)


def _free_bytes(folder: Path) -> int:
    return shutil.disk_usage(nearest_existing(folder)).free


def _bytes(count: float) -> str:
    for unit in ("B", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:,.3g} EB"


def _duration(seconds: float) -> str:
    for unit, length in (("years", 3.156e7), ("days", 86400.0), ("hours", 3600.0), ("min", 60.0)):
        if seconds >= 1.5 * length:
            return f"{seconds / length:,.3g} {unit}"
    return f"{max(seconds, 0.1):.2g} s"
