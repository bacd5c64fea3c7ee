"""The TOML file of a study: its drive, axes, sampling, limits and objective."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal

import polars as pl
from pydantic import Field, ValidationError

from cyclosweep.design.drive import Drive
from cyclosweep.design.toml_files import TomlTable, one_line, read_as, read_toml
from cyclosweep.errors import InputError
from cyclosweep.plugins import Column
from cyclosweep.sweep.axes import Linspace, input_column, is_count, known_input
from cyclosweep.sweep.derived import check_new_name
from cyclosweep.sweep.distributions import distribution_from
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.space import Method, Space
from cyclosweep.sweep.study_checks import check_parts
from cyclosweep.sweep.table_files import read_filled_rows

__all__ = ["StudyFile", "read_study_file"]


def read_study_file(path: str | Path) -> StudyFile:
    """Read a study file.

    Parameters
    ----------
    path : str or Path
        The file.

    Returns
    -------
    StudyFile

    Raises
    ------
    InputError
        One line that names the file, the key, what was found and what was expected.
    """
    return read_as(StudyFile, "a study", read_toml(path), path)


class _Sample(TomlTable):
    method: Method = "grid"
    count: int | None = Field(default=None, gt=0)
    seed: int = Field(default=0, ge=0)
    file: str | None = None


class _Range(TomlTable):
    start: float = Field(alias="from", allow_inf_nan=False)
    stop: float = Field(alias="to", allow_inf_nan=False)
    steps: int | None = Field(default=None, ge=1)


class _Values(TomlTable):
    values: list[float | str] = Field(min_length=1)


class _Limit(TomlTable):
    min: float | None = None
    max: float | None = None


class _ObjectiveTable(TomlTable):
    minimise: str | None = None
    maximise: str | None = None

    def objective(self) -> Objective:
        if (self.minimise is None) == (self.maximise is None):
            raise InputError("objective: expected either minimise or maximise")
        return Objective(self.minimise or self.maximise or "", self.maximise is not None)


class _OwnColumn(TomlTable):
    expression: str
    unit: str = ""
    meaning: str = ""


class StudyFile(TomlTable):
    """The tables of a study file."""

    drive: str = "reference-87"
    loads_tn: list[float] | None = None
    model: Literal["published", "components"] | None = None
    solver: Literal["quadratic", "full"] | None = None
    sample: _Sample = _Sample()
    axes: dict[str, dict[str, Any]] = Field(default_factory=dict)
    limits: dict[str, _Limit] = Field(default_factory=dict)
    objective: dict[str, Any] | list[dict[str, Any]] | None = None
    derived: dict[str, str | float] = Field(default_factory=dict)
    constraints: dict[str, str] = Field(default_factory=dict)
    columns: list[str] | dict[str, Any] = Field(default_factory=dict)
    only_ok: bool = False

    def space(self, folder: Path) -> Space:
        """Return the file's space; files that it names are taken from ``folder``."""
        drive = Drive.load(self.drive, beside=folder)
        is_table = self.sample.method == "table"
        space = self._table(drive, folder) if is_table else self._drawn(drive)
        space = space.derive(**self.derived) if self.derived else space
        if self.model == "components":
            check_parts(drive, space.varying)
        return space

    def bounds(self) -> dict[str, tuple[float | None, float | None]]:
        """Least and greatest value of each limited column, None where there is none."""
        return {name: (limit.min, limit.max) for name, limit in self.limits.items()}

    def chosen_objectives(self) -> list[Objective]:
        """What the best variants are best in; none where the file does not say."""
        given = self.objective
        tables = given if isinstance(given, list) else [given] if given is not None else []
        try:
            return [_ObjectiveTable.model_validate(table).objective() for table in tables]
        except ValidationError as error:
            raise InputError(f"objective.{one_line(error, _ObjectiveTable)}") from None

    def own_columns(self) -> dict[str, Column]:
        """Columns that the file defines: the tables below ``columns``."""
        found = {}
        for name, table in self.columns.items() if isinstance(self.columns, dict) else ():
            if name == "keep" and isinstance(table, list):
                continue
            check_new_name("columns", name)
            try:
                own = _OwnColumn.model_validate(table)
            except ValidationError as error:
                raise InputError(f"columns.{name}.{one_line(error, _OwnColumn)}") from None
            found[name] = Column(own.expression, own.unit, own.meaning)
        return found

    def kept_columns(self) -> list[str] | None:
        """Columns to keep: ``columns`` as a list, or ``columns.keep``; None for all."""
        kept = self.columns if isinstance(self.columns, list) else self.columns.get("keep")
        if isinstance(kept, dict):
            return None
        if kept is not None and not all(isinstance(name, str) for name in kept):
            raise InputError(f"columns.keep: found {kept!r}, expected names of columns")
        return kept

    def _table(self, drive: Drive, folder: Path) -> Space:
        if self.sample.file is None:
            raise InputError("sample.file: missing, expected the table's CSV or Parquet file")
        if self.axes:
            raise InputError("axes: not with method table, whose columns are the axes")
        path = folder / self.sample.file
        frame, rows = read_filled_rows(path)
        if not rows:
            raise InputError(f"{path}: no rows below the header, expected at least one")
        try:
            columns = [
                input_column(
                    column.alias(known_input(drive, column.name)), lambda k: f"row {rows[k]}"
                )
                for column in frame.get_columns()
            ]
            return Space.table(drive, pl.DataFrame(columns))
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    def _drawn(self, drive: Drive) -> Space:
        if not self.axes:
            raise InputError("axes: none, expected at least one")
        if self.sample.file is not None:
            raise InputError("sample.file: only for method table")
        is_grid = self.sample.method == "grid"
        axes = {name: self._axis(name, spec, is_grid) for name, spec in self.axes.items()}
        if is_grid:
            if self.sample.count is not None:
                raise InputError("sample.count: not for a grid, whose axes decide the count")
            return Space.grid(drive, **axes)
        if self.sample.count is None:
            raise InputError(f"sample.count: missing, expected for method {self.sample.method}")
        make = {
            "sobol": Space.sobol,
            "latin-hypercube": Space.latin_hypercube,
            "random": Space.random,
        }[self.sample.method]
        return make(drive, self.sample.count, seed=self.sample.seed, **axes)

    def _axis(self, name: str, spec: dict[str, Any], is_grid: bool) -> Any:
        if "distribution" in spec:
            if is_grid:
                raise InputError(f"axes.{name}: found a distribution, not for a grid")
            return distribution_from(f"axes.{name}", spec)
        try:
            if "values" in spec:
                values = _Values.model_validate(spec).values
                for value in values if is_count(name) else ():
                    if isinstance(value, float) and not value.is_integer():
                        raise InputError(f"axes.{name}: found {value:g}, expected whole numbers")
                return list(values)
            parsed = _Range.model_validate(spec)
        except ValidationError as error:
            raise InputError(f"axes.{name}.{one_line(error, _Range, _Values)}") from None
        if parsed.steps is not None:
            return Linspace(parsed.start, parsed.stop, parsed.steps)
        if is_grid:
            if is_count(name):
                return _whole_numbers(name, parsed.start, parsed.stop)
            raise InputError(f"axes.{name}.steps: missing, expected for a grid")
        return (parsed.start, parsed.stop)


def _whole_numbers(name: str, start: float, stop: float) -> Linspace:
    if not (start.is_integer() and stop.is_integer() and start <= stop):
        raise InputError(
            f"axes.{name}: found {start:g} to {stop:g}, expected whole numbers from low to high"
        )
    return Linspace(start, stop, int(stop - start) + 1)
