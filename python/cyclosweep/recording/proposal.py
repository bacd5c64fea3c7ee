"""The metadata file that a recording needs, proposed from its names, units, numbers and drive."""

from collections.abc import Mapping
from shlex import quote
from typing import Any

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.errors import InputError
from cyclosweep.recording.cells import BadCellError
from cyclosweep.recording.choosing import Choice
from cyclosweep.recording.file_table import FileTable
from cyclosweep.recording.metadata import Column
from cyclosweep.recording.nominal import explain, slope_of, unit_by_steps
from cyclosweep.recording.proposed import Known, Proposal, values_of
from cyclosweep.recording.roles import Named, with_unit
from cyclosweep.recording.run_proposal import propose_limit, propose_runs, propose_ticks
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import unwrap
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
    for named in choice.roles.values():
        if named.column in bad:
            cell, flag = bad[named.column], f"--missing {quote(bad[named.column].cell)}"
            made.open.append(f"{cell.where}. Mend the cell, or pass over such rows: {flag}.")
    dated = {name for name in table.header if any(f"{name} holds " in n for n in table.notes)}
    columns = {
        role: dict(settled.get(role) or _column(role, n, known, made, n.column in dated))
        for role, n in choice.roles.items()
    }
    options = known.table.model_dump(exclude_defaults=True)
    if options:
        made.meta["table"] = options
    torque = choice.roles.get("torque_nm")
    angle = choice.roles.get("angle_deg")
    if torque is not None and angle is not None and not made.open:
        _fit_to_drive(numbers, columns, angle, known, made, "angle_deg" in settled)
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


def _column(
    role: str, named: Named, known: Known, made: Proposal, is_dated: bool
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
    is_dated : bool
        The column holds dates or times of day.

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
    elif is_dated:
        return column
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
            made.open.append(f"{said}.")
        else:
            column[key] = value
    return column


def _fit_to_drive(
    numbers: dict[str, Floats],
    columns: dict[str, dict[str, Any]],
    angle: Named,
    known: Known,
    made: Proposal,
    is_settled: bool,
) -> None:
    """Tell unit of the angle, side and modulo by the drive where the file does not.

    Parameters
    ----------
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.
    columns : dict
        Proposed columns; the angle's is completed.
    angle : Named
        What name and unit of the angle say.
    known : Known
        What the user says.
    made : Proposal
        Side, assumptions and questions are added to it.
    is_settled : bool
        The settings say how the angle is read.
    """
    torque, turned = (
        values_of("torque_nm", columns, numbers),
        values_of("angle_deg", columns, numbers),
    )
    stated = is_settled or angle.unit is not None or angle.is_canonical
    by_steps = None if stated else unit_by_steps(turned)
    if by_steps is not None:
        if by_steps != "deg":
            columns["angle_deg"]["unit"] = by_steps
        turned = values_of("angle_deg", columns, numbers)
        made.assumed.append(
            f"Unit of {angle.column} not stated: {by_steps}, by its steps, of which a power of two "
            "make a turn."
        )
        stated = True
    slope = slope_of(torque, turned)
    guess = None
    if known.drive is not None and slope is not None:
        guess = explain(slope, known.drive, "deg" if stated else None, known.side)
    if not (is_settled or angle.unit is not None or angle.is_canonical):
        made.remarks["columns.angle_deg"] = ""
    if not stated and guess is None:
        made.assumed.append(f"Unit of {angle.column} not stated: degrees assumed (--angle-unit).")
    if guess is not None and not guess.clear:
        text = (
            f"the compliance is {guess.factor:.3g} times the drive's at the {guess.side} shaft, "
            "the nearest of all"
        )
        if stated:
            made.checks.append(f"In these units {text}: check units, side and drive.")
        else:
            made.open.append(
                f"{angle.column} states no unit, and none fits the drive: in {guess.unit} {text}. "
                "Say --angle-unit UNIT."
            )
        if known.side is None:
            made.meta["side"] = guess.side
            made.remarks["side"] = ""
            made.assumed.append(f"Side not given: {guess.side} shaft, the nearer of the two.")
    if guess is not None and guess.clear:
        reason = f"the compliance is then {guess.factor:.2f} times the drive's"
        if not stated and guess.unit != "deg":
            columns["angle_deg"]["unit"] = guess.unit
        if not stated:
            made.assumed.append(f"Unit of {angle.column} not stated: {guess.unit}, {reason}.")
        if known.side is None:
            made.meta["side"] = guess.side
            made.remarks["side"] = ""
            made.assumed.append(f"Side not given: {guess.side} shaft, {reason}.")
    if "modulo" in columns["angle_deg"]:
        return
    period = _period(values_of("angle_deg", columns, numbers), torque, known.drive)
    if period is not None:
        columns["angle_deg"]["modulo"] = period
        made.remarks["columns.angle_deg"] = ""
        made.assumed.append(f"{angle.column} jumps by {period:g} deg: known modulo that.")


def _period(angle_deg: Floats, torque_nm: Floats, drive: Drive | None) -> float | None:
    """Period of an angle that wraps, of those that encoders have.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (n,)
        Angle [deg].
    torque_nm : ndarray of float, shape (n,)
        Torque [N m].
    drive : Drive or None
        With the ratio of a geared encoder.

    Returns
    -------
    float or None
        The period [deg]; None where it does not wrap, or by a dial's 360 deg, which reading undoes.
    """
    known = np.isfinite(angle_deg) & np.isfinite(torque_nm)
    angle, torque = angle_deg[known], torque_nm[known]
    if len(angle) < 3 or not np.ptp(torque):
        return None
    span = float(np.ptp(angle))
    for period in [360.0 / drive.ratio] if drive is not None else []:
        jumps = np.count_nonzero(np.abs(np.diff(angle)) > 0.5 * period)
        if not jumps or not 0.8 * period < span <= 1.001 * period:
            continue
        whole, _ = unwrap(angle, period)
        if abs(np.corrcoef(whole, torque)[0, 1]) > abs(np.corrcoef(angle, torque)[0, 1]):
            return float(f"{period:.7g}")
    return None
