"""Where the table stands in a sheet or text: names, units below them, first row of numbers."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from cyclosweep.recording.cells import MISSING, is_number
from cyclosweep.recording.clocks import is_clock
from cyclosweep.recording.messages import shown
from cyclosweep.recording.roles import name_weight
from cyclosweep.recording.units import OTHER_UNITS, find_unit

__all__ = ["SAMPLE_ROWS", "Layout", "bare_unit", "find_layout", "passed_note"]

SAMPLE_ROWS = 250
"""Rows looked at to find the table: preambles of acquisition programs have tens of lines."""

_NO_UNITS = {"1", "text", "string"}
"""What a row of units says of columns that have none."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Rows of a table, counted from 0.

    Attributes
    ----------
    header : int or None
        Row of the names; None where numbers stand without names.
    units : int or None
        Row of units below the names, or right above them.
    first : int
        First row of values.
    size : int
        Cells with numbers in the rows looked at, to compare ways to divide a line.
    passed : tuple of int
        Rows of text between names and numbers that are no units.
    """

    header: int | None
    units: int | None
    first: int
    size: int
    passed: tuple[int, ...] = ()


def bare_unit(cell: str) -> str:
    """Unit in a cell without brackets; empty where a dash says that there is none."""
    text = cell.strip().strip("[]()").strip()
    return "" if text in {"-", "--", "–"} else text


def passed_note(words: str, number: int, row: Sequence[str]) -> str:
    """Say that a row of text between names and numbers is passed over.

    Parameters
    ----------
    words : str
        What the format calls a row.
    number : int
        Its number, from 1.
    row : sequence of str
        Its cells.

    Returns
    -------
    str
    """
    text = shown("; ".join(cell.strip() for cell in row if cell.strip()))
    return f"{words} {number} between names and numbers is passed over: {text}."


def find_layout(
    rows: Sequence[Sequence[str]], wanted: Collection[str] = (), names: int | None = None
) -> Layout | None:
    """Find the longest stretch of rows with numbers, and the names above it.

    Parameters
    ----------
    rows : sequence of sequence of str
        Cells of the first rows.
    wanted : collection of str
        Names that the metadata give; a row that has one is the row of names.
    names : int, optional
        Row of the names, where the user says.

    Returns
    -------
    Layout or None
        None where no row has numbers, or that of the user has, or no names.
    """
    numbers = [_numbers(row) for row in rows]
    if names is not None:
        if names >= len(rows) or numbers[names] or not any(cell.strip() for cell in rows[names]):
            return None
        numbers[:names] = [0] * names
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
    header = _header(rows, first, wanted) if names is None else names
    if header is None:
        return Layout(None, None, first, size)
    between = [k for k in range(header + 1, first) if any(cell.strip() for cell in rows[k])]
    units = next((k for k in between if _has_units(rows[k])), None)
    bad = [k for k in between if any(is_number(c) for c in rows[k]) and k != units]
    first = bad[0] if bad else first
    passed = tuple(k for k in between if k < first and k != units)
    if units is None:
        above = next((k for k in range(header - 1, -1, -1) if any(c.strip() for c in rows[k])), 0)
        fits = len(rows[above]) == len(rows[header])
        units = above if above < header and fits and _is_units(rows[above]) else None
    return Layout(header, units, first, size, passed)


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
    """Whether every cell of a row is a unit or empty, and at least one is a unit.

    In square brackets any text is a unit, whether it is known or not.
    """
    filled = [cell.strip() for cell in row if bare_unit(cell)]
    return any(find_unit(cell) for cell in filled) and all(
        find_unit(cell)
        or bare_unit(cell) in OTHER_UNITS | _NO_UNITS
        or (cell.startswith("[") and cell.endswith("]"))
        for cell in filled
    )


def _has_units(row: Sequence[str]) -> bool:
    """Whether a row of text below the names states units, though some may not be known."""
    filled = [bare_unit(cell) for cell in row if bare_unit(cell)]
    if any(is_number(text) and text not in _NO_UNITS for text in filled):
        return False
    bracketed = all(cell.strip().startswith("[") for cell in row if bare_unit(cell))
    return bool(filled) and (bracketed or any(find_unit(text) for text in filled))
