"""Dates and times of day in cells, and the seconds that pass between them."""

import math
import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from datetime import date, datetime, time, timedelta
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import MISSING
from cyclosweep.recording.messages import shown
from cyclosweep.recording.samples import Floats

__all__ = ["clock_seconds", "is_clock", "unit_of_count"]

DAY_S = 86400.0
"""A day [s]."""
HOUR_S = 3600.0
"""An hour [s]."""

_CLOCK = re.compile(
    r"(?P<date>\d{4}[-/.]\d{1,2}[-/.]\d{1,2}|\d{1,2}[./]\d{1,2}[./]\d{2,4})?"
    r"(?:(?<=\d)[T ]\s*)?(?:(?P<h>\d{1,3}):(?P<m>\d{2})(?::(?P<s>\d{2}(?:[.,]\d+)?))?"
    r"\s*(?P<half>[AaPp][Mm])?|(?P<min>\d{1,3}):(?P<sec>\d{2}[.,]\d+))?"
    r"\s*(?P<zone>Z|[+-]\d{2}:?\d{2})?"
)

SERIAL_DAYS = (25_569.0, 73_051.0)
"""Days that spreadsheets count from 1900 to 1970 and to 2100."""
SERIAL_STEP = 5e-4
"""Largest step of such a clock [day], 43 s; a clock in seconds would have taken 2,000 readings in
each of them, after running for hours."""
EPOCH_S = (6e8, 4e9)
"""Seconds from 1970 to 1989 and to 2096."""


@dataclass(frozen=True, slots=True)
class _Instant:
    """A date or time.

    Attributes
    ----------
    seconds : float
        Since 1970, or since midnight or the hour where it has no date.
    is_dated : bool
        It has a date.
    is_within_hour : bool
        It has minutes and seconds only, as 59:59.5.
    """

    seconds: float
    is_dated: bool
    is_within_hour: bool = False


def is_clock(cell: object) -> bool:
    """Whether a cell is a date or time: ISO, 11.07.2024 15:47:12,5, 15:47, or 59:59.5."""
    if isinstance(cell, datetime | date | time | timedelta):
        return True
    return isinstance(cell, str) and _matched(cell) is not None


def clock_seconds(
    cells: list[Any], rows: str, first: int, column: str, missing: Collection[str] = ()
) -> tuple[Floats, str]:
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
    seconds : ndarray of float, shape (n,)
        Times of day without a date go on past midnight, minutes past the hour [s].
    note : str
        What was recognised.

    Raises
    ------
    InputError
        For a cell that is no time.
    """
    is_known = [not (cell is None or _stands_for_none(cell, missing)) for cell in cells]
    texts = [c for c, known in zip(cells, is_known, strict=True) if known and isinstance(c, str)]
    month_first, note = _month_first(texts)
    instants: list[_Instant | None] = []
    for place, (cell, known) in enumerate(zip(cells, is_known, strict=True)):
        instant = _instant(cell, month_first=month_first) if known else None
        if known and instant is None:
            raise InputError(
                f"{rows} {first + place}, column {column}: found {shown(str(cell))}, "
                "expected a time as in the rows above"
            )
        instants.append(instant)
    seconds = np.array([math.nan if i is None else i.seconds for i in instants], dtype=np.float64)
    found = [instant for instant in instants if instant is not None]
    note = f"{column} holds dates or times of day{note}: seconds since the first are taken."
    if not found:
        return seconds, note
    places = np.flatnonzero(np.isfinite(seconds))
    if not all(instant.is_dated for instant in found):
        period = HOUR_S if all(instant.is_within_hour for instant in found) else DAY_S
        back = np.diff(seconds[places], prepend=seconds[places[0]]) < -period / 2
        seconds[places] += period * np.cumsum(back)
    return seconds - seconds[places[0]], note


def unit_of_count(values: Floats) -> tuple[str, str] | None:
    """Tell the unit of a clock that counts from 1900 or 1970 by the size of its numbers.

    Parameters
    ----------
    values : ndarray of float, shape (n,)
        The clock in the file's unit.

    Returns
    -------
    tuple of str, or None
        The unit, and what says so; None where the numbers may be seconds.
    """
    known = values[np.isfinite(values)]
    if len(known) < 2:
        return None
    low, high = float(known.min()), float(known.max())
    steps = np.diff(known)
    steps = steps[steps > 0]
    if SERIAL_DAYS[0] < low and high < SERIAL_DAYS[1] and len(steps):
        return ("d", "its dates of a spreadsheet") if np.median(steps) < SERIAL_STEP else None
    for unit, per_second in (("ms", 1e3), ("us", 1e6), ("ns", 1e9)):
        if EPOCH_S[0] * per_second < low and high < EPOCH_S[1] * per_second:
            return unit, "its count since 1970"
    return None


def _month_first(texts: Sequence[str]) -> tuple[bool, str]:
    """Tell whether the dates of a column are written as 07/31/2024, with a note.

    Parameters
    ----------
    texts : sequence of str
        Dates and times.

    Returns
    -------
    bool
        A day beyond 12 or AM and PM say so; else the order with which the clock is shorter.
    str
        What was taken, where the order is a choice.
    """
    dates, halves = set(), False
    for text in texts:
        match = _matched(text)
        if match is None or not match["date"] or not re.match(r"\d{1,2}/", match["date"]):
            return False, ""
        first, second, year = (int(part) for part in re.split(r"[/.]", match["date"]))
        dates.add((first, second, _full(year)))
        halves = halves or match["half"] is not None
    if not dates or any(first > 12 for first, _, _ in dates):
        return False, ""
    if any(second > 12 for _, second, _ in dates) or halves:
        return True, ", the month first"
    by_day = [date(year, second, first).toordinal() for first, second, year in dates]
    by_month = [date(year, first, second).toordinal() for first, second, year in dates]
    if len(dates) == 1:  # either only shifts the zero
        return False, ""
    is_month = max(by_month) - min(by_month) < max(by_day) - min(by_day)
    return is_month, f", the {'month' if is_month else 'day'} first, so that the clock is short"


def _full(year: int) -> int:
    """Year with its century."""
    return year + (2000 if year < 100 else 0)


def _stands_for_none(cell: object, missing: Collection[str]) -> bool:
    """Whether a cell stands for a value that is not there.

    Parameters
    ----------
    cell : object
        Text or a time.
    missing : collection of str
        Texts besides `MISSING` that do.

    Returns
    -------
    bool
    """
    return isinstance(cell, str) and (cell.strip() in MISSING or cell.strip() in missing)


def _matched(cell: str) -> re.Match[str] | None:
    """Parts of a text that is a date or a time of day; None for another."""
    match = _CLOCK.fullmatch(cell.strip())
    return match if match and (match["date"] or match["h"] or match["min"]) else None


def _instant(cell: object, *, month_first: bool) -> _Instant | None:
    """Read a date or time.

    Parameters
    ----------
    cell : object
        Text or an object of `datetime`.
    month_first : bool
        The month stands before the day, where the year stands last.

    Returns
    -------
    _Instant or None
        None for anything else.
    """
    if isinstance(cell, datetime):
        aware = cell.tzinfo is not None
        origin = datetime(1970, 1, 1, tzinfo=cell.tzinfo if aware else None)
        offset = cell.utcoffset() or timedelta()
        return _Instant((cell - origin - offset).total_seconds(), True)
    if isinstance(cell, date):
        return _Instant((cell - date(1970, 1, 1)).total_seconds(), True)
    if isinstance(cell, timedelta):
        return _Instant(cell.total_seconds(), False)
    if isinstance(cell, time):
        seconds = cell.hour * HOUR_S + cell.minute * 60 + cell.second + cell.microsecond / 1e6
        return _Instant(seconds, False)
    match = _matched(str(cell))
    return None if match is None else _matched_instant(match, month_first=month_first)


def _matched_instant(match: re.Match[str], *, month_first: bool) -> _Instant | None:
    """Read a text that looks like a time.

    Parameters
    ----------
    match : re.Match
        Its parts.
    month_first : bool
        The month stands before the day, where the year stands last.

    Returns
    -------
    _Instant or None
        None for an impossible date.
    """
    hours, minutes = int(match["h"] or 0), int(match["m"] or match["min"] or 0)
    seconds = float((match["s"] or match["sec"] or "0").replace(",", "."))
    if match["half"]:
        hours = hours % 12 + (12 if match["half"].lower() == "pm" else 0)
    total = hours * HOUR_S + minutes * 60.0 + seconds
    if match["zone"] and match["zone"] != "Z":
        sign = -1.0 if match["zone"][0] == "-" else 1.0
        digits = match["zone"][1:].replace(":", "")
        total -= sign * (int(digits[:2]) * HOUR_S + int(digits[2:]) * 60.0)
    if not match["date"]:
        return _Instant(total, False, match["min"] is not None)
    parts = [int(part) for part in re.split(r"[-/.]", match["date"])]
    try:
        if parts[0] > 31:
            day = date(*parts)
        else:
            is_month = parts[1] > 12 or (month_first and parts[0] <= 12)
            month, first = (parts[0], parts[1]) if is_month else (parts[1], parts[0])
            day = date(_full(parts[2]), month, first)
    except ValueError:
        return None
    return _Instant((day - date(1970, 1, 1)).total_seconds() + total, True)
