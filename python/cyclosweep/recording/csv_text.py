"""The text of a CSV file: uncompressed, in UTF-8, its header, separator and decimal sign found."""

import csv
import gzip
import re
import zlib
from collections.abc import Collection
from dataclasses import dataclass, replace
from pathlib import Path

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import MINUS, is_number
from cyclosweep.recording.digit_groups import told_apart
from cyclosweep.recording.file_table import spelling
from cyclosweep.recording.messages import one_line, shown
from cyclosweep.recording.metadata import TableOptions
from cyclosweep.recording.text_table import SEPARATORS, TextTable, find_text_table

__all__ = [
    "CsvText",
    "open_csv",
    "read_bytes",
    "thousands_in",
    "to_utf8",
    "without_thousands",
]

MAX_BYTES = 8 * 2**30
"""Largest uncompressed text that is read [byte]."""

_CHUNK = 1 << 22


@dataclass(frozen=True, slots=True)
class CsvText:
    """Text of a CSV file and how its cells are divided.

    Attributes
    ----------
    content : bytes
        UTF-8 without a byte-order mark.
    separator : str
        Character between cells.
    decimal : str
        Decimal sign.
    thousands : str
        Sign between groups of three digits; empty: none.
    start : int
        Where the rows below the header begin [byte].
    line : int
        Line number of the header.
    body_line : int
        Number of the last line above the rows.
    header : list of str
        Column names without surrounding blanks.
    units : dict of str to str
        Units in a row of their own, by column.
    notes : list of str
        What was recognised.
    missing : tuple of str
        Texts besides the usual ones that stand for a value that is not there.
    """

    content: bytes
    start: int
    line: int
    body_line: int
    separator: str
    decimal: str
    thousands: str
    header: list[str]
    units: dict[str, str]
    notes: list[str]
    missing: tuple[str, ...] = ()


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
        raise InputError(
            f"{path}: binary data, expected text (CSV, LabVIEW, JSON), Parquet, Excel, MATLAB or "
            "TDMS; export the table as CSV"
        )
    head = content[:_CHUNK]
    try:
        head.decode()
    except UnicodeDecodeError as error:
        if error.start < len(head) - 4:  # not merely cut in the middle of a character
            return content.decode("latin-1").encode()
    return content


def open_csv(content: bytes, path: Path, options: TableOptions, wanted: Collection[str]) -> CsvText:
    """Find header, separator and decimal sign of the text of a CSV file.

    Parameters
    ----------
    content : bytes
        The text in UTF-8, from `to_utf8`.
    path : Path
        The file.
    options : TableOptions
        What the metadata say about the table.
    wanted : collection of str
        Names of columns that the metadata give.

    Returns
    -------
    CsvText

    Raises
    ------
    InputError
        It has no header row, or one column.
    """
    if b"\n" not in content:
        content = content.replace(b"\r", b"\n")
    if MINUS.encode() in content:
        content = re.sub(MINUS.encode() + rb"(?=[\d.,])", b"-", content)
    start, stop, line = _header_line(content, path)
    head = content[start:stop].decode("utf-8", "replace").strip("\r\n")
    separator = max(SEPARATORS, key=head.count)
    place = find_text_table(content, options.header_row, wanted)
    if options.header_row is not None:
        if place is None:
            raise _no_names(content, path, options.header_row)
        return _placed(content, place, options)
    if place is not None and (place.line != line or place.body_line != line or place.blanks):
        return _placed(content, place, options)
    if len(head.split()) > 1 and all(is_number(cell) for cell in head.split()):
        raise InputError(
            f"{path}, line {line}: found numbers ({shown(head)}), expected a header row with "
            "column names such as torque_nm angle_deg"
        )
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
    if all(is_number(name) or not name for name in names):
        raise InputError(
            f"{path}, line {line}: found numbers ({shown(head)}), expected a header row with "
            "column names such as torque_nm,angle_deg"
        )
    decimal_comma = separator != "," and b"," in content[stop : stop + 10_000]
    notes = [_decimal_commas(separator)] if decimal_comma else []
    decimal, thousands = ("," if decimal_comma else "."), ""
    text = CsvText(content, stop, line, line, separator, decimal, thousands, names, {}, notes)
    return _spelt(text, options)


def _no_names(content: bytes, path: Path, row: int) -> InputError:
    """Say that no names stand in the line that the user gives.

    Parameters
    ----------
    content : bytes
        The whole text.
    path : Path
        The file, for the message.
    row : int
        The line, from 1.

    Returns
    -------
    InputError
    """
    lines = content.rstrip().split(b"\n")
    if row > len(lines):
        found = f"{row} in a text of {len(lines)} lines"
    else:
        found = f"{shown(lines[row - 1].decode('utf-8', 'replace').strip())} in line {row}"
    return InputError(
        f"{path}, key table.header_row: found {found}, expected the names of columns above rows of "
        "numbers"
    )


def _placed(content: bytes, place: TextTable, options: TableOptions) -> CsvText:
    """Text whose table does not begin with its first line.

    Parameters
    ----------
    content : bytes
        The whole text.
    place : TextTable
        Where the table stands.
    options : TableOptions
        What the metadata say about the table.

    Returns
    -------
    CsvText
    """
    notes = []
    if place.above:
        notes.append(f"Names of the columns found in line {place.line}.")
    if place.units:
        notes.append(
            "Row of units: "
            + ", ".join(f"{name} [{unit}]" for name, unit in place.units.items())
            + "."
        )
    notes += place.passed
    start, separator = place.start, place.separator
    if place.blanks:
        body = re.sub(
            rb"[ \t]+", b"\t", re.sub(rb"(?m)^[ \t]+|[ \t]+(?=\r?$)", b"", content[start:])
        )
        content = content[:start] + body
    text = CsvText(
        content, start, place.line, place.body_line, separator, ".", "", place.names,
        place.units, notes,
    )  # fmt: skip
    return _spelt(text, options)


def _spelt(text: CsvText, options: TableOptions) -> CsvText:
    """Find out how numbers are spelt, thousands divided included, unless the metadata say.

    Parameters
    ----------
    text : CsvText
        The text; its cells are looked at again.
    options : TableOptions
        What the metadata say about the table.

    Returns
    -------
    CsvText
        With decimal sign and thousands separator.
    """
    sample = text.content[text.start : text.start + 20_000].decode("utf-8", "replace")
    cells = [
        c for row in csv.reader(sample.splitlines()[:200], delimiter=text.separator) for c in row
    ]
    decimal, thousands = spelling(cells)
    if text.decimal == "," and decimal == "." and not thousands:
        decimal = ","
    notes = list(text.notes)
    told = None
    if thousands in {"", decimal} and not (options.decimal or options.thousands):
        told = told_apart(text.content[text.start :], text.separator)
    if told is not None:
        decimal, thousands = told
        notes = [note for note in notes if "decimal commas" not in note or decimal == ","]
        notes.append(
            f"Thousands divided by {thousands!r}, as {decimal!r} is the decimal sign elsewhere."
        )
    decimal, thousands = options.decimal or decimal, options.thousands or thousands
    if thousands == decimal:
        thousands = ""
    if decimal == "," and not any("decimal commas" in note for note in notes):
        notes.append(_decimal_commas(text.separator))
    return replace(
        text, decimal=decimal, thousands=thousands, notes=notes, missing=tuple(options.missing)
    )


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


def thousands_in(text: CsvText) -> str:
    """Sign between groups of three digits anywhere in a text; empty where there is none.

    Only numbers that have a decimal sign, too, or two groups, are proof of one.
    """
    for sign in ".,' ":
        if sign == text.decimal or sign == text.separator:
            continue
        group, point = re.escape(sign.encode()), re.escape(text.decimal.encode())
        pattern = (
            rb"(?<![\d.,])\d{1,3}" + group + rb"\d{3}(?:" + group + rb"\d{3}|" + point + rb"\d)"
        )
        if re.search(pattern, text.content[text.start :]):
            return sign
    return ""


def without_thousands(text: CsvText) -> CsvText:
    """Return a text of numbers without the signs between groups of three digits."""
    group = re.escape(text.thousands.encode())
    body = re.sub(rb"(?<=\d)" + group + rb"(?=\d{3}(?!\d))", b"", text.content[text.start :])
    return replace(text, content=text.content[: text.start] + body, thousands="")


def _decimal_commas(separator: str) -> str:
    """Note on the signs between cells and in numbers."""
    named = {"\t": "tabs", " ": "blanks"}.get(separator, f"'{separator}'")
    return f"Cells divided by {named}, decimal commas."
