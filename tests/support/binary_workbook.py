"""A workbook in Excel's binary format (.xlsb), for which Python has no writer.

Records are those of [MS-XLSB]: a number of one or two bytes, the length in groups of seven bits,
the content. Only what a table of names and numbers needs is written.
"""

import struct
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path

__all__ = ["write_binary_workbook"]

_RELATIONS = (
    '<?xml version="1.0" encoding="UTF-8"?><Relationships '
    'xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Id="rId1" '
    'Type="http://schemas.openxmlformats.org/officeDocument/2006/relationships/{}" Target="{}"/>'
    "</Relationships>"
)

ROW, REAL, TEXT = 0, 5, 6
BEGIN_SHEET, END_SHEET, BEGIN_DATA, END_DATA, DIMENSIONS = 129, 130, 145, 146, 148
BEGIN_BOOK, END_BOOK, BEGIN_SHEETS, END_SHEETS, SHEET = 131, 132, 143, 144, 156


def write_binary_workbook(
    path: Path, names: Sequence[str], rows: Iterable[Sequence[float]]
) -> None:
    """Write one sheet with a row of names above rows of numbers."""
    table: list[Sequence[str | float]] = [names, *rows]
    cells = b""
    for number, row in enumerate(table):
        cells += _record(ROW, struct.pack("<IIHBBBI", number, 0, 300, 0, 0, 0, 0))
        for place, value in enumerate(row):
            at = struct.pack("<II", place, 0)
            if isinstance(value, str):
                cells += _record(TEXT, at + _words(value))
            else:
                cells += _record(REAL, at + struct.pack("<d", value))
    sheet = _record(BEGIN_SHEET)
    sheet += _record(DIMENSIONS, struct.pack("<4I", 0, len(table) - 1, 0, len(names) - 1))
    sheet += _record(BEGIN_DATA) + cells + _record(END_DATA) + _record(END_SHEET)
    entry = _record(SHEET, struct.pack("<II", 0, 1) + _words("rId1") + _words("Data"))
    book = _record(BEGIN_BOOK) + _record(BEGIN_SHEETS) + entry
    book += _record(END_SHEETS) + _record(END_BOOK)
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("_rels/.rels", _RELATIONS.format("officeDocument", "xl/workbook.bin"))
        relation = _RELATIONS.format("worksheet", "worksheets/sheet1.bin")
        file.writestr("xl/_rels/workbook.bin.rels", relation)
        file.writestr("xl/workbook.bin", book)
        file.writestr("xl/worksheets/sheet1.bin", sheet)


def _record(kind: int, content: bytes = b"") -> bytes:
    """One record: its number, its length, its content."""
    head = bytes([kind]) if kind < 128 else bytes([kind & 127 | 128, kind >> 7])
    length, size = len(content), b""
    while length > 127:
        size, length = size + bytes([length & 127 | 128]), length >> 7
    return head + size + bytes([length]) + content


def _words(text: str) -> bytes:
    """Text behind its length, two bytes a sign."""
    return struct.pack("<I", len(text)) + text.encode("utf-16-le")
