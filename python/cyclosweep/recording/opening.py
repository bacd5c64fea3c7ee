"""Which format a file has, told by its first bytes, and the table in it."""

import zipfile
from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.recording import table
from cyclosweep.recording.csv_text import CsvText, open_csv, read_bytes, to_utf8
from cyclosweep.recording.endings import WORKBOOKS
from cyclosweep.recording.file_table import FileTable, GridTable
from cyclosweep.recording.formats.excel import read_excel
from cyclosweep.recording.formats.json_text import read_json
from cyclosweep.recording.formats.labview import read_lvm
from cyclosweep.recording.formats.matlab import read_hdf5, read_mat5
from cyclosweep.recording.formats.tdms import read_tdms
from cyclosweep.recording.metadata import TableOptions
from cyclosweep.recording.repeated_names import without_repeated_names

__all__ = ["open_table"]


@dataclass(slots=True)
class _CsvTable:
    """Table of a text; see `FileTable`."""

    path: Path
    text: CsvText

    @property
    def header(self) -> list[str]:
        """Names of the columns."""
        return self.text.header

    @property
    def units(self) -> dict[str, str]:
        """Units in a row of their own."""
        return self.text.units

    @property
    def notes(self) -> list[str]:
        """What was recognised."""
        return self.text.notes

    def read(self, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
        """Return the named columns as Float64 and String."""
        return table.read_csv(self.path, self.text, numbers, words)

    def passing_over(self, texts: Iterable[str]) -> FileTable:
        """Return the same table, in which these texts stand for missing values."""
        return _CsvTable(self.path, replace(self.text, missing=(*self.text.missing, *texts)))


@dataclass(slots=True)
class _ParquetTable:
    """Table of a Parquet file; see `FileTable`."""

    path: Path
    header: list[str]
    units: dict[str, str]
    notes: list[str]

    def read(self, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
        """Return the named columns as Float64 and String."""
        return table.read_parquet(self.path, list(numbers), list(words))

    def passing_over(self, texts: Iterable[str]) -> FileTable:
        """Return the same table: its columns of numbers hold no text."""
        return self


def open_table(path: Path, options: TableOptions, wanted: Collection[str]) -> FileTable:
    """Find the format of a file and the table in it.

    Parameters
    ----------
    path : Path
        The file.
    options : TableOptions
        What the metadata say about the table.
    wanted : collection of str
        Names of columns that the metadata give.

    Returns
    -------
    FileTable

    Raises
    ------
    InputError
        The file cannot be read, or has no table.
    """
    found = _open(path, options, wanted)
    # Of a text it is known from the options; a table in memory is told here.
    return found.passing_over(options.missing) if isinstance(found, GridTable) else found


def _refuse_idle(path: Path, options: TableOptions, *useful: str) -> None:
    """Refuse options that a format has no use for, as a sheet of a text.

    Parameters
    ----------
    path : Path
        The file.
    options : TableOptions
        What the metadata say about the table.
    *useful : str
        Those that are of use.

    Raises
    ------
    InputError
        With the key.
    """
    lacks = {"sheet": "has no sheets", "header_row": "names its columns itself"}
    for key, why in lacks.items():
        found = getattr(options, key)
        if found is not None and key not in useful:
            raise InputError(
                f"{path}, key table.{key}: found {found!r}, but this file {why}; leave it out"
            )


def _open(path: Path, options: TableOptions, wanted: Collection[str]) -> FileTable:
    """Open a file by its format.

    Parameters
    ----------
    path, options, wanted
        As for `open_table`.

    Returns
    -------
    FileTable
    """
    ending = path.suffix.lower().removeprefix(".")
    try:
        with path.open("rb") as file:
            head = file.read(64)
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    if table.is_parquet(path):
        _refuse_idle(path, options)
        return _ParquetTable(path, table.parquet_columns(path), {}, [])
    zipped = head.startswith(b"PK\x03\x04") and zipfile.is_zipfile(path)
    if ending in WORKBOOKS or zipped or head.startswith(b"\xd0\xcf\x11\xe0"):
        return read_excel(path, options, wanted)
    is_tree = head.startswith((b"\x89HDF\r\n\x1a\n", b"MATLAB", b"TDSm"))
    if is_tree or ending in {"mat", "tdms"}:
        _refuse_idle(path, options, "sheet")
    if head.startswith((b"\x89HDF\r\n\x1a\n", b"MATLAB 7.3")):
        return read_hdf5(path, options)
    if head.startswith(b"MATLAB 5.0") or ending == "mat":
        return read_mat5(path, options)
    if head.startswith(b"TDSm") or ending == "tdms":
        return read_tdms(path, options)
    if not head:
        read_bytes(path)  # says that the file is empty
    return _text_table(path, ending, options, wanted)


def _text_table(
    path: Path, ending: str, options: TableOptions, wanted: Collection[str]
) -> FileTable:
    """Open a text, compressed or not.

    Parameters
    ----------
    path : Path
        The file.
    ending : str
        Of its name, without the dot.
    options, wanted
        As for `open_table`.

    Returns
    -------
    FileTable
    """
    content = to_utf8(read_bytes(path), path)
    start = content[:64].lstrip()
    if start.startswith(b"LabVIEW Measurement"):
        _refuse_idle(path, options)
        return read_lvm(path, content, options.missing)
    if ending in {"json", "jsonl"} or (start[:1] in b"{[" and start[1:].lstrip()[:1] in b'"{['):
        _refuse_idle(path, options, "sheet")
        return read_json(path, content, options)
    _refuse_idle(path, options, "header_row")
    text = open_csv(content, path, options, wanted)
    return _CsvTable(path, without_repeated_names(text))
