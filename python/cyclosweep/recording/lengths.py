"""Columns that hold a length, from which an angle has to be computed first."""

import math
import re
from collections.abc import Iterable

from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.roles import Named

__all__ = ["is_length", "length_notes"]

MILLIMETRES = {
    "mm": 1.0, "cm": 10.0, "m": 1e3, "µm": 1e-3, "μm": 1e-3, "um": 1e-3, "in": 25.4, "inch": 25.4,
}  # fmt: skip
"""Millimetres in a unit of length."""
RADIUS_MM = 100.0
"""Radius for which the scale is given as an example [mm]."""

_IN_BRACKETS = re.compile(r"[\[({<]\s*(?P<unit>[^\[\](){}<>]*?)\s*[\])}>]\s*$")
_OF_EITHER = re.compile(r"(?<![a-z])(position|pos|displacement|deflection)(?![a-z])", re.I)
"""Names of an angle that are those of a length as well."""
_ENDING = re.compile(r"[_\s](?P<unit>mm|cm|µm|um)$")


def is_length(table: FileTable, named: Named) -> bool:
    """Whether a column is a length: by its unit, and by a name that may be of one.

    ``Angle [mm]`` contradicts itself, and is to be asked for. A word in round brackets may be about
    the column, as in ``position (in)``.

    Parameters
    ----------
    table : FileTable
        The file, with the units that it states.
    named : Named
        What the column's name says.

    Returns
    -------
    bool
    """
    may_be = named.role is None or _OF_EITHER.search(named.column) is not None
    if not may_be or named.unit is not None or _length(table, named.column) is None:
        return False
    return named.unknown_unit is not None or _ENDING.search(named.column) is not None


def length_notes(table: FileTable, names: Iterable[str]) -> list[str]:
    """Say of each column that holds a length how it becomes an angle.

    Parameters
    ----------
    table : FileTable
        The file, with the units that it states.
    names : iterable of str
        Columns of numbers that are not read.

    Returns
    -------
    list of str
        One line each.
    """
    notes = []
    for name in names:
        unit = _length(table, name)
        if unit is None:
            continue
        scale = math.degrees(MILLIMETRES[unit] / RADIUS_MM)
        notes.append(
            f"{name} holds a length ({unit}), no angle: where it is measured at a radius, write "
            f'angle_deg = {{ column = "{name}", scale = {scale:.4g} }} under [columns]; this scale '
            f"is for a radius of {RADIUS_MM:g} mm, in inverse proportion to it."
        )
    return notes


def _length(table: FileTable, name: str) -> str | None:
    """Unit of length that is stated for a column; None where it has another unit or none.

    Parameters
    ----------
    table : FileTable
        The file.
    name : str
        The column.

    Returns
    -------
    str or None
    """
    stated = table.units.get(name)
    if stated is None:
        match = _IN_BRACKETS.search(name) or _ENDING.search(name)
        stated = match["unit"] if match else ""
    unit = stated.strip().lower()
    return unit if unit in MILLIMETRES else None
