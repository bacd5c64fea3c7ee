"""The metadata file that a recording needs, proposed from its names, units, numbers and drive."""

from collections.abc import Mapping
from dataclasses import replace
from shlex import quote
from typing import Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.recording.cells import BadCellError
from cyclosweep.recording.choosing import Choice
from cyclosweep.recording.clocks import unit_of_count
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.fit_to_drive import fit_to_drive
from cyclosweep.recording.metadata import Column
from cyclosweep.recording.proposed import Known, Proposal
from cyclosweep.recording.roles import Named, reads_like_counts, with_unit
from cyclosweep.recording.run_proposal import propose_limit, propose_runs, propose_ticks
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.stated_units import contradiction, stated_unit
from cyclosweep.recording.units import UNIT_EXAMPLES, find_unit

__all__ = ["propose"]

_WAYS = {"torque_nm": "say --torque-unit UNIT", "angle_deg": "say --angle-unit UNIT"}
_KINDS = {"force": "a force", "current": "a current", "counts": "counts of an encoder"}


def propose(
    table: FileTable,
    numbers: dict[str, Floats],
    choice: Choice,
    known: Known,
    bad: Mapping[str, BadCellError],
    settled: Mapping[str, dict[str, Any]],
) -> Proposal:
    """Propose the metadata of a recording.

    Parameters
    ----------
    table : FileTable
        The file.
    numbers : dict of str to ndarray of float, shape (rows,)
        Its columns of numbers.
    choice : Choice
        Which of them is what.
    known : Known
        What the user says.
    bad : mapping of str to BadCellError
        Columns of numbers in which texts stand.
    settled : mapping of str to dict
        Columns that the settings say, by canonical column.

    Returns
    -------
    Proposal
    """
    made = Proposal(assumed=list(choice.assumed), open=list(choice.open))
    for role, unit in (("torque_nm", known.torque_unit), ("angle_deg", known.angle_unit)):
        if unit is not None and role in choice.roles:
            choice.roles[role] = _with_unit(table, choice.roles[role], role, unit)
    if "angle_deg" in choice.roles:
        choice.roles["angle_deg"] = _with_counts(choice.roles["angle_deg"], numbers, known)
    for named in choice.roles.values():
        if named.column in bad:
            cell, flag = bad[named.column], f"--missing {quote(bad[named.column].cell)}"
            made.open.append(f"{cell.where}. Mend the cell, or pass over such rows: {flag}.")
    dated = {name for name in table.header if any(f"{name} holds " in n for n in table.notes)}
    columns = {
        role: dict(
            settled.get(role)
            or _column(role, n, known, made, None if n.column in dated else numbers[n.column])
        )
        for role, n in choice.roles.items()
    }
    options = known.table.model_dump(exclude_defaults=True)
    if options:
        made.meta["table"] = options
    torque = choice.roles.get("torque_nm")
    angle = choice.roles.get("angle_deg")
    if torque is not None and angle is not None and not made.open:
        fit_to_drive(numbers, columns, angle, known, made, is_settled="angle_deg" in settled)
    if known.side is not None:
        made.meta["side"] = known.side
    if known.drive_name is not None:
        made.meta["drive"] = known.drive_name
    elif angle is not None:
        made.assumed.append("No drive named: give --drive, here or to diagnose.")
    if "side" not in made.meta and angle is not None:
        made.meta["side"] = "input"
        made.remarks["side"] = ""
        made.assumed.append("Side not given: taken as the input shaft (--side).")
    if choice.current is not None:
        made.meta["torque_from"] = "motor-current"
    for role, column in columns.items():
        named = choice.roles[role]
        if column != {"column": role} or not named.is_canonical:
            short = column["column"] if len(column) == 1 else column
            made.meta.setdefault("columns", {})[role] = short
    if torque is not None and not made.open:
        propose_runs(numbers, choice, columns, made)
        propose_ticks(numbers, choice, made)
        propose_limit(numbers, choice, made)
    return made


def _with_unit(table: FileTable, named: Named, role: str, unit: str) -> Named:
    """Take a unit that the user gives, unless the file states another.

    Parameters
    ----------
    table : FileTable
        The file.
    named : Named
        What name and unit of the column say.
    role : str
        Canonical column.
    unit : str
        What the user gives.

    Returns
    -------
    Named

    Raises
    ------
    InputError
        For a unit of something else, or where the file states another.
    """
    found = with_unit(named, role, unit)
    stated = stated_unit(table, named.column)
    if stated is not None and stated[1]:
        against = contradiction(role, Column(column=named.column, unit=unit), stated[0])
        if against is not None:
            flag = "--torque-unit" if role == "torque_nm" else "--angle-unit"
            raise InputError(
                f"{flag}: found {unit!r}, but the file states {stated[0]!r} for column "
                f"{named.column!r}; leave the option out, or, if the file is wrong, write unit and "
                f"instead_of = {stated[0]!r} under columns.{role} in the settings"
            )
    return found


def _with_counts(angle: Named, numbers: dict[str, Floats], known: Known) -> Named:
    """Take an angle without a unit as counts where the user, or its whole numbers and name say so.

    Parameters
    ----------
    angle : Named
        What name and unit of the angle say.
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    known : Known
        What the user says.

    Returns
    -------
    Named
    """
    if angle.unit is not None or angle.unknown_unit is not None or angle.is_canonical:
        return angle
    values = numbers[angle.column]
    values = values[np.isfinite(values)]
    whole = bool((values == np.rint(values)).all()) and reads_like_counts(angle.column)
    return replace(angle, kind="counts") if whole or known.counts_per_turn else angle


def _column(
    role: str, named: Named, known: Known, made: Proposal, values: Floats | None
) -> dict[str, Any]:
    """Column, unit and what the unit needs.

    Parameters
    ----------
    role : str
        Canonical column.
    named : Named
        What name and unit say.
    known : Known
        What the user says.
    made : Proposal
        What is assumed or open is added to it.
    values : ndarray of float, shape (rows,), or None
        Its numbers; None where they are dates or times of day, which need no unit.

    Returns
    -------
    dict
    """
    column: dict[str, Any] = {"column": named.column}
    if named.unknown_unit is not None:
        way = _WAYS.get(role, f"give unit or scale under columns.{role} in settings for --meta")
        made.open.append(
            f"{named.column}: unit {named.unknown_unit!r} is not known, expected "
            f"{UNIT_EXAMPLES[role]}; {way}."
        )
        return column
    if named.is_canonical or role == "run":
        stated = find_unit(named.unit, role) if named.unit is not None else None
        if stated is not None and (stated.factor, stated.offset) != (1.0, 0.0):
            column["unit"] = named.unit
        return column
    if named.unit is not None:
        column["unit"] = named.unit
    elif values is None:
        return column
    elif role == "time_s" and (count := unit_of_count(values)) is not None:
        column["unit"], since = count
        made.assumed.append(f"Unit of {named.column} not stated: {column['unit']}, by {since}.")
        made.remarks[f"columns.{role}"] = ""
    elif named.kind == "force":
        if known.lever_arm_m is not None:
            column["unit"] = "N"
            made.assumed.append(f"Unit of {named.column} not stated: N assumed.")
            made.remarks[f"columns.{role}"] = ""
    elif role in ("time_s", "temperature_c", "torque_nm") and named.kind != "current":
        unit = {"time_s": "seconds", "temperature_c": "deg C", "torque_nm": "N m"}[role]
        made.assumed.append(f"Unit of {named.column} not stated: {unit} assumed.")
        made.remarks[f"columns.{role}"] = ""
    needs = {
        "force": ("lever_arm_m", known.lever_arm_m, "--lever-arm M"),
        "current": ("nm_per_a", known.nm_per_a, "--nm-per-a K"),
        "counts": ("counts_per_turn", known.counts_per_turn, "--counts-per-turn N"),
    }
    if named.kind in needs:
        key, value, flag = needs[named.kind]
        if value is None:
            said = f"{named.column} holds {_KINDS[named.kind]}: say {flag}"
            if named.kind == "force" and named.unit is None:  # its name alone says so
                said += ", or, where it is a torque, --torque-unit 'N m'"
            if named.kind == "counts" and named.unit is None:
                said += ", or, where it is an angle, --angle-unit UNIT"
            made.open.append(f"{said}.")
        else:
            column[key] = value
            if named.kind == "counts":
                column["unit"] = named.unit or "counts"
    return column
