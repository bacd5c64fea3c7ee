"""Tables as files that other programs read and write: CSV, Excel and Parquet."""

from __future__ import annotations

import csv
import gzip
import importlib
import io
from pathlib import Path
from typing import Any

import polars as pl

from cyclosweep.atomic import unfinished, write_bytes
from cyclosweep.errors import InputError

__all__ = [
    "MOST_EXCEL_ROWS",
    "is_table_name",
    "read_filled_rows",
    "read_table",
    "row_in_file",
    "writable",
    "write_table",
]

MOST_EXCEL_ROWS = 2**20 - 1
"""Rows of an Excel sheet below its header."""

_PARQUET = (".parquet", ".pq")
_READ_AS_WORKBOOK = (".xlsx", ".xlsm", ".xlsb", ".xls", ".ods")
_TEXT = (".csv", ".tsv", ".txt", ".csv.gz")
_WRITTEN = (".csv", ".xlsx", ".parquet")
_SEPARATORS = ",;\t"


def is_table_name(path: str | Path) -> bool:
    """Whether a file's name has an ending that :func:`read_table` reads."""
    return _ending(Path(path)) in (*_PARQUET, *_READ_AS_WORKBOOK, *_TEXT)


def read_table(path: str | Path, *, keep_blank_rows: bool = False) -> pl.DataFrame:
    """Read a table from a CSV, Excel or Parquet file.

    Parameters
    ----------
    path : str or Path
        ``.csv``, ``.tsv`` or ``.txt``, also compressed as ``.csv.gz``; ``.xlsx``, ``.xls``,
        ``.xlsb`` or ``.ods``, of which the first sheet is read; or ``.parquet``.
    keep_blank_rows : bool
        Keep rows without a filled cell, so that :func:`row_in_file` counts right.

    Returns
    -------
    polars.DataFrame
        Of a text file or workbook a column is numeric where every filled cell is a number, else
        text; empty cells are null. Columns may be separated by comma, semicolon or tab; with the
        latter two a number may have a decimal comma. A text such as ``0012`` stays one.

    Raises
    ------
    InputError
        One line that names the file and what is wrong with it.
    """
    path = Path(path)
    ending = _ending(path)
    if not is_table_name(path):
        raise InputError(f"{path}: found {ending or 'no ending'}, expected .csv, .xlsx or .parquet")
    try:
        if ending in _PARQUET:
            return pl.read_parquet(path)
        text = _workbook(path) if ending in _READ_AS_WORKBOOK else _text(path)
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or error}") from None
    except pl.exceptions.PolarsError as error:
        raise InputError(f"{path}: not a table: {str(error).splitlines()[0]}") from None
    if not keep_blank_rows:
        text = text.filter(~pl.all_horizontal(pl.all().is_null()))
    return text.select(_typed(column) for column in text.get_columns())


def read_filled_rows(path: str | Path) -> tuple[pl.DataFrame, list[int]]:
    """Read a table, and where each of its rows stands in the file.

    Parameters
    ----------
    path : str or Path
        As for :func:`read_table`.

    Returns
    -------
    polars.DataFrame
        Without rows that have no filled cell.
    list of int
        Its rows as they count in the file, see :func:`row_in_file`.

    Raises
    ------
    InputError
        As for :func:`read_table`.
    """
    table = read_table(path, keep_blank_rows=True)
    filled = ~table.select(pl.all_horizontal(pl.all().is_null())).to_series()
    return table.filter(filled), (filled.arg_true() + row_in_file(path, 0)).to_list()


def write_table(frame: pl.DataFrame, path: str | Path) -> None:
    """Write a table as CSV, Excel or Parquet, whole or not at all.

    Parameters
    ----------
    frame : polars.DataFrame
        The table.
    path : str or Path
        ``.csv``, ``.xlsx`` (numbers to 16 digits) or ``.parquet``.

    Raises
    ------
    InputError
        For another ending, or more rows than an Excel sheet holds.
    OSError
        When it cannot be written; what was there before is left as it was.
    """
    ending = writable(path)
    if ending == ".xlsx" and frame.height > MOST_EXCEL_ROWS:
        raise InputError(
            f"{path}: found {frame.height:,} rows, expected at most {MOST_EXCEL_ROWS:,} for Excel; "
            "use .parquet or .csv"
        )
    words = [name for name, dtype in frame.schema.items() if isinstance(dtype, pl.Enum)]
    if ending != ".parquet":
        frame = frame.with_columns(pl.col(words).cast(pl.String))
    if ending == ".xlsx":
        import xlsxwriter  # type: ignore[import-untyped]

        sheet = io.BytesIO()
        # As many digits as a number has, not the three that polars would show; no files beside it.
        with xlsxwriter.Workbook(sheet, {"in_memory": True}) as book:
            frame.write_excel(book, dtype_formats={pl.Float64: "General"}, autofit=True)
        write_bytes(path, sheet.getvalue())
        return
    with unfinished(path) as temporary:
        if ending == ".parquet":
            frame.write_parquet(temporary)
        else:
            frame.write_csv(temporary)


def writable(path: str | Path) -> str:
    """Ending of a table's file; refuse one that :func:`write_table` cannot write.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    str
        ``.csv``, ``.xlsx`` or ``.parquet``.

    Raises
    ------
    InputError
        For another ending, or a package that Excel files need and that is not installed.
    """
    ending = _ending(Path(path))
    if ending not in _WRITTEN:
        raise InputError(f"{path}: found {ending or 'no ending'}, expected .csv, .xlsx or .parquet")
    if ending == ".xlsx":
        _needs("xlsxwriter", Path(path))
    return ending


def row_in_file(path: str | Path, index: int) -> int:
    """Row of a file, counted from 1, in which a row of its table stands.

    Parameters
    ----------
    path : str or Path
        The file.
    index : int
        Row of the table, counted from 0.

    Returns
    -------
    int
        For text and workbooks the header is row 1.
    """
    return index + (1 if _ending(Path(path)) in _PARQUET else 2)


def _ending(path: Path) -> str:
    name = path.name.lower()
    return ".csv.gz" if name.endswith(".csv.gz") else Path(name).suffix


def _needs(module: str, path: Path) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        raise InputError(
            f"{path}: Excel files need a package that is not installed: "
            "pip install 'cyclosweep[tables]', or use .csv or .parquet"
        ) from None


def _decoded(content: bytes) -> str:
    """Text of a file in UTF-8 or UTF-16, or in the Windows encoding that Excel may write."""
    if content.startswith((b"\xff\xfe", b"\xfe\xff")):
        return content.decode("utf-16")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _text(path: Path) -> pl.DataFrame:
    """Cells of a text file as text."""
    content = path.read_bytes()
    try:
        content = gzip.decompress(content) if content.startswith(b"\x1f\x8b") else content
        text = _decoded(content)
    except (EOFError, gzip.BadGzipFile, UnicodeDecodeError):
        raise InputError(f"{path}: damaged, expected a table as text") from None
    first = text.lstrip("\r\n").partition("\n")[0].rstrip("\r")
    if not first.strip():
        raise InputError(f"{path}: empty, expected a table with a header")
    separator = max(_SEPARATORS, key=first.count)
    rows = csv.reader(io.StringIO(text), delimiter=separator)
    names = next(row for row in rows if row)
    _refuse_repeated(path, names)
    for row in rows:
        if len(row) != len(names) and "".join(row).strip():
            raise InputError(
                f"{path}, row {rows.line_num}: found {len(row)} cells, expected {len(names)}"
            )
    cells = pl.read_csv(text.encode(), separator=separator, infer_schema=False)
    cells = cells.with_columns(pl.all().str.strip_chars().replace("", None))
    if separator == ",":
        return cells
    decimal_comma = pl.all().str.replace(r"^([+-]?\d*),(\d+([eE][+-]?\d+)?)$", "$1.$2")
    return cells.with_columns(decimal_comma)


def _workbook(path: Path) -> pl.DataFrame:
    """Cells of a workbook's first sheet as text."""
    if not path.exists():
        raise InputError(f"{path}: No such file or directory")
    calamine = _needs("python_calamine", path)
    try:
        with calamine.CalamineWorkbook.from_path(str(path)) as book:
            rows = book.get_sheet_by_index(0).to_python(skip_empty_area=False)
    except Exception as error:  # calamine has an exception for each format
        raise InputError(f"{path}: not a workbook ({str(error).splitlines()[0]})") from None
    if not rows:
        raise InputError(f"{path}: empty, expected a table with a header in row 1")
    names = [str(cell).strip() for cell in rows[0]]
    _refuse_repeated(path, names)
    columns = {
        name: [_cell(row[place]) for row in rows[1:]] for place, name in enumerate(names) if name
    }
    if not columns:
        raise InputError(f"{path}: row 1 is empty, expected a header")
    return pl.DataFrame(columns, schema=dict.fromkeys(columns, pl.String()))


def _cell(value: object) -> str | None:
    text = repr(value) if isinstance(value, float) else str(value).strip()
    return text or None


def _refuse_repeated(path: Path, names: list[str]) -> None:
    for place, name in enumerate(names):
        if name and name in names[:place]:
            raise InputError(f"{path}: found the column {name} twice, expected each once")


def _typed(cells: pl.Series) -> pl.Series:
    """Cells as numbers where every filled one is a number."""
    if cells.null_count() == len(cells) or cells.str.contains(r"^[+-]?0\d").any():
        return cells
    numbers = cells.cast(pl.Float64, strict=False)
    if numbers.null_count() != cells.null_count():
        return cells
    if cells.str.contains(r"^[+-]?\d{1,15}(\.0)?$").all():
        return numbers.cast(pl.Int64)
    return numbers
