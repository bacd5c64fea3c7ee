"""From a file to a table of numbers: the cells of a CSV file, the columns of a Parquet file."""

import csv
import io
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import (
    MISSING,
    BadCellError,
    is_number,
    spelt_number,
)
from cyclosweep.recording.clocks import clock_seconds, is_clock
from cyclosweep.recording.csv_text import CsvText, thousands_in, without_thousands
from cyclosweep.recording.messages import one_line


def is_parquet(path: Path) -> bool:
    """Tell Parquet by its name or its first bytes."""
    if path.suffix.lower() in {".parquet", ".pq"}:
        return True
    with path.open("rb") as file:
        return file.read(4) == b"PAR1"


def read_csv(
    path: Path, text: CsvText, numbers: Iterable[str], words: Iterable[str]
) -> pl.DataFrame:
    """Parse the named columns; the first bad cell is named with its line and column.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.
    numbers, words : iterable of str
        Columns to read as numbers and as text.

    Returns
    -------
    polars.DataFrame
        The named columns, Float64 and String, without rows that are empty in all of them.

    Raises
    ------
    InputError
        A cell holds text where a number belongs, or a row has more cells than the header.
    """
    kinds: dict[str, pl.DataType] = dict.fromkeys(numbers, pl.Float64())
    kinds |= dict.fromkeys(words, pl.String())
    for name in kinds:
        if text.header.count(name) > 1:
            raise InputError(f"{path}, line {text.line}: column {name} appears more than once")
    _refuse_long_rows(path, text)
    clocks = _clocks(path, text, [name for name, kind in kinds.items() if kind == pl.Float64])
    kinds |= dict.fromkeys(clocks, pl.String())
    return _clocks_read(path, text, _frame(path, text, kinds), clocks)


def _frame(path: Path, text: CsvText, kinds: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Parse cells fast, and where that fails row by row.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.
    kinds : mapping of str to polars.DataType
        Type of each column wanted.

    Returns
    -------
    polars.DataFrame
    """
    words = any(kind == pl.String for kind in kinds.values())
    try:
        if not text.thousands:
            return _parse(text, kinds)
        # A time may hold the same signs, and a separator stands between cells, too.
        if not words and text.thousands != text.separator:
            return _parse(without_thousands(text), kinds)
    except pl.exceptions.NoDataError:
        return pl.DataFrame(schema=dict(kinds))
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException):
        if not text.thousands and (sign := thousands_in(text)):
            return _frame(path, replace(text, thousands=sign), kinds)
    return _parse_slowly(path, text, kinds)


def _clocks(path: Path, text: CsvText, names: Iterable[str]) -> list[str]:
    """Find the columns of numbers whose first value is a date or a time of day.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.
    names : iterable of str
        Columns to look at.

    Returns
    -------
    list of str
    """
    clocks, left = [], {name: text.header.index(name) for name in names}
    for count, (_, cells) in enumerate(_rows(path, text)):
        for name, place in list(left.items()):
            cell = cells[place].strip() if place < len(cells) else ""
            if cell not in MISSING and cell not in text.missing:
                del left[name]
                if is_clock(cell) and not is_number(cell):
                    clocks.append(name)
        if not left or count > 100:
            break
    return clocks


def _clocks_read(
    path: Path, text: CsvText, frame: pl.DataFrame, clocks: Iterable[str]
) -> pl.DataFrame:
    """Turn columns of dates or times into seconds since the first.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned; a note is added to its notes.
    frame : polars.DataFrame
        What was read, times as text.
    clocks : iterable of str
        Columns of times.

    Returns
    -------
    polars.DataFrame

    Raises
    ------
    InputError
        For a cell that is no time.
    """
    for name in clocks:
        cells = frame[name].to_list()
        seconds, note = clock_seconds(cells, f"{path}, data row", 1, name, text.missing)
        text.notes.append(note)
        frame = frame.with_columns(pl.Series(name, seconds))
    return frame


def _parse(text: CsvText, kinds: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Hand the cells to polars under plain names, which the header's own may not be.

    Parameters
    ----------
    text : CsvText
        What `open_csv` returned.
    kinds : mapping of str to polars.DataType
        Type of each column wanted.

    Returns
    -------
    polars.DataFrame
    """
    places = {name: f"c{text.header.index(name)}" for name in kinds}
    header = text.separator.join(f"c{i}" for i in range(len(text.header))).encode() + b"\n"
    frame = pl.read_csv(
        io.BytesIO(header + text.content[text.start :]),
        separator=text.separator,
        decimal_comma=text.decimal == ",",
        comment_prefix="#",
        columns=list(places.values()),
        schema_overrides={place: kinds[name] for name, place in places.items()},
        infer_schema=False,
        null_values=[*MISSING, *text.missing],
        encoding="utf8-lossy",
        truncate_ragged_lines=True,  # only empty cells are left beyond the header's
    )
    return frame.select(pl.col(place).alias(name) for name, place in places.items()).filter(
        ~pl.all_horizontal(pl.all().is_null())
    )


def _parse_slowly(path: Path, text: CsvText, kinds: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Parse row by row: blanks around numbers are allowed, the first bad cell is named.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.
    kinds : mapping of str to polars.DataType
        Type of each column wanted.

    Returns
    -------
    polars.DataFrame

    Raises
    ------
    InputError
        For a cell that holds text where a number belongs.
    """
    columns: dict[str, list[float | str | None]] = {name: [] for name in kinds}
    places = {name: text.header.index(name) for name in kinds}
    missing = {*MISSING, *text.missing}
    for line, cells in _rows(path, text):
        for name, place in places.items():
            cell = cells[place].strip() if place < len(cells) else ""
            if cell in missing:
                columns[name].append(None)
            elif kinds[name] == pl.String:
                columns[name].append(cell)
            else:
                number = _number(cell, text)
                if number is None:
                    raise BadCellError(f"{path}, line {line}, column {name}", cell)
                columns[name].append(number)
    frame = pl.DataFrame(columns, schema=dict(kinds))
    return frame.filter(~pl.all_horizontal(pl.all().is_null()))


def _number(cell: str, text: CsvText) -> float | None:
    """Value of a cell as the file spells numbers; without thousands also with a decimal point.

    Parameters
    ----------
    cell : str
        The cell.
    text : CsvText
        What `open_csv` returned.

    Returns
    -------
    float or None
        None where it is no number.
    """
    if not text.thousands and "." in cell and "," not in cell:
        return spelt_number(cell, ".", "")
    return spelt_number(cell, text.decimal, text.thousands)


def _refuse_long_rows(path: Path, text: CsvText) -> None:
    """Refuse rows with more cells than the header, as decimal commas between commas make them.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.

    Raises
    ------
    InputError
        With the line and both numbers of cells.
    """
    count = text.content.count(text.separator.encode(), text.start)
    lines = text.content.count(b"\n", text.start) + (not text.content.endswith(b"\n"))
    if count == lines * (len(text.header) - 1):
        return
    for line, cells in _rows(path, text):
        if any(cell.strip() for cell in cells[len(text.header) :]):
            raise InputError(
                f"{path}, line {line}: found {len(cells)} cells, expected {len(text.header)} as in "
                "the header"
            )


def _rows(path: Path, text: CsvText) -> Iterator[tuple[int, list[str]]]:
    """Go through the rows below the header, without comments and blank lines.

    Parameters
    ----------
    path : Path
        For messages.
    text : CsvText
        What `open_csv` returned.

    Yields
    ------
    int, list of str
        Number of the line on which the row ends, and its cells.

    Raises
    ------
    InputError
        Where the text cannot be divided into cells.
    """
    stream = io.TextIOWrapper(io.BytesIO(text.content), encoding="utf-8", errors="replace")
    for _ in range(text.body_line):
        next(stream)
    reader = csv.reader(
        (line if not line.startswith("#") else "\n" for line in stream), delimiter=text.separator
    )
    try:
        for cells in reader:
            if cells:
                yield text.body_line + reader.line_num, cells
    except csv.Error as error:
        line = text.body_line + reader.line_num
        raise InputError(f"{path}, line {line}: unreadable ({one_line(str(error))})") from None


def read_parquet(path: Path, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
    """Read the named columns of a Parquet file.

    Parameters
    ----------
    path : Path
        The file.
    numbers, words : iterable of str
        Columns to read as numbers and as text.

    Returns
    -------
    polars.DataFrame
        The named columns, Float64 and String.

    Raises
    ------
    InputError
        The file is damaged, or a column is not of the expected kind.
    """
    try:
        frame = pl.read_parquet(path, columns=[*numbers, *words], use_pyarrow=False)
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise InputError(f"{path}: not a readable Parquet file ({_first_line(error)})") from None
    for name in numbers:
        kind = frame.schema[name]
        if kind.is_temporal():
            frame = frame.with_columns(_seconds(frame[name]))
            continue
        if not (kind.is_numeric() or kind == pl.Null):
            raise InputError(f"{path}, column {name}: found type {kind}, expected numbers")
    return frame.with_columns(
        *(pl.col(name).cast(pl.Float64) for name in numbers),
        *(pl.col(name).cast(pl.String) for name in words),
    )


def _seconds(times: pl.Series) -> pl.Series:
    """Seconds since the first of dates, times or durations."""
    if times.dtype == pl.Duration:
        return times.dt.total_nanoseconds() * 1e-9
    if times.dtype == pl.Time:
        return times.cast(pl.Int64) * 1e-9
    instants = times.cast(pl.Datetime("ns")).cast(pl.Int64)
    return (instants - instants.drop_nulls()[:1].sum()) * 1e-9


def parquet_columns(path: Path) -> list[str]:
    """Column names of a Parquet file."""
    try:
        return list(pl.read_parquet_schema(path))
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise InputError(f"{path}: not a readable Parquet file ({_first_line(error)})") from None


def _first_line(error: BaseException) -> str:
    """First line of a foreign message."""
    return one_line(str(error).partition("\n")[0])[:120]
