"""What a user says of a recording, and a proposed metadata file with what it rests on."""

from dataclasses import dataclass, field
from typing import Any

from cyclosweep.design.drive import Drive
from cyclosweep.design.nominal_line import Side
from cyclosweep.recording.metadata import Column, TableOptions, conversion
from cyclosweep.recording.samples import Floats

__all__ = ["Known", "Proposal", "values_of"]


@dataclass(frozen=True, slots=True)
class Known:
    """What the user says of a recording.

    Attributes
    ----------
    drive : Drive or None
        The drive, and `drive_name` as the metadata are to name it.
    drive_name : str or None
        Built-in name or file.
    side : {"input", "output"} or None
        Shaft of torque and angle.
    torque_unit, angle_unit : str or None
        Units that the file does not state.
    lever_arm_m, nm_per_a, counts_per_turn : float or None
        What a force, a current and counts of an encoder need.
    table : TableOptions
        Where the table stands.
    """

    drive: Drive | None = None
    drive_name: str | None = None
    side: Side | None = None
    torque_unit: str | None = None
    angle_unit: str | None = None
    lever_arm_m: float | None = None
    nm_per_a: float | None = None
    counts_per_turn: float | None = None
    table: TableOptions = field(default_factory=TableOptions)


@dataclass(slots=True)
class Proposal:
    """A metadata file and what it rests on.

    Attributes
    ----------
    meta : dict
        Tables of the file.
    remarks : dict of str to str
        Why, by key that the file does not state, ``"columns.angle_deg"`` for one in a table; empty
        where the reason is one of `assumed`.
    checks : list of str
        What looks wrong and should be looked at first.
    assumed : list of str
        What the recording does not say.
    open : list of str
        What must be said first.
    """

    meta: dict[str, Any] = field(default_factory=dict)
    remarks: dict[str, str] = field(default_factory=dict)
    checks: list[str] = field(default_factory=list)
    assumed: list[str] = field(default_factory=list)
    open: list[str] = field(default_factory=list)


def values_of(role: str, columns: dict[str, dict[str, Any]], numbers: dict[str, Floats]) -> Floats:
    """Values of a chosen column in its canonical unit.

    Parameters
    ----------
    role : str
        Canonical column.
    columns : dict
        Proposed columns.
    numbers : dict of str to ndarray of float, shape (rows,)
        Columns of the file.

    Returns
    -------
    ndarray of float, shape (rows,)
    """
    factor, offset = conversion(role, Column.model_validate(columns[role]))
    return numbers[columns[role]["column"]] * factor + offset
