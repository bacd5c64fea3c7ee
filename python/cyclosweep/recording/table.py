"""From a file to a table of numbers: CSV (also gzip, byte-order mark, decimal commas), Parquet."""

import csv
import gzip
import io
import zlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.recording.messages import one_line, shown

MAX_BYTES = 8 * 2**30
"""Largest uncompressed text that is read [byte]."""

MISSING = ["", "NA", "N/A", "na", "n/a", "null", "None", "-", "--", "#N/A"]
"""Cell contents that stand for a value that is not there."""

_CHUNK = 1 << 22
_SEPARATORS = ",;\t|"


@dataclass(frozen=True, slots=True)
class CsvText:
    """Text of a CSV file and how its cells are divided.

    Attributes
    ----------
    content : bytes
        UTF-8 without a byte-order mark.
    separator : str
        Character between cells.
    decimal_comma : bool
        Whether numbers are written 1,5.
    start : int
        Where the rows below the header begin [byte].
    line : int
        Line number of the header.
    header : list of str
        Column names without surrounding blanks.
    notes : list of str
        What was recognised.
    """

    content: bytes
    start: int
    line: int
    separator: str
    decimal_comma: bool
    header: list[str]
    notes: list[str]


def is_parquet(path: Path) -> bool:
    """Tell Parquet by its name or its first bytes."""
    if path.suffix.lower() in {".parquet", ".pq"}:
        return True
    with path.open("rb") as file:
        return file.read(4) == b"PAR1"


def read_bytes(path: Path) -> bytes:
    """Content of a file, uncompressed where it is gzip.

    Raises
    ------
    InputError
        The file is missing, empty, a truncated or damaged gzip, or too large.
    """
    try:
        with path.open("rb") as file:
            packed = file.read(2) == b"\x1f\x8b"
        with gzip.open(path) if packed else path.open("rb") as stream:
            chunks: list[bytes] = []
            size = 0
            while chunk := stream.read(_CHUNK):
                chunks.append(chunk)
                size += len(chunk)
                if size > MAX_BYTES:
                    raise InputError(f"{path}: larger than {MAX_BYTES // 2**30} GiB uncompressed")
    except EOFError:
        raise InputError(f"{path}: truncated gzip: the file ends before its data do") from None
    except (gzip.BadGzipFile, zlib.error) as error:
        raise InputError(f"{path}: damaged gzip ({one_line(str(error))})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from None
    content = b"".join(chunks)
    if not content.strip():
        raise InputError(f"{path}: empty file, expected a header row and samples")
    return content


def to_utf8(content: bytes, path: Path) -> bytes:
    """Text as UTF-8 without a byte-order mark."""
    for mark, encoding in ((b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16")):
        if content.startswith(mark):
            try:
                return content.decode(encoding).encode()
            except UnicodeDecodeError:
                raise InputError(f"{path}: UTF-16 byte-order mark, but not UTF-16 text") from None
    content = content.removeprefix(b"\xef\xbb\xbf")
    if b"\0" in content[:_CHUNK]:
        raise InputError(f"{path}: binary data, expected a CSV or Parquet file")
    head = content[:_CHUNK]
    try:
        head.decode()
    except UnicodeDecodeError as error:
        if error.start < len(head) - 4:  # not merely cut in the middle of a character
            return content.decode("latin-1").encode()
    return content


def open_csv(path: Path) -> CsvText:
    """Read a CSV file and find its header, separator and decimal sign.

    Raises
    ------
    InputError
        The file cannot be read, has no header row, or has one column.
    """
    content = to_utf8(read_bytes(path), path)
    if b"\n" not in content:
        content = content.replace(b"\r", b"\n")
    start, stop, line = _header_line(content, path)
    head = content[start:stop].decode("utf-8", "replace").strip("\r\n")
    separator = max(_SEPARATORS, key=head.count)
    if separator not in head and head.strip().strip('"') != "torque_nm":  # a programme's least
        raise InputError(
            f"{path}, line {line}: one column ({shown(head)}), expected at least torque_nm and "
            "angle_deg divided by ',' or ';'"
        )
    try:
        names = [name.strip() for name in next(csv.reader([head], delimiter=separator))]
    except csv.Error as error:
        raise InputError(
            f"{path}, line {line}: unreadable header ({one_line(str(error))})"
        ) from None
    if all(_is_number(name) or not name for name in names):
        raise InputError(
            f"{path}, line {line}: found numbers ({shown(head)}), expected a header row with "
            "column names such as torque_nm,angle_deg"
        )
    decimal_comma = separator != "," and b"," in content[stop : stop + 10_000]
    notes = [f"Cells divided by '{separator}', decimal commas."] if decimal_comma else []
    return CsvText(content, stop, line, separator, decimal_comma, names, notes)


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
    try:
        return _parse(text, kinds)
    except pl.exceptions.NoDataError:
        return pl.DataFrame(schema=kinds)
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException):
        return _parse_slowly(path, text, kinds)


def _parse(text: CsvText, kinds: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Hand the cells to polars under plain names, which the header's own may not be."""
    places = {name: f"c{text.header.index(name)}" for name in kinds}
    header = text.separator.join(f"c{i}" for i in range(len(text.header))).encode() + b"\n"
    frame = pl.read_csv(
        io.BytesIO(header + text.content[text.start :]),
        separator=text.separator,
        decimal_comma=text.decimal_comma,
        comment_prefix="#",
        columns=list(places.values()),
        schema_overrides={place: kinds[name] for name, place in places.items()},
        infer_schema=False,
        null_values=MISSING,
        encoding="utf8-lossy",
        truncate_ragged_lines=True,  # only empty cells are left beyond the header's
    )
    return frame.select(pl.col(place).alias(name) for name, place in places.items()).filter(
        ~pl.all_horizontal(pl.all().is_null())
    )


def _parse_slowly(path: Path, text: CsvText, kinds: Mapping[str, pl.DataType]) -> pl.DataFrame:
    """Parse row by row: blanks around numbers are allowed, the first bad cell is named."""
    columns: dict[str, list[float | str | None]] = {name: [] for name in kinds}
    places = {name: text.header.index(name) for name in kinds}
    for line, cells in _rows(path, text):
        for name, place in places.items():
            cell = cells[place].strip() if place < len(cells) else ""
            if cell in MISSING:
                columns[name].append(None)
            elif kinds[name] == pl.String:
                columns[name].append(cell)
            else:
                number = _number(cell.replace(",", ".") if text.decimal_comma else cell)
                if number is None:
                    raise InputError(
                        f"{path}, line {line}, column {name}: found {shown(cell)}, "
                        "expected a number"
                    )
                columns[name].append(number)
    frame = pl.DataFrame(columns, schema=dict(kinds))
    return frame.filter(~pl.all_horizontal(pl.all().is_null()))


def _refuse_long_rows(path: Path, text: CsvText) -> None:
    """Refuse rows with more cells than the header, as decimal commas between commas make them."""
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
    """Rows of cells with the line number on which each ends, without comments and blank lines."""
    stream = io.TextIOWrapper(io.BytesIO(text.content), encoding="utf-8", errors="replace")
    for _ in range(text.line):
        next(stream)
    reader = csv.reader(
        (line if not line.startswith("#") else "\n" for line in stream), delimiter=text.separator
    )
    try:
        for cells in reader:
            if cells:
                yield text.line + reader.line_num, cells
    except csv.Error as error:
        line = text.line + reader.line_num
        raise InputError(f"{path}, line {line}: unreadable ({one_line(str(error))})") from None


def _header_line(content: bytes, path: Path) -> tuple[int, int, int]:
    """Start, end and number of the header: not blank, a comment, or a spreadsheet's ``sep=;``."""
    start = line = 0
    while start < len(content):
        line += 1
        stop = content.find(b"\n", start) + 1 or len(content)
        head = content[start:stop].strip()
        if head and not head.startswith(b"#") and not head.lower().startswith(b"sep="):
            return start, stop, line
        start = stop
    raise InputError(f"{path}: only comments, expected a header row and samples")


def _number(cell: str) -> float | None:
    """Value of a cell, None where it is not a number."""
    if "_" in cell:
        return None
    try:
        return float(cell)
    except ValueError:
        return None


def _is_number(cell: str) -> bool:
    """Whether a header cell is a number, also with a decimal comma."""
    return _number(cell.replace(",", ".")) is not None


def read_parquet(path: Path, numbers: Iterable[str], words: Iterable[str]) -> pl.DataFrame:
    """Read the named columns of a Parquet file.

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
        if not (kind.is_numeric() or kind == pl.Null):
            raise InputError(f"{path}, column {name}: found type {kind}, expected numbers")
    return frame.with_columns(
        *(pl.col(name).cast(pl.Float64) for name in numbers),
        *(pl.col(name).cast(pl.String) for name in words),
    )


def parquet_columns(path: Path) -> list[str]:
    """Column names of a Parquet file."""
    try:
        return list(pl.read_parquet_schema(path))
    except (pl.exceptions.PolarsError, pl.exceptions.PanicException, OSError) as error:
        raise InputError(f"{path}: not a readable Parquet file ({_first_line(error)})") from None


def _first_line(error: BaseException) -> str:
    """First line of a foreign message."""
    return one_line(str(error).partition("\n")[0])[:120]
