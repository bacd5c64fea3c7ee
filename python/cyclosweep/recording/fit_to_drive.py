"""Unit of the angle, side and modulo of a recording, told by the drive where the file does not."""

from shlex import quote
from typing import Any

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.design.nominal_line import Side
from cyclosweep.recording.exchanged_columns import EXCHANGED, are_exchanged
from cyclosweep.recording.nominal import (
    FAR,
    MOST_LOAD,
    Guess,
    explain,
    overload,
    slope_of,
    unit_by_jumps,
    unit_by_steps,
)
from cyclosweep.recording.proposed import Known, Proposal, values_of
from cyclosweep.recording.roles import Named
from cyclosweep.recording.samples import Floats
from cyclosweep.recording.signals import unwrap, wraps_at_360

__all__ = ["fit_to_drive"]


def fit_to_drive(
    numbers: dict[str, Floats],
    columns: dict[str, dict[str, Any]],
    angle: Named,
    known: Known,
    made: Proposal,
    *,
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
    torque = values_of("torque_nm", columns, numbers)
    column = columns["angle_deg"]
    stated = is_settled or "unit" in column or angle.is_canonical
    if not stated:
        made.remarks["columns.angle_deg"] = ""
        stated = _unit_without_drive(values_of("angle_deg", columns, numbers), torque, angle,
                                     column, made)  # fmt: skip
    turned = values_of("angle_deg", columns, numbers)
    period = column.get("modulo") or (_period(turned, torque, known.drive) if stated else None)
    slope = slope_of(torque, _unwrapped(turned, torque, period))
    guess = None
    if known.drive is not None and slope is not None:
        largest = float(np.nanmax(np.abs(torque)))
        guess = explain(slope, known.drive, "deg" if stated else None, known.side, largest)
        if known.side is not None and overload(largest, known.drive, known.side) > MOST_LOAD:
            made.checks.append(
                f"The torque reaches {overload(largest, known.drive, known.side):.0f} times the "
                f"rated one of the {known.side} shaft: check unit, side and drive."
            )
    if not stated and guess is None:
        made.assumed.append(f"Unit of {angle.column} not stated: degrees assumed (--angle-unit).")
    if guess is not None:
        _take(guess, angle, column, known, made, is_stated=stated, is_settled=is_settled)
        if not guess.clear:
            _suspect_exchange(torque, turned, columns, known, made)
    if not stated:
        period = _period(values_of("angle_deg", columns, numbers), torque, known.drive)
    if period is not None and "modulo" not in column:
        column["modulo"] = period
        made.remarks["columns.angle_deg"] = ""
        made.assumed.append(f"{angle.column} jumps by {period:g} deg: known modulo that.")


def _unit_without_drive(
    angle: Floats, torque_nm: Floats, named: Named, column: dict[str, Any], made: Proposal
) -> bool:
    """Tell the unit of an angle by the steps of its encoder, or by jumps of a turn.

    Parameters
    ----------
    angle : ndarray of float, shape (rows,)
        Angle in the file's unit.
    torque_nm : ndarray of float, shape (rows,)
        Torque [N m].
    named : Named
        What name and unit of the angle say.
    column : dict
        Proposed column; the unit is added to it.
    made : Proposal
        The assumption is added to it.

    Returns
    -------
    bool
        Whether it is told.
    """
    unit, why = unit_by_steps(angle), "by its steps, of which a power of two make a turn"
    if unit is None:
        unit, why = unit_by_jumps(angle, torque_nm), "by its jumps of a whole turn"
    if unit is None:
        return False
    if unit != "deg":
        column["unit"] = unit
    made.assumed.append(f"Unit of {named.column} not stated: {unit}, {why}.")
    return True


def _unwrapped(angle_deg: Floats, torque_nm: Floats, period: float | None) -> Floats:
    """Undo the wraps of an angle: of its modulo, or of a dial's turn.

    Parameters
    ----------
    angle_deg : ndarray of float, shape (rows,)
        Angle [deg].
    torque_nm : ndarray of float, shape (rows,)
        Torque [N m].
    period : float or None
        The modulo [deg].

    Returns
    -------
    ndarray of float, shape (rows,)
    """
    if period is None:
        known = np.isfinite(angle_deg) & np.isfinite(torque_nm)
        period = 360.0 if wraps_at_360(angle_deg[known], torque_nm[known]) else None
    return angle_deg if period is None else unwrap(angle_deg, period)[0]


def _take(
    guess: Guess,
    angle: Named,
    column: dict[str, Any],
    known: Known,
    made: Proposal,
    *,
    is_stated: bool,
    is_settled: bool,
) -> None:
    """Take unit and side with which the recording fits its drive, or ask.

    Parameters
    ----------
    guess : Guess
        Unit and side that fit best.
    angle : Named
        What name and unit of the angle say.
    column : dict
        Proposed column of the angle; its unit is added.
    known : Known
        What the user says.
    made : Proposal
        Side, assumptions and questions are added to it.
    is_stated : bool
        The unit is known.
    is_settled : bool
        The settings say it: a diagnosis goes by them, and says itself what does not fit.
    """
    if guess.clear:
        reason = f"the compliance is then {guess.factor:.2f} times the drive's"
        if not is_stated:
            if guess.unit != "deg":
                column["unit"] = guess.unit
            made.assumed.append(f"Unit of {angle.column} not stated: {guess.unit}, {reason}.")
        if known.side is None:
            _take_side(guess, made, f"{guess.side} shaft, {reason}")
        return
    text = f"the compliance is {guess.factor:.3g} times the drive's at the {guess.side} shaft"
    which = "the nearer of the two"
    if known.side is None and guess.shafts == 1:
        which = "the only one that bears the torque"
        text += f", {which}"
    elif known.side is None or not is_stated:
        text += ", the nearest of all"
    if not is_stated:
        side = "" if known.side is not None else " and --side SIDE"
        made.open.append(
            f"{angle.column} states no unit, and none fits the drive clearly: in {guess.unit} "
            f"{text}. Say --angle-unit UNIT{side}."
        )
    elif known.side is None and not is_settled and not 1 / FAR < guess.factor < FAR:
        made.open.append(
            f"Neither side fits the drive: in these units {text}. Check unit and drive, or say "
            "--side SIDE."
        )
    else:
        made.checks.append(f"In these units {text}: check units, side and drive.")
    if known.side is None:
        _take_side(guess, made, f"{guess.side} shaft, {which}")


def _suspect_exchange(
    torque: Floats,
    angle: Floats,
    columns: dict[str, dict[str, Any]],
    known: Known,
    made: Proposal,
) -> None:
    """Remark on torque and angle that look exchanged, with the options that exchange them.

    Parameters
    ----------
    torque, angle : ndarray of float, shape (rows,)
        As they are read [N m], [deg].
    columns : dict
        Proposed columns.
    known : Known
        With the drive, and the side where the user gives it.
    made : Proposal
        What is to be checked is added to it.
    """
    assert known.drive is not None
    sides: tuple[Side, ...] = ("input", "output") if known.side is None else (known.side,)
    for side in sides:
        if are_exchanged(torque, angle, known.drive.nominal_line(side).compliance_deg_per_nm):
            of_torque, of_angle = (quote(columns[r]["column"]) for r in ("angle_deg", "torque_nm"))
            made.checks.append(
                f"The compliance at the {side} shaft is as where {EXCHANGED}: if that is so, say "
                f"--torque {of_torque} --angle {of_angle}."
            )
            return


def _take_side(guess: Guess, made: Proposal, why: str) -> None:
    """Take the side that is guessed.

    Parameters
    ----------
    guess : Guess
        With the side.
    made : Proposal
        It is added to it.
    why : str
        Side and reason.
    """
    made.meta["side"] = guess.side
    made.remarks["side"] = ""
    made.assumed.append(f"Side not given: {why}.")


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
