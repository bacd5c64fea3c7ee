"""Where the table stands in a sheet or text: names, units below them, first row of numbers."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from cyclosweep.recording.cells import MISSING, is_clock, is_number
from cyclosweep.recording.roles import name_weight
from cyclosweep.recording.units import find_unit

__all__ = ["SAMPLE_ROWS", "Layout", "find_layout"]

SAMPLE_ROWS = 250
"""Rows looked at to find the table: preambles of acquisition programs have tens of lines."""

_OTHER_UNITS = {"1", "%", "V", "mV", "mm", "rpm", "1/min", "bar", "Hz", "W", "text", "string"}
"""Units of columns that a recording may have besides its own."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Rows of a table, counted from 0.

    Attributes
    ----------
    header : int or None
        Row of the names; None where numbers stand without names.
    units : int or None
        Row of units below the names.
    first : int
        First row of values.
    size : int
        Cells with numbers in the rows looked at, to compare ways to divide a line.
    """

    header: int | None
    units: int | None
    first: int
    size: int


def find_layout(rows: Sequence[Sequence[str]], wanted: Collection[str] = ()) -> Layout | None:
    """Find the longest stretch of rows with numbers, and the names above it.

    Parameters
    ----------
    rows : sequence of sequence of str
        Cells of the first rows.
    wanted : collection of str
        Names that the metadata give; a row that has one is the row of names.

    Returns
    -------
    Layout or None
        None where no row has numbers.
    """
    numbers = [_numbers(row) for row in rows]
    size, first = 0, 0
    start = None
    for at in range(len(rows) + 1):
        blank = at < len(rows) and not any(cell.strip() for cell in rows[at])
        inside = at < len(rows) and (numbers[at] > 0 or blank)
        if inside and start is None and not blank:
            start = at
        if not inside and start is not None:
            if sum(numbers[start:at]) > size:
                size, first = sum(numbers[start:at]), start
            start = None
    if not size:
        return None
    header = _header(rows, first, wanted)
    if header is None:
        return Layout(None, None, first, size)
    between = [k for k in range(header + 1, first) if any(cell.strip() for cell in rows[k])]
    units = next((k for k in between if _is_units(rows[k])), None)
    bad = [k for k in between if any(is_number(c) for c in rows[k]) and not _is_units(rows[k])]
    return Layout(header, units, bad[0] if bad else first, size)


def _header(rows: Sequence[Sequence[str]], first: int, wanted: Collection[str]) -> int | None:
    """Find the row of names above the numbers.

    The one with most names that are asked for or known, torque and angle before all others and a
    unit beside them as much as a name; of equal ones one without numbers and dates in it, as a
    title has them; of equal ones the first of all, if it is as wide as the table, else the nearest.

    Parameters
    ----------
    rows : sequence of sequence of str
        Cells of the first rows.
    first : int
        First row of numbers.
    wanted : collection of str
        Names that the metadata give.

    Returns
    -------
    int or None
    """
    width = sum(bool(cell.strip()) for cell in rows[first])
    above = [k for k in range(first) if any(cell.strip() for cell in rows[k])]
    best, best_score = None, (-1, False, False)
    for k in above:
        filled = [cell.strip() for cell in rows[k] if cell.strip()]
        if 2 * len(filled) < width or _numbers(rows[k]):
            continue
        known = 10 * sum(cell in wanted for cell in filled) + sum(map(name_weight, filled))
        score = (
            0 if _is_units(rows[k]) else known,
            not any(is_number(cell) or is_clock(cell) for cell in filled),
            len(filled) >= width and k == above[0],
        )
        if score >= best_score:
            best, best_score = k, score
    return best


def _numbers(row: Sequence[str]) -> int:
    """Count a row's numbers and times, 0 where it has as much text."""
    filled = [cell for cell in row if cell.strip() not in MISSING]
    count = sum(is_number(cell) or is_clock(cell) for cell in filled)
    return count if 2 * count > len(filled) else 0


def _is_units(row: Sequence[str]) -> bool:
    """Whether every cell of a row is a unit or empty, and at least one is a unit."""
    filled = [cell.strip().strip("[]()").strip() for cell in row]
    filled = [cell for cell in filled if cell not in {"", "-", "--"}]
    known = [find_unit(cell) is not None for cell in filled]
    return any(known) and all(
        ok or cell in _OTHER_UNITS for ok, cell in zip(known, filled, strict=True)
    )
