"""What a file states of its columns against what the settings say: taken over, or refused."""

from pathlib import Path

from cyclosweep.errors import InputError
from cyclosweep.recording.faults import Fault
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.metadata import Column, Metadata, conversion
from cyclosweep.recording.roles import Named, describe
from cyclosweep.recording.units import MEANINGS, UNIT_EXAMPLES, find_unit, split_name

__all__ = ["contradiction", "stated_unit", "take_stated_units"]

SAME_FACTOR = 1e-3
"""Two units are one where their factors differ by less: nothing lies between an ounce-force inch
and its rounded values."""


def stated_unit(table: FileTable, column: str) -> tuple[str, bool] | None:
    """Find the unit that a file states for a column.

    Parameters
    ----------
    table : FileTable
        The file.
    column : str
        Name in the file.

    Returns
    -------
    tuple of str and bool, or None
        The unit, and whether nothing else can be meant: it has a row or property of its own, or
        stands in brackets and is more than one letter. None where no unit that is known stands
        there.
    """
    own = table.units.get(column)
    if own is not None:
        return (own, True) if find_unit(own) else None
    _, written, in_brackets = split_name(column)
    if written is None:
        return None
    return written, in_brackets and len(written) > 1


def take_stated_units(
    paths: tuple[Path, Path | None],
    meta: Metadata,
    table: FileTable,
    sources: dict[str, Column],
    notes: list[str],
) -> list[Fault]:
    """Convert from the unit that the file states, and hold what the settings say against it.

    Only a unit in brackets behind a name, or in a row or property of its own, is converted, where
    the settings give neither unit nor scale. Where they give another one, one of the two is wrong.

    Parameters
    ----------
    paths : tuple of Path and Path or None
        The recording's file and the metadata file, for messages.
    meta : Metadata
        What that says.
    table : FileTable
        With the stated units.
    sources : dict of str to Column
        File column of each canonical one; changed in place.
    notes : list of str
        Each unit that is converted is added to it.

    Returns
    -------
    list of Fault
        Remarks where a name speaks against the settings without stating a unit for certain.

    Raises
    ------
    InputError
        For a unit of something else, one that needs another number, or one that the settings
        contradict.
    """
    path, meta_path = paths
    remarks = _names_swapped(meta)
    for name, source in sources.items():
        if source.column not in table.header or name == "run":
            continue
        found = stated_unit(table, source.column)
        where = f"{meta_path}, key columns.{name}" if name in meta.columns else f"{path}"
        _refuse_wrong_replacement(where, source, found)
        if found is None and source.unit is None and source.scale == 1.0:
            _refuse_unknown(path, name, describe(source.column, table.units.get(source.column)))
        if found is None or source.instead_of is not None:
            continue
        stated, certain = found
        if name in meta.columns:
            against = contradiction(name, source, stated)
            if against is not None and certain:
                raise InputError(
                    f"{where}: {against}; if the file is wrong, add instead_of = {stated!r} to "
                    "this key"
                )
            if against is not None:
                remarks.append(
                    Fault("unit_contradicted", None, f"{against[0].upper()}{against[1:]}.")
                )
        if source.unit is not None or source.scale != 1.0:
            continue
        own = table.units.get(source.column)
        if own is None and not split_name(source.column)[2]:
            continue
        converted = source.model_copy(update={"unit": stated})
        try:
            factor, offset = conversion(name, converted)
        except ValueError as error:
            raise InputError(f"{path}, column {source.column}: {error}") from None
        sources[name] = converted
        if (factor, offset) != (1.0, source.offset):
            notes.append(f"{source.column} is in {stated}: times {factor:.6g} to {name}.")
    return remarks


def _refuse_wrong_replacement(where: str, source: Column, found: tuple[str, bool] | None) -> None:
    """Refuse `instead_of` that is not what the file states, or has no unit to replace it.

    Parameters
    ----------
    where : str
        File and key, for the message.
    source : Column
        What the settings say of the column.
    found : tuple of str and bool, or None
        Unit that the file states.

    Raises
    ------
    InputError
        With both.
    """
    if source.instead_of is None:
        return
    stated = None if found is None else found[0]
    if stated is None or find_unit(stated) != find_unit(source.instead_of):
        said = "states no unit" if stated is None else f"states {stated!r}"
        raise InputError(
            f"{where}: instead_of: found {source.instead_of!r}, but the file {said} for column "
            f"{source.column!r}"
        )


def _refuse_unknown(path: Path, name: str, stated: Named) -> None:
    """Refuse a unit that the file states and nobody knows, where the settings say nothing.

    Parameters
    ----------
    path : Path
        The recording's file.
    name : str
        Canonical column.
    stated : Named
        What name and unit of the file's column say.

    Raises
    ------
    InputError
        With the unit, and what would be one.
    """
    if stated.unknown_unit is not None and name in UNIT_EXAMPLES:
        raise InputError(
            f"{path}, column {stated.column}: unit {stated.unknown_unit!r} is not known, expected "
            f"{UNIT_EXAMPLES[name]}; give unit or scale under columns.{name} in the settings"
        )


def contradiction(name: str, source: Column, stated: str) -> str | None:
    """Say how the settings contradict the unit that a file states.

    Parameters
    ----------
    name : str
        Canonical column.
    source : Column
        What the settings say of it.
    stated : str
        What the file states.

    Returns
    -------
    str or None
        None where they agree; a `scale` alone is the way from whatever unit the file has.
    """
    own = find_unit(stated, name)
    other = find_unit(stated)
    if own is None and other is not None:
        return (
            f"column {source.column!r} is taken as {MEANINGS[name]}, but the file states "
            f"{stated!r} for it, a unit of {other.kind}"
        )
    said = None if source.unit is None else find_unit(source.unit, name)
    if own is None or said is None:
        return None
    same = abs(said.factor * source.scale - own.factor) <= SAME_FACTOR * own.factor
    if same and said.kind == own.kind and said.offset == own.offset:
        return None
    return (
        f"column {source.column!r} is in {stated!r} by the file and in {source.unit!r} by this key"
    )


def _names_swapped(meta: Metadata) -> list[Fault]:
    """Remark that the names of the columns say torque for the angle and angle for the torque."""
    torque, angle = meta.columns.get("torque_nm"), meta.columns.get("angle_deg")
    if torque is None or angle is None:
        return []
    roles = describe(torque.column).role, describe(angle.column).role
    if roles != ("angle_deg", "torque_nm"):
        return []
    return [
        Fault(
            "columns_swapped",
            None,
            f"The settings take column {torque.column!r} as the torque and {angle.column!r} as the "
            "angle: by their names they are swapped.",
        )
    ]
