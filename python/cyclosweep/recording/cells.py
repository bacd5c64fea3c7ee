"""Single cells of a table: numbers in any country's spelling, and times of day."""

import math
import re
from collections.abc import Collection
from datetime import date, datetime, time, timedelta
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.messages import shown
from cyclosweep.recording.samples import Floats

__all__ = [
    "MISSING",
    "BadCellError",
    "clock_seconds",
    "is_clock",
    "is_number",
    "number_in",
    "spelt_number",
]

MISSING = [
    *("", "NA", "N/A", "na", "n/a", "n.a.", "null", "NULL", "None", "-", "--", "---", "----"),
    *("#N/A", "#NV", "#NUM!", "#VALUE!", "#DIV/0!", "k.A."),
]
"""Cell contents that stand for a value that is not there.

The texts of an amplifier beyond its range, such as OVERLOAD, are none of them: the drive saw that
load, so whoever reads the file has to say that its rows are to be passed over.
"""

_GROUPED = re.compile(r"[+-]?\d{1,3}(?:(?P<sign>[.,'’  ])\d{3})(?:(?P=sign)\d{3})*(?:[.,]\d*)?")
_PLAIN = re.compile(
    r"[+-]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf|infinity)", re.IGNORECASE
)
_CLOCK = re.compile(
    r"(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{2,4})?"
    r"(?:(?<=\d)[T ]\s*)?(?:(?P<h>\d{1,3}):(?P<m>\d{2})(?::(?P<s>\d{2}(?:[.,]\d+)?))?"
    r"\s*(?P<half>[AaPp][Mm])?)?\s*(?P<zone>Z|[+-]\d{2}:?\d{2})?"
)


class BadCellError(InputError):
    """A cell with text where a number belongs.

    Attributes
    ----------
    cell : str
        Its text.
    where : str
        File, line or row, column, what was found and what was expected.
    """

    def __init__(self, place: str, cell: str) -> None:
        """Say where the cell stands and how to pass over its row.

        Parameters
        ----------
        place : str
            File, line or row, and column.
        cell : str
            Its text.
        """
        self.cell = cell.strip()
        self.where = f"{place}: found {shown(cell)}, expected a number"
        super().__init__(
            f"{self.where}; [table] missing = [{shown(cell)}] in the settings passes over such rows"
        )


def number_in(cell: str) -> float | None:
    """Value of a cell, None where it is not a number."""
    if "_" in cell:
        return None
    try:
        return float(cell)
    except ValueError:
        return None


def is_number(cell: str) -> bool:
    """Whether a cell is a number in any spelling: 1362.82, 1.362,820 or 1,362.82."""
    cell = cell.strip()
    return bool(_PLAIN.fullmatch(cell) or _GROUPED.fullmatch(cell))


def spelt_number(cell: str, decimal: str, thousands: str) -> float | None:
    """Value of a cell in a country's spelling.

    Parameters
    ----------
    cell : str
        The cell.
    decimal : str
        Decimal sign.
    thousands : str
        Signs that may divide groups of three digits; empty: none.

    Returns
    -------
    float or None
        None where it is no number in this spelling.

    Examples
    --------
    >>> spelt_number("1.362,820", ",", ".")
    1362.82
    >>> spelt_number("1.36,2", ",", ".") is None
    True
    """
    cell = cell.strip()
    if thousands and (grouped := _GROUPED.fullmatch(cell)) and grouped["sign"] in thousands:
        cell = cell.replace(grouped["sign"], "")
    if decimal == ",":
        cell = cell.replace(",", ".") if "." not in cell else "?"
    return number_in(cell)


def is_clock(cell: object) -> bool:
    """Whether a cell is a date or a time of day: ISO, 11.07.2024 15:47:12,5, or 15:47."""
    if isinstance(cell, datetime | date | time | timedelta):
        return True
    if not isinstance(cell, str) or not cell.strip():
        return False
    match = _CLOCK.fullmatch(cell.strip())
    return bool(match and (match["date"] or match["h"]))


def clock_seconds(
    cells: list[Any], rows: str, first: int, column: str, missing: Collection[str] = ()
) -> Floats:
    """Turn times into seconds since the first.

    Parameters
    ----------
    cells : list
        Text or objects of `datetime`; None or empty text is a missing value.
    rows : str
        File and the word for its rows, for messages.
    first : int
        Number of the first row.
    column : str
        Name of the column.
    missing : collection of str
        Texts besides `MISSING` that stand for a value that is not there.

    Returns
    -------
    ndarray of float, shape (n,)
        Times of day without a date go on past midnight [s].

    Raises
    ------
    InputError
        For a cell that is no time.
    """
    instants: list[float] = []
    dated = True
    for place, cell in enumerate(cells):
        if cell is None or (isinstance(cell, str) and _stands_for_none(cell, missing)):
            instants.append(math.nan)
            continue
        instant = _instant(cell)
        if instant is None:
            raise InputError(
                f"{rows} {first + place}, column {column}: found {shown(str(cell))}, "
                "expected a time as in the rows above"
            )
        dated &= instant[1]
        instants.append(instant[0])
    seconds = np.array(instants, dtype=np.float64)
    known = np.flatnonzero(np.isfinite(seconds))
    if not dated and len(known):
        days = np.cumsum(np.diff(seconds[known], prepend=seconds[known[0]]) < -43200.0)
        seconds[known] += 86400.0 * days
    return seconds - seconds[known[0]] if len(known) else seconds


def _stands_for_none(cell: str, missing: Collection[str]) -> bool:
    """Whether a text stands for a value that is not there.

    Parameters
    ----------
    cell : str
        The text.
    missing : collection of str
        Texts besides `MISSING` that do.

    Returns
    -------
    bool
    """
    return cell.strip() in MISSING or cell.strip() in missing


def _instant(cell: object) -> tuple[float, bool] | None:
    """Seconds of a date or time, and whether it has a date; None for anything else."""
    if isinstance(cell, datetime):
        aware = cell.tzinfo is not None
        origin = datetime(1970, 1, 1, tzinfo=cell.tzinfo if aware else None)
        offset = cell.utcoffset() or timedelta()
        return (cell - origin - offset).total_seconds(), True
    if isinstance(cell, date):
        return (cell - date(1970, 1, 1)).total_seconds(), True
    if isinstance(cell, timedelta):
        return cell.total_seconds(), False
    if isinstance(cell, time):
        return cell.hour * 3600 + cell.minute * 60 + cell.second + cell.microsecond / 1e6, False
    match = _CLOCK.fullmatch(str(cell).strip())
    if match is None or not (match["date"] or match["h"]):
        return None
    return _matched_instant(match)


def _matched_instant(match: re.Match[str]) -> tuple[float, bool] | None:
    """Seconds of a text that looks like a time; None for an impossible date."""
    hours, minutes = int(match["h"] or 0), int(match["m"] or 0)
    seconds = float((match["s"] or "0").replace(",", "."))
    if match["half"]:
        hours = hours % 12 + (12 if match["half"].lower() == "pm" else 0)
    total = hours * 3600.0 + minutes * 60.0 + seconds
    if match["zone"] and match["zone"] != "Z":
        sign = -1.0 if match["zone"][0] == "-" else 1.0
        digits = match["zone"][1:].replace(":", "")
        total -= sign * (int(digits[:2]) * 3600.0 + int(digits[2:]) * 60.0)
    if not match["date"]:
        return total, False
    parts = [int(part) for part in re.split(r"[-/.]", match["date"])]
    try:
        if parts[0] > 31:
            day = date(*parts)
        else:  # day first, as with dots; 07/11/2024 cannot be told apart and only shifts the zero
            year = parts[2] + (2000 if parts[2] < 100 else 0)
            month, first = (parts[1], parts[0]) if parts[1] <= 12 else (parts[0], parts[1])
            day = date(year, month, first)
    except ValueError:
        return None
    return (day - date(1970, 1, 1)).total_seconds() + total, True
