"""Where the table stands in a text: below a preamble, with a row of units, divided by blanks."""

import csv
import re
from collections.abc import Callable, Collection
from dataclasses import dataclass

from cyclosweep.recording.layout import SAMPLE_ROWS, Layout, bare_unit, find_layout, passed_note

__all__ = ["SEPARATORS", "TextTable", "find_text_table"]

SEPARATORS = ",;\t|"
"""Characters that may stand between cells."""

_SAMPLE_BYTES = 200_000


@dataclass(frozen=True, slots=True)
class TextTable:
    """Place of a table in a text.

    Attributes
    ----------
    line : int
        Line number of the names, from 1.
    body_line : int
        Number of the last line above the values.
    start : int
        Where the values begin [byte].
    separator : str
        Character between cells.
    blanks : bool
        Cells are divided by runs of blanks, which are to become one tabulator each.
    names : list of str
        Names of the columns.
    units : dict of str to str
        Units in a row of their own, by column.
    above : bool
        Whether something stands above the names.
    passed : tuple of str
        Notes on lines between names and values that are passed over.
    """

    line: int
    body_line: int
    start: int
    separator: str
    blanks: bool
    names: list[str]
    units: dict[str, str]
    above: bool
    passed: tuple[str, ...]


def find_text_table(
    content: bytes, header_row: int | None, wanted: Collection[str]
) -> TextTable | None:
    """Find the table in a text: the way to divide lines that gives most numbers.

    Parameters
    ----------
    content : bytes
        The whole text in UTF-8.
    header_row : int or None
        Line of the names, from 1, where the metadata say.
    wanted : collection of str
        Names that the metadata give.

    Returns
    -------
    TextTable or None
        None where no table with names is found.
    """
    if header_row is None:
        lines = content[:_SAMPLE_BYTES].split(b"\n")[:SAMPLE_ROWS]
    else:
        lines = content.split(b"\n", header_row + SAMPLE_ROWS)[: header_row + SAMPLE_ROWS]
    texts = [line.decode("utf-8", "replace").rstrip("\r") for line in lines]
    skip = [text.startswith("#") or text.lower().startswith("sep=") for text in texts]
    best: tuple[int, Layout, list[list[str]], str] | None = None
    for separator in (*SEPARATORS, " "):
        if not any(separator in text for text in texts[-50:]) or (separator == " " and best):
            continue
        divide = _divider(separator)
        rows = [[] if passed else divide(text) for text, passed in zip(texts, skip, strict=True)]
        layout = find_layout(rows, wanted, None if header_row is None else header_row - 1)
        if layout is None or sum(bool(cell.strip()) for cell in rows[layout.first]) < 2:
            continue
        if layout.header is None:
            commented = _commented_names(texts[: layout.first], len(rows[layout.first]), divide)
            if commented is None or (separator != " " and best is not None):
                continue
            rows[commented[0]] = commented[1]
            layout = Layout(commented[0], None, layout.first, layout.size)
        if best is None or layout.size > best[0]:
            best = (layout.size, layout, rows, separator)
    if best is None or best[1].header is None:
        return None
    _, layout, rows, separator = best
    assert layout.header is not None
    names = [name.strip() for name in rows[layout.header]]
    while names and not names[-1] and len(names) > len(rows[layout.first]):
        names.pop()
    units: dict[str, str] = {}
    if layout.units is not None:
        cells = [bare_unit(cell) for cell in rows[layout.units]]
        units = {name: unit for name, unit in zip(names, cells, strict=False) if name and unit}
    body = layout.first
    return TextTable(
        layout.header + 1,
        body,
        sum(len(line) + 1 for line in lines[:body]),
        "\t" if separator == " " else separator,
        separator == " ",
        names,
        units,
        any(text.strip() and not passed for text, passed in
            zip(texts[: layout.header], skip, strict=False)),
        tuple(passed_note("Line", row + 1, rows[row]) for row in layout.passed),
    )  # fmt: skip


def _divider(separator: str) -> Callable[[str], list[str]]:
    """Return what divides a line into cells."""
    if separator == " ":
        return lambda text: text.split()

    def divide(text: str) -> list[str]:
        try:
            return next(csv.reader([text], delimiter=separator), [])
        except csv.Error:
            return []

    return divide


def _commented_names(
    texts: list[str], width: int, divide: Callable[[str], list[str]]
) -> tuple[int, list[str]] | None:
    """Find names in the last comment above the numbers, as NumPy writes them.

    Parameters
    ----------
    texts : list of str
        Lines above the numbers.
    width : int
        Number of columns.
    divide : callable
        Divides a line into cells.

    Returns
    -------
    int, list of str, or None
        Row and names; None where the last comment has another number of words.
    """
    for row in range(len(texts) - 1, -1, -1):
        if texts[row].startswith("#"):
            text = re.sub(r"^#+\s*", "", texts[row])
            names = divide(text)
            if len(names) != width:  # blanks between names and units, too
                names = re.findall(r"\S+(?:\s+[\[(][^\])]*[\])])?", text)
            return (row, names) if len(names) == width else None
        if texts[row].strip():
            return None
    return None
