"""The TOML file beside a recording that says how to read it."""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    field_validator,
    model_validator,
)

from cyclosweep.design.toml_files import TomlTable, read_as, read_toml
from cyclosweep.recording.units import QUANTITIES, UNIT_EXAMPLES, find_unit

CANONICAL_COLUMNS = ("torque_nm", "angle_deg", "time_s", "run", "crank_deg", "temperature_c")
"""Column names of a recording, each with its unit."""

APART = ("torque_nm", "angle_deg", "time_s")
"""Canonical columns of which no two come from one column; a position may be told by the angle."""

CanonicalName = Literal["torque_nm", "angle_deg", "time_s", "run", "crank_deg", "temperature_c"]
SelectValue = int | float | str


class _Strict(TomlTable):
    """A table of the metadata file; numbers are finite."""

    model_config = ConfigDict(allow_inf_nan=False)


class Column(_Strict):
    """Where a canonical column comes from.

    Attributes
    ----------
    column : str
        Its name in the file.
    unit : str or None
        Unit of the file, for example "mrad" or "lbf in"; None: the one that the file states, and
        where it states none the canonical one.
    scale : float
        Factor after the unit; without a unit, from the file's unit to the canonical one.
    offset : float
        Added after scaling [canonical unit].
    modulo : float or None
        The value is known only up to a multiple of this [canonical unit]; steps beyond half of it
        are taken as a wrap.
    counts_per_turn : float or None
        Counts of the encoder in one turn of the shaft at which the twist is wanted.
    lever_arm_m : float or None
        Lever arm at which a force was measured [m].
    nm_per_a : float or None
        Torque that one ampere makes at the shaft at which it is wanted [N m/A].
    instead_of : str or None
        Unit that the file states for this column and that is wrong there; `unit` replaces it.
    """

    column: str
    unit: str | None = None
    scale: float = 1.0
    offset: float = 0.0
    modulo: float | None = Field(default=None, gt=0)
    counts_per_turn: float | None = Field(default=None, gt=0)
    lever_arm_m: float | None = Field(default=None, gt=0)
    nm_per_a: float | None = Field(default=None, gt=0)
    instead_of: str | None = None

    @model_validator(mode="after")
    def _scale_is_not_zero(self) -> Self:
        if self.scale == 0:
            raise ValueError("scale must not be 0")
        return self


class TableOptions(_Strict):
    """Where the table stands in its file and how numbers are spelt; found out where absent.

    Attributes
    ----------
    sheet : str or None
        Sheet of a workbook, group of a TDMS file, structure of a MATLAB, HDF5 or JSON file.
    header_row : int or None
        Line or row of the names, from 1.
    decimal, thousands : str or None
        Decimal sign, and sign between groups of three digits.
    missing : list of str
        Texts in cells that stand for a value that is not there, besides the usual ones; rows
        without a torque, angle or time are passed over.
    """

    sheet: str | None = None
    header_row: int | None = Field(default=None, ge=1)
    decimal: Literal[".", ","] | None = None
    thousands: Literal[".", ",", "'", " "] | None = None
    missing: list[str] = Field(default_factory=list)


class Merge(_Strict):
    """Which neighbouring rows are averaged into one.

    Attributes
    ----------
    same_time : bool
        Average consecutive rows of one run that share a clock tick.
    neighbours : int
        Average so many consecutive rows of one run, after `same_time`; 1: none. A mean never
        reaches over a reversal of the torque.
    """

    same_time: bool = False
    neighbours: int = Field(default=1, ge=1)


class Score(_Strict):
    """Which rows are fitted and scored.

    Attributes
    ----------
    abs_max : dict
        Largest magnitude of a row that counts, by column. Rows beyond are simulated for their
        effect on the state, neither fitted nor scored.
    """

    abs_max: dict[str, float] = Field(default_factory=dict)


def conversion(name: str, source: Column) -> tuple[float, float]:
    """Way from the file's unit to the canonical one.

    Parameters
    ----------
    name : str
        Canonical column.
    source : Column
        Its unit and what goes with it.

    Returns
    -------
    factor, offset : float
        Canonical value = factor * value + offset.

    Raises
    ------
    ValueError
        For a unit of something else, or one that needs another number.
    """
    given = {
        "counts": ("counts_per_turn", source.counts_per_turn),
        "force": ("lever_arm_m", source.lever_arm_m),
        "current": ("nm_per_a", source.nm_per_a),
    }
    unit = None
    if source.unit is not None:
        unit = find_unit(source.unit, name)
        if unit is None:
            examples = UNIT_EXAMPLES.get(name)
            expected = f"a unit such as {examples}" if examples else "no unit"
            raise ValueError(f"unit: found {source.unit!r}, expected {expected}")
    kind = None if unit is None else unit.kind
    factor, offset = (1.0, 0.0) if unit is None else (unit.factor, unit.offset)
    for needed_by, (key, value) in given.items():
        allowed = kind == needed_by or (unit is None and needed_by in QUANTITIES[name])
        if value is not None and not allowed:
            raise ValueError(f"{key} belongs to a unit of {needed_by}")
        if kind == needed_by and value is None:
            raise ValueError(
                f"unit {source.unit!r} is a unit of {needed_by}: {key} must be given, too"
            )
        if value is not None:
            factor *= 360.0 / value if needed_by == "counts" else value
    return factor * source.scale, offset * source.scale + source.offset


def _named_column(value: object) -> object:
    """Accept the short form ``torque_nm = "TORQUE"``."""
    return {"column": value} if isinstance(value, str) else value


class Metadata(_Strict):
    """How a recording is read, and what is known about it.

    Attributes
    ----------
    side : {"input", "output"} or None
        Shaft at which torque and angle were measured.
    drive : str or None
        Built-in name, or a drive file beside the metadata file.
    torque_from : {"sensor", "motor-current"}
        Where the torque comes from: a sensor, or computed from the current of a motor.
    angle_resolution_deg : float or None
        Step of the angle reading [deg]; 0 or None: continuous.
    history : {"per-run", "continuous"}
        Whether play, slip and creep start afresh with every run.
    reset_between_runs : bool
        The rig was reset, so that the datum cannot remember earlier runs either.
    conditioning_runs, holdout_runs : list of int
        Runs that are simulated only, and runs that are kept for the verdict.
    conditions : dict
        What was set or varied in the test, by name: a step of preload, a lubricant.
    conditions_from_name : str or None
        Regular expression with named groups that reads conditions from the name of the file.
    lost_motion_runs : list of int
        Runs of small loops that are not diagnosed: in a series their lost motion is read.
    table : TableOptions
        Where the table stands in its file, and how numbers are spelt.
    columns : dict
        File column, unit, scale and modulo of each canonical column that differs.
    select : dict
        Values to keep, by column; `abs_max` limits magnitudes.
    score : Score
        Rows that are fitted and scored; the others are only simulated.
    merge : Merge
        Rows to average.
    """

    side: Literal["input", "output"] | None = None
    drive: str | None = None
    torque_from: Literal["sensor", "motor-current"] = "sensor"
    angle_resolution_deg: float = Field(default=0.0, ge=0)
    history: Literal["per-run", "continuous"] = "per-run"
    reset_between_runs: bool = False
    conditioning_runs: list[int] = Field(default_factory=list)
    holdout_runs: list[int] = Field(default_factory=list)
    conditions: dict[str, float | str] = Field(default_factory=dict)
    conditions_from_name: str | None = None
    lost_motion_runs: list[int] = Field(default_factory=list)
    table: TableOptions = Field(default_factory=TableOptions)
    columns: dict[CanonicalName, Annotated[Column, BeforeValidator(_named_column)]] = Field(
        default_factory=dict
    )
    select: dict[str, list[SelectValue] | dict[str, float]] = Field(default_factory=dict)
    score: Score = Field(default_factory=Score)
    merge: Merge = Field(default_factory=Merge)

    @model_validator(mode="after")
    def _units_fit_their_columns(self) -> Self:
        for name, source in self.columns.items():
            try:
                conversion(name, source)
            except ValueError as error:
                raise ValueError(f"columns.{name}: {error}") from None
        return self

    @field_validator("conditions_from_name")
    @classmethod
    def _names_groups(cls, pattern: str | None) -> str | None:
        if pattern is not None:
            try:
                groups = re.compile(pattern).groupindex
            except re.error as error:
                raise ValueError(
                    f"found {pattern!r}, expected a regular expression ({error})"
                ) from None
            if not groups:
                raise ValueError(
                    f"found {pattern!r}, expected named groups such as (?P<preload>[0-9]+)"
                )
        return pattern

    @model_validator(mode="after")
    def _select_is_lists_and_limits(self) -> Self:
        for key, value in self.select.items():
            if (key == "abs_max") != isinstance(value, dict):
                expected = "a table of limits" if key == "abs_max" else "a list of values"
                raise ValueError(f"select.{key}: expected {expected}")
        both = set(self.conditioning_runs) & set(self.holdout_runs)
        if both:
            raise ValueError(f"run {min(both)} is both a conditioning and a holdout run")
        return self

    @property
    def keep(self) -> dict[str, list[SelectValue]]:
        """Values to keep, by column."""
        return {key: value for key, value in self.select.items() if isinstance(value, list)}

    def of_small_loops(self) -> Self:
        """The same file, of which the runs of small loops are read and nothing else."""
        runs: list[SelectValue] = list(self.lost_motion_runs)
        return self.model_copy(
            update={
                "select": {**self.select, "run": runs},
                "score": Score(),
                "conditioning_runs": [],
                "holdout_runs": [],
            }
        )

    @property
    def abs_max(self) -> Mapping[str, float]:
        """Largest magnitude to keep, by column."""
        limits = self.select.get("abs_max", {})
        return limits if isinstance(limits, dict) else {}

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read a metadata file.

        Raises
        ------
        InputError
            The file is missing, is not TOML, or has a key or value that is not known.
        """
        return read_as(cls, "metadata of a recording", read_toml(path), path)
