"""A file as a table of named columns, whatever its format."""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import polars as pl

from cyclosweep.recording.cells import (
    MISSING,
    BadCellError,
    is_number,
    spelt_number,
)
from cyclosweep.recording.clocks import clock_seconds, is_clock
from cyclosweep.recording.samples import Floats

__all__ = ["FileTable", "GridTable", "spelling"]


class FileTable(Protocol):
    """What every format gives.

    Attributes
    ----------
    header : list of str
        Names of the columns.
    units : dict of str to str
        Units that the file states apart from the names, by column.
    notes : list of str
        What was recognised.
    """

    @property
    def header(self) -> list[str]:
        """Names of the columns."""

    @property
    def units(self) -> dict[str, str]:
        """Units that the file states apart from the names."""

    @property
    def notes(self) -> list[str]:
        """What was recognised."""

    def read(self, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
        """Return the named columns as Float64 and String."""
        ...

    def passing_over(self, texts: Iterable[str]) -> "FileTable":
        """Return the same table, in which these texts stand for missing values."""
        ...


@dataclass(slots=True)
class GridTable:
    """Columns in memory, as workbooks, MATLAB, TDMS and JSON files give them.

    Attributes
    ----------
    path : Path
        The file, for messages.
    columns : dict of str to array or list
        Values by name, all of one length.
    units : dict of str to str
        Units that the file states apart from the names.
    notes : list of str
        What was recognised.
    first_row : int
        Row of the file in which the first value stands, for messages.
    decimal, thousands : str
        Spelling of numbers that are text.
    missing : tuple of str
        Texts besides the usual ones that stand for a value that is not there.
    """

    path: Path
    columns: dict[str, Any]
    units: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    first_row: int = 1
    decimal: str = "."
    thousands: str = ""
    missing: tuple[str, ...] = ()

    @property
    def header(self) -> list[str]:
        """Names of the columns."""
        return list(self.columns)

    def read(self, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
        """Return the named columns as Float64 and String.

        Parameters
        ----------
        numbers, words : iterable of str
            Columns to read as numbers and as text.

        Returns
        -------
        polars.DataFrame

        Raises
        ------
        InputError
            A cell holds text where a number belongs.
        """
        found: dict[str, Any] = {name: self._numbers(name) for name in numbers}
        for name in words:
            found[name] = [None if v is None else str(v) for v in self.columns[name]]
        kinds = dict.fromkeys(numbers, pl.Float64()) | dict.fromkeys(words, pl.String())
        frame = pl.DataFrame(found, schema=kinds, strict=False)
        empty = pl.all_horizontal(pl.all().is_null())
        floats = [pl.col(n).is_nan() | pl.col(n).is_null() for n in numbers]
        if floats and not words:
            empty = pl.all_horizontal(floats)
        return frame.filter(~empty)

    def passing_over(self, texts: Iterable[str]) -> "GridTable":
        """Return the same table, in which these texts stand for missing values."""
        return replace(self, missing=(*self.missing, *texts))

    def _numbers(self, name: str) -> Floats:
        """Values of a column as numbers; times become seconds since the first."""
        values = self.columns[name]
        if isinstance(values, np.ndarray) and values.dtype.kind in "fiub":
            return values.astype(np.float64)
        if isinstance(values, np.ndarray) and values.dtype.kind == "M":
            since = (values - values[:1]) / np.timedelta64(1, "ns") * 1e-9
            self.notes.append(f"{name} holds dates: seconds since the first are taken.")
            return np.asarray(since, dtype=np.float64)
        cells = list(values)
        first = next((cell for cell in cells if not self._is_missing(cell)), None)
        if is_clock(first):
            return self._seconds(name, cells)
        out = np.full(len(cells), np.nan)
        for place, cell in enumerate(cells):
            if self._is_missing(cell):
                continue
            if isinstance(cell, bool | int | float | np.number | np.bool_):
                out[place] = float(cell)
                continue
            number = spelt_number(str(cell), self.decimal, self.thousands)
            if number is None:
                where = f"{self.path}, row {self.first_row + place}, column {name}"
                raise BadCellError(where, str(cell))
            out[place] = number
        return out

    def _seconds(self, name: str, cells: list[Any]) -> Floats:
        """Times of a column as seconds since the first, with a note."""
        where = f"{self.path}, row"
        seconds, note = clock_seconds(cells, where, self.first_row, name, self.missing)
        self.notes.append(note)
        return seconds

    def _is_missing(self, cell: object) -> bool:
        """Whether a cell stands for a value that is not there."""
        if not isinstance(cell, str):
            return cell is None
        return cell.strip() in MISSING or cell.strip() in self.missing


def spelling(cells: Iterable[str]) -> tuple[str, str]:
    """Tell decimal sign and thousands separator from cells that hold numbers.

    Parameters
    ----------
    cells : iterable of str
        Cells of the table.

    Returns
    -------
    decimal, thousands : str
        ``("," , ".")`` for 1.362,820; thousands empty where none are used.
    """
    decimal, thousands = ".", ""
    for cell in cells:
        text = cell.strip()
        if not is_number(text):
            continue
        comma, dot = text.rfind(","), text.rfind(".")
        if comma >= 0 and dot >= 0:
            return (",", ".") if comma > dot else (".", ",")
        if text.count(",") > 1:
            thousands = ","
        elif comma >= 0:
            decimal = ","
        if text.count(".") > 1:
            decimal, thousands = ",", "."
        for sign in "'’  ":
            if sign in text:
                thousands = sign
    return decimal, thousands
