"""Which columns of a file are torque, angle, clock and run, and which could be, too."""

from dataclasses import dataclass, field

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import BadCellError
from cyclosweep.recording.clocks import DAY_S
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.lengths import is_length
from cyclosweep.recording.metadata import APART, CANONICAL_COLUMNS
from cyclosweep.recording.roles import Named, describe, reads_like_a_date, role_by_name
from cyclosweep.recording.same_signal import same_signal
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.units import MEANINGS, UNIT_EXAMPLES

__all__ = ["Choice", "choose", "numbers_of"]

MOST_TEXTS = 5
"""Different texts in a column that still is one of numbers: an overload, a word for no reading."""

FOLLOWS = 0.995
"""Correlation beyond which a torque is computed from a current, not measured by itself."""

_RANK = {"torque": 0, "angle": 0, None: 1, "counts": 2, "force": 2, "current": 3}
_FLAGS = {"torque_nm": "--torque", "angle_deg": "--angle"}


@dataclass(slots=True)
class Choice:
    """Columns that were chosen, and what stays open.

    Attributes
    ----------
    roles : dict of str to Named
        Column of each canonical one.
    assumed : list of str
        What the file does not say.
    open : list of str
        What must be said before the file can be read.
    commands : list of str
        Columns that were asked for, not measured.
    current : str or None
        Column of a current from which the torque is computed.
    """

    roles: dict[str, Named] = field(default_factory=dict)
    assumed: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)
    commands: list[str] = field(default_factory=list)
    current: str | None = None


def numbers_of(table: FileTable) -> tuple[dict[str, Floats], dict[str, BadCellError]]:
    """Read every column that holds numbers or times.

    Parameters
    ----------
    table : FileTable
        The file.

    Returns
    -------
    numbers : dict of str to ndarray of float, shape (rows,)
        Values by column; NaN where there is none, or text.
    bad : dict of str to BadCellError
        First cell with text of each column that otherwise holds numbers.
    """
    names = [name for name in dict.fromkeys(table.header) if table.header.count(name) == 1 and name]
    count = len(table.notes)
    try:
        frame = table.read(names, [])
        return {name: frame[name].to_numpy().astype(np.float64) for name in names}, {}
    except InputError:
        del table.notes[count:]
    # One of them is text. Reading all of them with it as text keeps the rows in step.
    numeric, bad = [], {}
    texts: set[str] = set()
    for name in names:
        found = _texts_among_numbers(table, name)
        if found is not None:
            numeric.append(name)
            if found:
                bad[name] = found[0]
                texts |= {each.cell for each in found}
    del table.notes[count:]
    table = table.passing_over(texts)
    frame = table.read(numeric, [name for name in names if name not in numeric])
    return {name: frame[name].to_numpy().astype(np.float64) for name in numeric}, bad


def _texts_among_numbers(table: FileTable, name: str) -> list[BadCellError] | None:
    """Find the texts in a column of numbers.

    Parameters
    ----------
    table : FileTable
        The file.
    name : str
        The column.

    Returns
    -------
    list of BadCellError or None
        One for each text; None where the column holds text, or more than `MOST_TEXTS` of them.
    """
    found: list[BadCellError] = []
    while len(found) <= MOST_TEXTS:
        try:
            values = table.passing_over([each.cell for each in found]).read([name], [])[name]
        except BadCellError as error:
            if found and error.cell == found[-1].cell:
                return None
            found.append(error)
            continue
        except InputError:
            return None
        return found if not found or 2 * int(values.is_finite().sum()) > len(values) else None
    return None


def choose(table: FileTable, numbers: dict[str, Floats], given: dict[str, str | None]) -> Choice:
    """Choose a column for each canonical one by name and unit; guess nothing.

    Parameters
    ----------
    table : FileTable
        The file.
    numbers : dict of str to ndarray of float, shape (rows,)
        Its columns of numbers.
    given : dict of str to str or None
        Columns that the user names, by canonical column.

    Returns
    -------
    Choice

    Raises
    ------
    InputError
        For a column that the user names and that is not there or holds text, or names twice.
    """
    choice = Choice()
    named = {name: describe(name, table.units.get(name)) for name in numbers}
    for role, column in given.items():
        if column is None:
            continue
        if column not in numbers:
            found = ", ".join(numbers) or "none"
            flag = _FLAGS.get(role, role)
            raise InputError(f"{flag}: found {column!r}, expected one of the columns {found}")
        for other, own in choice.roles.items():
            if own.column == column and {role, other} <= set(APART):
                raise InputError(
                    f"{_FLAGS.get(role, role)}: found column {column!r}, which "
                    f"{_FLAGS.get(other, other)} names, too; expected a column of its own"
                )
        choice.roles[role] = named[column]
    choice.commands = [n.column for n in named.values() if n.role == "torque_nm" and n.is_command]
    for role in CANONICAL_COLUMNS:
        if role in choice.roles:
            continue
        taken = {other.column for other in choice.roles.values()}
        candidates = [
            n for n in named.values()
            if n.role == role and not n.is_command and n.column not in taken
            and _can_be(role, numbers[n.column])
        ]  # fmt: skip
        if role == "angle_deg":
            candidates = [n for n in candidates if not is_length(table, n)]
        if role in ("crank_deg", "temperature_c"):  # a recording may lack them: nothing is asked
            unknown = [n for n in candidates if n.unknown_unit is not None]
            candidates = [n for n in candidates if n.unknown_unit is None]
            choice.assumed += [
                f"{n.column}: unit {n.unknown_unit!r} is not known: not read." for n in unknown
            ]
        if role == "time_s" and not candidates:
            candidates = [n for n in named.values() if _is_dated_clock(n, table, numbers)]
        if not candidates and role in (*_FLAGS, "time_s"):
            why = _why_not(role, table, numbers)
            if why is not None:
                (choice.assumed if role == "time_s" else choice.open).append(why)
                continue
        _choose_one(role, candidates, numbers, choice)
    _note_current(named, numbers, choice)
    return choice


def _is_dated_clock(named: Named, table: FileTable, numbers: dict[str, Floats]) -> bool:
    """Whether a column that is called a date holds times, too, and not whole days alone.

    Parameters
    ----------
    named : Named
        What its name says.
    table : FileTable
        The file, read, with its notes.
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file; dates and times as seconds since the first.

    Returns
    -------
    bool
    """
    if named.role is not None or not reads_like_a_date(named.column):
        return False
    values = numbers[named.column]
    known = values[np.isfinite(values)]
    whole_days = bool(np.all(known % DAY_S == 0.0))
    return not whole_days and _holds_times(table, named.column) and _can_be("time_s", values)


def _holds_times(table: FileTable, column: str) -> bool:
    """Whether dates or times of day were read in a column, which a note says.

    Parameters
    ----------
    table : FileTable
        The file, read.
    column : str
        One of its columns.

    Returns
    -------
    bool
    """
    return any(note.startswith(f"{column} holds dates") for note in table.notes)


def _why_not(role: str, table: FileTable, numbers: dict[str, Floats]) -> str | None:
    """Say why a column whose name reads like a canonical one cannot be it.

    Parameters
    ----------
    role : str
        Canonical column.
    table : FileTable
        The file.
    numbers : dict of str to ndarray of float, shape (rows,)
        Its columns of numbers.

    Returns
    -------
    str or None
        None where no name does, or what it says is a command.
    """
    for column in dict.fromkeys(table.header):
        named = describe(column, table.units.get(column))
        if role_by_name(column) != role or named.is_command or table.header.count(column) > 1:
            continue
        if column in numbers and named.role is None and named.kind is not None:
            return (
                f"{column} reads like {MEANINGS[role]}, but {named.unit!r} is a unit of "
                f"{named.kind}, expected {UNIT_EXAMPLES[role]}. Name another column, or, where the "
                f"file is wrong, give unit and instead_of under columns.{role} in settings for "
                "--meta."
            )
        if column not in numbers:
            left = "the clock is not read" if role == "time_s" else "mend such cells"
            return f"{_first_text(table, column)}: {left}."
    return None


def _first_text(table: FileTable, column: str) -> str:
    """Where text stands in a column, what was found and what was expected.

    Parameters
    ----------
    table : FileTable
        The file.
    column : str
        Its column.

    Returns
    -------
    str
    """
    try:
        table.read([column], [])
    except BadCellError as error:
        return error.where
    except InputError as error:
        return str(error).rstrip(".")
    return f"column {column} holds too few numbers"


def _choose_one(
    role: str, candidates: list[Named], numbers: dict[str, Floats], choice: Choice
) -> None:
    """Take the one candidate whose name or unit speaks best, or ask.

    Parameters
    ----------
    role : str
        Canonical column.
    candidates : list of Named
        Columns that could be it.
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    choice : Choice
        The result is added to it.
    """
    canonical = [n for n in candidates if n.is_canonical]
    ranks = [2 if n.unknown_unit is not None else _RANK.get(n.kind, 1) for n in candidates]
    best = canonical or [n for n, r in zip(candidates, ranks, strict=True) if r == min(ranks)]
    needed = role in _FLAGS
    if not best:
        if role == "torque_nm":
            extra = f"; {', '.join(choice.commands)} is a command" if choice.commands else ""
            choice.open.append(
                f"No column is recognised as the torque{extra}. Say --torque NAME; "
                "--header-row N if these are not the names of the columns."
            )
        elif role == "angle_deg":
            choice.assumed.append(
                "No column is recognised as the angle: a load programme (--angle NAME)."
            )
        return
    first = best[0]
    apart = [n for n in best[1:] if not same_signal(first, n, numbers)]
    if not apart:
        choice.roles[role] = first
        return
    names = ", ".join([first.column, *(n.column for n in apart)])
    if needed:
        what = "torque" if role == "torque_nm" else "angle"
        choice.open.append(f"These columns could be the {what}: {names}. Say {_FLAGS[role]} NAME.")
    else:
        choice.assumed.append(f"{first.column} taken as {role}; {names} could be, too.")
        choice.roles[role] = first


def _can_be(role: str, values: Floats) -> bool:
    """Whether values can be those of a canonical column.

    Parameters
    ----------
    role : str
        Canonical column.
    values : ndarray of float, shape (rows,)
        Numbers of a column.

    Returns
    -------
    bool
    """
    known = values[np.isfinite(values)]
    if not len(known):
        return False
    if role == "run":
        whole = bool((known == np.rint(known)).all())
        blocks = 1 + int(np.count_nonzero(np.diff(known)))
        enough = blocks <= max(len(known) / 3, 1)
        return whole and blocks == len(np.unique(known)) and enough
    if role == "time_s":
        return len(known) < 2 or float(np.mean(np.diff(known) < 0)) < 0.1
    return True


def _note_current(named: dict[str, Named], numbers: dict[str, Floats], choice: Choice) -> None:
    """Find a current that the torque follows, which is then no sensor of its own.

    Parameters
    ----------
    named : dict of str to Named
        Columns by name.
    numbers : dict of str to ndarray of float, shape (rows,)
        Their values.
    choice : Choice
        The result is added to it.
    """
    torque = choice.roles.get("torque_nm")
    if torque is None:
        return
    if torque.kind == "current":
        choice.current = torque.column
        return
    for other in named.values():
        a, b = numbers[torque.column], numbers[other.column]
        known = np.isfinite(a) & np.isfinite(b)
        if other.kind != "current" or known.sum() < 10 or not np.ptp(b[known]):
            continue
        if np.ptp(a[known]) and np.corrcoef(a[known], b[known])[0, 1] > FOLLOWS:
            choice.current = other.column
            choice.assumed.append(
                f"{torque.column} follows {other.column}: computed from the motor's current, no "
                "sensor of its own."
            )
            return
