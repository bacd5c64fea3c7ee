"""Which column of a file is torque, angle, clock, run: told by its name and unit."""

import re
from dataclasses import dataclass, replace

from cyclosweep.errors import InputError
from cyclosweep.recording.units import (
    CANONICAL_UNITS,
    QUANTITIES,
    UNIT_EXAMPLES,
    find_unit,
    split_name,
    unknown_unit,
)

__all__ = [
    "COMMAND",
    "Named",
    "describe",
    "name_weight",
    "reads_like_a_date",
    "reads_like_counts",
    "role_by_name",
    "with_unit",
]

_WORDS: dict[str, tuple[str, ...]] = {
    "torque_nm": ("torque", "moment", "drehmoment", "tq", "trq", "md", "mt", "couple", "torsion"),
    "angle_deg": ("angle", "position", "twist", "rotation", "winkel", "drehwinkel", "verdrehung",
                  "verdrehwinkel", "theta", "phi", "pos", "encoder", "angolo", "deflection",
                  "displacement", "resolver"),
    "time_s": ("time", "zeit", "t", "clock", "timestamp", "elapsed", "temps", "x_value",
               "datetime", "uhrzeit", "zeitstempel"),
    "run": ("run", "test_nr", "test", "trial", "versuch", "lauf", "cycle", "zyklus", "run_nr",
            "repetition", "segment"),
    "crank_deg": ("crank", "mesh", "kurbel", "locking", "lock"),
    "temperature_c": ("temperature", "temp", "temperatur", "toil", "oil"),
}  # fmt: skip
_SYMBOLS = {
    "torque_nm": {"m", "T", "M", "Mt", "Md"},
    "angle_deg": {"φ", "ϕ", "θ", "phi"},
    "time_s": {"t"},
}
COMMAND = frozenset(
    ("command", "commanded", "cmd", "control", "setpoint", "set", "soll", "sollwert", "target",
     "demand", "desired", "reference", "ref", "limit", "error", "err", "sp")
)  # fmt: skip
"""Words that mark what was asked for, not what was measured."""
_COUNT_WORDS = ("encoder", "enc", "resolver", "count", "counts", "cnt", "inc", "ink", "inkr",
                "inkremente", "increments", "ticks", "striche", "impulse", "pulses")  # fmt: skip
_FORCE_WORDS = ("force", "kraft", "load", "last", "loadcell")
_CURRENT_WORDS = ("current", "strom", "iq", "amps", "ampere")


@dataclass(frozen=True, slots=True)
class Named:
    """What the name and the unit of a column say.

    Attributes
    ----------
    column : str
        Its name in the file.
    role : str or None
        Canonical column it is likely to be.
    unit : str or None
        Unit as written; None where the file says none.
    kind : str or None
        What the unit measures; where only the name speaks of a force or current, that.
    is_command : bool
        The name says that it was asked for, not measured.
    is_canonical : bool
        It is a canonical name, which carries its unit.
    unknown_unit : str or None
        Unit that the file states for it and that is not known.
    """

    column: str
    role: str | None
    unit: str | None
    kind: str | None
    is_command: bool
    is_canonical: bool
    unknown_unit: str | None = None


def describe(column: str, unit: str | None = None) -> Named:
    """Tell from name and unit what a column is.

    Parameters
    ----------
    column : str
        Name in the file.
    unit : str, optional
        Unit that the file gives elsewhere, as in a row of units.

    Returns
    -------
    Named

    Examples
    --------
    >>> describe("Drehmoment [lb in]").role
    'torque_nm'
    >>> describe("CONTROL_TORQUE").is_command
    True
    """
    if column in QUANTITIES:
        known_unit, unknown = (unit, None) if unit is None or find_unit(unit) else (None, unit)
        own = known_unit or CANONICAL_UNITS.get(column)
        return Named(column, column, own, None, False, True, unknown)
    bare, written, _ = split_name(column)
    unknown = None
    if unit is None or find_unit(unit) is None:
        unknown = None if written is not None else unit or unknown_unit(column)
        unit = written
    words = _words_of(bare)
    role = _role_of(bare.strip(), words)
    known = None if unit is None else find_unit(unit, role) or find_unit(unit)
    kind = known.kind if known else None
    if kind is None and any(word in _CURRENT_WORDS for word in words):
        kind = "current"
    if kind is None and role is None and any(word in _FORCE_WORDS for word in words):
        kind = "force"
    if role is None and kind in ("torque", "force", "current"):
        role = "torque_nm"
    elif role is None and kind in ("angle", "counts"):
        role = "angle_deg"
    elif role is None and kind in ("time", "temperature") and len(words) <= 2:
        role = "time_s" if kind == "time" else "temperature_c"
    if role is not None and unit is not None and find_unit(unit, role) is None:
        role = None  # "torque error [%]", "position [mm]": the unit is of something else
    is_command = any(word in COMMAND or word.startswith("soll") for word in words)
    return Named(column, role, unit, kind, is_command, False, None if role == "run" else unknown)


def with_unit(named: Named, role: str, unit: str) -> Named:
    """Return what a name says with a unit that the user gives.

    Parameters
    ----------
    named : Named
        What name and unit say.
    role : str
        Canonical column.
    unit : str
        The unit.

    Returns
    -------
    Named

    Raises
    ------
    InputError
        For a unit of something else.
    """
    known = find_unit(unit, role)
    if known is None:
        flag = "--torque-unit" if role == "torque_nm" else "--angle-unit"
        raise InputError(f"{flag}: found {unit!r}, expected a unit such as {UNIT_EXAMPLES[role]}")
    return replace(named, unit=unit, kind=known.kind, is_canonical=False, unknown_unit=None)


def role_by_name(column: str) -> str | None:
    """Canonical column that a name stands for, whatever its unit."""
    bare = split_name(column)[0]
    return _role_of(bare.strip(), _words_of(bare))


def reads_like_a_date(column: str) -> bool:
    """Whether a name speaks of a date, below which times of day may stand, too.

    Examples
    --------
    >>> reads_like_a_date("Date"), reads_like_a_date("Messdatum"), reads_like_a_date("Data")
    (True, True, False)
    """
    return any(word == "date" or word.endswith("datum") for word in _words_of(column))


def reads_like_counts(column: str) -> bool:
    """Whether a name speaks of an encoder, whose whole numbers are counts."""
    return any(word in _COUNT_WORDS for word in _words_of(column))


def name_weight(cell: str) -> int:
    """How much a cell reads like the name of a column of a torsion test; 0: not at all.

    Examples
    --------
    >>> name_weight("Torque [lb in]"), name_weight("Winkel"), name_weight("Test"), name_weight("x")
    (3, 2, 1, 0)
    """
    named = describe(cell.strip())
    if named.role is None:
        return 0
    weight = 2 if named.role in ("torque_nm", "angle_deg") else 1
    return weight + (named.unit is not None and not named.is_canonical)


def _words_of(name: str) -> list[str]:
    """Words of a name in lower case, also of camelCase and with numbers split off."""
    spaced = re.sub(r"(?<=[a-zäöü])(?=[A-Z])", " ", name)
    return [word for word in re.split(r"[^a-zäöüßφθϕ]+", spaced.casefold()) if word]


def _role_of(name: str, words: list[str]) -> str | None:
    """Canonical column that a name stands for.

    Parameters
    ----------
    name : str
        Without its unit.
    words : list of str
        Its words in lower case.

    Returns
    -------
    str or None
    """
    for role, symbols in _SYMBOLS.items():
        if name in symbols:
            return role
    if name.casefold() in ("x_value", "test_nr", "run_nr"):
        return "time_s" if name.casefold() == "x_value" else "run"
    for role in ("temperature_c", "crank_deg", "torque_nm", "angle_deg", "run", "time_s"):
        if any(word in _WORDS[role] for word in words):
            return role
    for role, ending in (("torque_nm", "moment"), ("angle_deg", "winkel"), ("time_s", "zeit")):
        if any(word.endswith(ending) for word in words):  # German compounds
            return role
    return None
