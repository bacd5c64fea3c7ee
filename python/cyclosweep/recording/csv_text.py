"""The text of a CSV file: uncompressed, in UTF-8, its header, separator and decimal sign found."""

import csv
import gzip
import zlib
from dataclasses import dataclass
from pathlib import Path

from cyclosweep.errors import InputError
from cyclosweep.recording.messages import one_line, shown

__all__ = ["CsvText", "number_in", "open_csv", "read_bytes", "to_utf8"]

MAX_BYTES = 8 * 2**30
"""Largest uncompressed text that is read [byte]."""

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
    """Return text as UTF-8 without a byte-order mark.

    Parameters
    ----------
    content : bytes
        Text in UTF-8, UTF-16 with a byte-order mark, or Latin-1.
    path : Path
        The file, for messages.

    Returns
    -------
    bytes

    Raises
    ------
    InputError
        For binary data.
    """
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


def _header_line(content: bytes, path: Path) -> tuple[int, int, int]:
    """Find the header: the first line that is not blank, a comment, or a spreadsheet's ``sep=;``.

    Parameters
    ----------
    content : bytes
        The whole text.
    path : Path
        The file, for messages.

    Returns
    -------
    start, stop : int
        Where the line begins and where the next one does [byte].
    line : int
        Its number, from 1.

    Raises
    ------
    InputError
        When there is no such line.
    """
    start = line = 0
    while start < len(content):
        line += 1
        stop = content.find(b"\n", start) + 1 or len(content)
        head = content[start:stop].strip()
        if head and not head.startswith(b"#") and not head.lower().startswith(b"sep="):
            return start, stop, line
        start = stop
    raise InputError(f"{path}: only comments, expected a header row and samples")


def number_in(cell: str) -> float | None:
    """Value of a cell, None where it is not a number."""
    if "_" in cell:
        return None
    try:
        return float(cell)
    except ValueError:
        return None


def _is_number(cell: str) -> bool:
    """Whether a header cell is a number, also with a decimal comma."""
    return number_in(cell.replace(",", ".")) is not None
