"""A study: a space of variants, the loads, limits and objective, and the file that says so."""

from __future__ import annotations

import functools
import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import polars as pl
from pydantic import BaseModel, ConfigDict, Field, ValidationError

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive, one_line, read_toml
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError
from cyclosweep.sweep.space import Linspace, Method, Space, is_count

__all__ = ["DEFAULT_LOADS_TN", "Objective", "Study"]

DEFAULT_LOADS_TN: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 4.5)
_KIND_DTYPES = {"real": pl.Float64(), "count": pl.UInt32(), "flag": pl.Boolean()}

Limits = Mapping[str, tuple[float | None, float | None]]


@dataclass(frozen=True)
class Objective:
    """What the best variants are best in.

    Attributes
    ----------
    column : str
        A result or an input.
    maximise : bool
        Whether more is better.
    """

    column: str
    maximise: bool = False


@dataclass(frozen=True, eq=False)
class Study:
    """A space with everything else that decides what a sweep computes.

    Attributes
    ----------
    space : Space
        The variants.
    loads_tn : tuple of float
        Loads [T_N] at which twists are computed.
    limits : tuple of (str, float, float)
        Column, least and greatest value; a variant outside gets the status ``limit_<column>``.
    objective : Objective or None
        What the summary's best variants are best in.
    """

    space: Space
    loads_tn: tuple[float, ...] = DEFAULT_LOADS_TN
    limits: tuple[tuple[str, float, float], ...] = ()
    objective: Objective | None = None

    @classmethod
    def of(
        cls,
        space: Space | Study,
        *,
        loads_tn: Sequence[float] | None = None,
        limits: Limits | None = None,
        objective: Objective | None = None,
    ) -> Study:
        """Make a study of a space; a study passes through.

        Parameters
        ----------
        space : Space or Study
            What varies.
        loads_tn : sequence of float, optional
            Loads [T_N], each above zero; 1, 2, 3, 4 and 4.5 by default.
        limits : mapping, optional
            ``{column: (least or None, greatest or None)}``.
        objective : Objective, optional
            What the summary's best variants are best in.

        Raises
        ------
        InputError
            For a load that is not above zero, or a limit or objective on an unknown column.
        """
        if isinstance(space, Study):
            if loads_tn is not None or limits is not None or objective is not None:
                raise InputError("a study already has its loads, limits and objective")
            return space
        loads = DEFAULT_LOADS_TN if loads_tn is None else tuple(float(load) for load in loads_tn)
        for load in loads:
            if not (math.isfinite(load) and load > 0):
                raise InputError(f"loads_tn: found {load:g}, expected loads above zero")
        if len(set(loads)) != len(loads):
            raise InputError(f"loads_tn: found {list(loads)}, expected each load once")
        bounds = []
        for name, (low, high) in (limits or {}).items():
            least = -math.inf if low is None else float(low)
            most = math.inf if high is None else float(high)
            if not least <= most:
                raise InputError(f"limits.{name}: found {least:g} to {most:g}, expected min <= max")
            bounds.append((name, least, most))
        study = cls(space, loads, tuple(bounds), objective)
        columns = [*space.drive.inputs(), *(name for name, _ in _core.output_table(list(loads)))]
        for name, _, _ in bounds:
            if name not in columns or name == "criterion":
                raise InputError(f"limits.{name}: no such column, expected an input or a result")
        if objective is not None:
            dtype = study.schema().get(objective.column)
            if dtype is None:
                raise InputError(f"objective: no column {objective.column} in this study")
            if isinstance(dtype, pl.Enum):
                raise InputError(f"objective: {objective.column} is no number, expected one")
        return study

    @classmethod
    def from_toml(cls, path: str | Path) -> Study:
        """Read a study file.

        Parameters
        ----------
        path : str or Path
            The file; a drive or table file named in it is looked for beside it.

        Raises
        ------
        InputError
            One line that names the file, the key, what was found and what was expected.
        """
        table = read_toml(path)
        try:
            parsed = _StudyFile.model_validate(table)
        except ValidationError as error:
            raise InputError(f"{path}: {one_line(error)}") from None
        try:
            return parsed.study(Path(path).parent)
        except InputError as error:
            text = str(error)
            raise InputError(text if text.startswith(str(path)) else f"{path}: {text}") from None

    @functools.cached_property
    def core(self) -> _core.Study:
        """The core's study; made on first use and never pickled."""
        return self.space.core(self.loads_tn, self.limits)

    def __getstate__(self) -> dict[str, Any]:
        return {key: value for key, value in self.__dict__.items() if key != "core"}

    def __len__(self) -> int:
        return len(self.space)

    @functools.cached_property
    def outputs(self) -> dict[str, str]:
        """Result columns and their kinds, without those that are axes of the study."""
        axes = {axis.name for axis in self.space.axes}
        table = _core.output_table(list(self.loads_tn))
        return {name: kind for name, kind in table if name not in axes}

    @functools.cached_property
    def statuses(self) -> tuple[str, ...]:
        """Every value the ``status`` column can take."""
        return (*_core.status_labels(), *(f"limit_{name}" for name, _, _ in self.limits))

    def schema(self) -> dict[str, pl.DataType]:
        """Columns of a sweep and their types, in order."""
        return {
            "variant": pl.UInt64(),
            **{axis.name: axis.dtype for axis in self.space.axes},
            "status": pl.Enum(self.statuses),
            **{name: _KIND_DTYPES[kind] for name, kind in self.outputs.items()},
        }

    def units(self) -> dict[str, dict[str, str]]:
        """Symbol, unit and meaning of every column, as stored with a dataset."""
        return {name: quantity(name)._asdict() for name in self.schema()}

    def definition(self) -> dict[str, Any]:
        """Return what decides the numbers of a sweep, as stored with a dataset."""
        return {
            **self.space.definition(),
            "loads_tn": [repr(load) for load in self.loads_tn],
            "limits": [[name, repr(low), repr(high)] for name, low, high in self.limits],
            "version": _core.__version__,
        }

    @functools.cached_property
    def hash(self) -> str:
        """SHA-256 of the definition: datasets with the same hash hold the same numbers."""
        text = json.dumps(self.definition(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _Sample(_Part):
    method: Method = "grid"
    count: int | None = Field(default=None, gt=0)
    seed: int = Field(default=0, ge=0)
    file: str | None = None


class _Range(_Part):
    start: float = Field(alias="from", allow_inf_nan=False)
    stop: float = Field(alias="to", allow_inf_nan=False)
    steps: int | None = Field(default=None, ge=1)


class _Values(_Part):
    values: list[float | str] = Field(min_length=1)


class _Limit(_Part):
    min: float | None = None
    max: float | None = None


class _ObjectiveTable(_Part):
    minimise: str | None = None
    maximise: str | None = None


class _StudyFile(_Part):
    drive: str = "reference-87"
    loads_tn: list[Annotated[float, Field(gt=0)]] = list(DEFAULT_LOADS_TN)
    sample: _Sample = _Sample()
    axes: dict[str, dict[str, Any]] = {}
    limits: dict[str, _Limit] = {}
    objective: _ObjectiveTable | None = None

    def study(self, folder: Path) -> Study:
        drive = Drive.load(self.drive, beside=folder)
        limits = {name: (limit.min, limit.max) for name, limit in self.limits.items()}
        space = self._table(drive, folder) if self.sample.method == "table" else self._space(drive)
        return Study.of(
            space, loads_tn=self.loads_tn, limits=limits, objective=self._chosen_objective()
        )

    def _chosen_objective(self) -> Objective | None:
        if self.objective is None:
            return None
        wanted = self.objective
        if (wanted.minimise is None) == (wanted.maximise is None):
            raise InputError("objective: expected either minimise or maximise")
        return Objective(wanted.minimise or wanted.maximise or "", wanted.maximise is not None)

    def _table(self, drive: Drive, folder: Path) -> Space:
        if self.sample.file is None:
            raise InputError("sample.file: missing, expected the table's CSV or Parquet file")
        if self.axes:
            raise InputError("axes: not with method table, whose columns are the axes")
        path = folder / self.sample.file
        try:
            reads_parquet = path.suffix == ".parquet"
            frame = pl.read_parquet(path) if reads_parquet else pl.read_csv(path)
        except (OSError, pl.exceptions.PolarsError) as error:
            raise InputError(f"{path}: {str(error).splitlines()[0]}") from None
        try:
            return Space.table(drive, frame)
        except InputError as error:
            raise InputError(f"{path}: {error}") from None

    def _space(self, drive: Drive) -> Space:
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
        try:
            if "values" in spec:
                return list(_Values.model_validate(spec).values)
            parsed = _Range.model_validate(spec)
        except ValidationError as error:
            raise InputError(f"axes.{name}.{one_line(error)}") from None
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
