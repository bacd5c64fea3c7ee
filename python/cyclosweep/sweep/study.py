"""A study: a space of variants with the loads, limits and objective of its sweep."""

from __future__ import annotations

import functools
import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, get_args

import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.numbers import checked_loads, real_numbers
from cyclosweep.design.part_units import TRAIN_OUTPUTS
from cyclosweep.design.parts import PART_DEFAULTS, TRAIN_INPUTS, Engine
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError, did_you_mean, instance_of, one_of
from cyclosweep.notebook import html_table
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study_file import read_study_file

__all__ = ["DEFAULT_LOADS_TN", "Objective", "Study", "StudyModel"]

DEFAULT_LOADS_TN: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 4.5)
SOLVERS = ("quadratic", "full", "failed")
"""Values of ``solver_status``, in the order of their codes."""

_KIND_DTYPES: dict[str, pl.DataType] = {
    "real": pl.Float64(),
    "count": pl.UInt32(),
    "flag": pl.Boolean(),
    "solver": pl.Enum(SOLVERS),
}

StudyModel = Literal["published", "components"]
"""The published model alone, or with the columns of the component model."""

Limits = Mapping[str, tuple[float | None, float | None]]


@dataclass(frozen=True)
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
    model : {"published", "components"}
        Whether the component model's columns are there.
    solver : {"quadratic", "full"}
        How the component model finds its equilibria.
    """

    space: Space
    loads_tn: tuple[float, ...] = DEFAULT_LOADS_TN
    limits: tuple[tuple[str, float, float], ...] = ()
    objective: Objective | None = None
    model: StudyModel = "published"
    solver: Engine = "quadratic"

    @classmethod
    def of(
        cls,
        space: Space | Study,
        *,
        loads_tn: Sequence[float] | None = None,
        limits: Limits | None = None,
        objective: Objective | None = None,
        model: StudyModel | None = None,
        solver: Engine | None = None,
    ) -> Study:
        """Make a study of a space; a study passes through.

        Parameters
        ----------
        space : Space or Study
            What varies.
        loads_tn : sequence of float, optional
            Loads [T_N], 1, 2, 3, 4 and 4.5 by default. A negative one acts in the other
            direction: its twist is the negative of that under the same load above zero.
        limits : mapping, optional
            ``{column: (least or None, greatest or None)}``.
        objective : Objective, optional
            What the summary's best variants are best in.
        model : {"published", "components"}, optional
            The published model alone, by default, or with the component model's columns.
        solver : {"quadratic", "full"}, optional
            How the component model finds its equilibria, by default the faster one.

        Raises
        ------
        InputError
            For a load that is zero or no finite number, or a limit or objective on an unknown
            column.
        """
        if isinstance(space, Study):
            if any(given is not None for given in (loads_tn, limits, objective, model, solver)):
                raise InputError("a study already has its loads, limits, objective and model")
            return space
        instance_of("space", space, Space, Study)
        model, solver = _known(
            "published" if model is None else model, "quadratic" if solver is None else solver
        )
        if objective is not None:
            instance_of("objective", objective, Objective)
        loads = checked_loads(DEFAULT_LOADS_TN if loads_tn is None else loads_tn)
        if len(set(loads)) != len(loads):
            raise InputError(f"loads_tn: found {list(loads)}, expected each load once")
        instance_of("limits", {} if limits is None else limits, Mapping)
        bounds = [_bounds(name, ends) for name, ends in (limits or {}).items()]
        study = cls(space, loads, tuple(bounds), objective, model, solver)
        columns = [*space.drive.every_input(), *study.outputs]
        axes = {axis.name for axis in space.axes}
        for name, _, _ in bounds:
            if name not in columns or name in ("criterion", "solver_status"):
                hint = did_you_mean(name, columns)
                raise InputError(
                    f"limits.{name}: no such column, expected an input or a result{hint}"
                )
            if name in TRAIN_OUTPUTS:
                raise InputError(f"limits.{name}: found a train column, filter by it instead")
            if name in PART_DEFAULTS and name not in axes:
                raise InputError(f"limits.{name}: does not vary, expected an axis or a result")
        if objective is not None:
            dtype = study.schema().get(objective.column)
            if dtype is None:
                hint = did_you_mean(objective.column, study.schema())
                raise InputError(f"objective: no column {objective.column} in this study{hint}")
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
        file = read_study_file(path)
        try:
            return cls.of(
                file.space(Path(path).parent),
                loads_tn=file.loads_tn,
                limits=file.bounds(),
                objective=file.chosen_objective(),
                model=file.model,
                solver=file.solver,
            )
        except InputError as error:
            text = str(error)
            raise InputError(text if text.startswith(str(path)) else f"{path}: {text}") from None

    @functools.cached_property
    def core(self) -> _core.Study:
        """The core's study; made on first use and never pickled."""
        published = [limit for limit in self.limits if limit[0] not in _PART_KINDS]
        return self.space.core(self.loads_tn, published)

    @functools.cached_property
    def part_core(self) -> _core.PartStudy:
        """The core's component model; made on first use and never pickled."""
        numbered = list(enumerate(self.limits))
        of_parts = [(*limit, number) for number, limit in numbered if limit[0] in _PART_KINDS]
        published = [number for number, limit in numbered if limit[0] not in _PART_KINDS]
        return self.space.drive.part_study(self.solver, tuple(of_parts), tuple(published))

    def __getstate__(self) -> dict[str, Any]:
        cores = ("core", "part_core")
        return {key: value for key, value in self.__dict__.items() if key not in cores}

    def __repr__(self) -> str:
        limits = f", limits on {', '.join(name for name, *_ in self.limits)}" if self.limits else ""
        goal = "" if self.objective is None else f", {self.objective}"
        return f"<Study: {self.model} model of {self.space!r}{limits}{goal}>"

    def _repr_html_(self) -> str:
        rows = {
            "model": self.model,
            "loads": f"{', '.join(f'{load:g}' for load in self.loads_tn)} T_N",
            **{f"limit on {name}": f"{low:g} to {most:g}" for name, low, most in self.limits},
            "objective": self.objective,
            "columns": len(self.schema()),
            "hash": self.hash[:12],
        }
        return html_table("Study", rows) + self.space._repr_html_()

    def __len__(self) -> int:
        return len(self.space)

    @functools.cached_property
    def outputs(self) -> dict[str, str]:
        """Result columns and their kinds, without those that are axes of the study."""
        axes = {axis.name for axis in self.space.axes}
        table = _core.output_table(list(self.loads_tn))
        if self.model == "components":
            table = [*table, *_PART_KINDS.items()]
        if self.has_train:
            table = [*table, *((name, "real") for name in TRAIN_OUTPUTS)]
        return {name: kind for name, kind in table if name not in axes}

    @property
    def has_train(self) -> bool:
        """Whether the columns of the torsional train are there: the drive or an axis has a part."""
        axes = {axis.name for axis in self.space.axes}
        drive = self.space.drive
        return any(getattr(drive, name) is not None or name in axes for name in TRAIN_INPUTS)

    @functools.cached_property
    def statuses(self) -> tuple[str, ...]:
        """Every value the ``status`` column can take."""
        parts = _core.part_status_labels() if self.model == "components" else []
        limits = (f"limit_{name}" for name, _, _ in self.limits)
        return (*_core.status_labels(), *parts, *limits)

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
            **self._part_definition(),
            **self._train_definition(),
        }

    def _part_definition(self) -> dict[str, Any]:
        """Return what else decides the numbers of the component model; nothing without it."""
        if self.model == "published":
            return {}
        parts = self.space.drive.part_definition()
        return {"model": self.model, "solver": self.solver, "parts": parts}

    def _train_definition(self) -> dict[str, Any]:
        """Return what else decides the numbers of the torsional train; nothing without it."""
        if not self.has_train:
            return {}
        drive = self.space.drive
        return {"train": {name: repr(getattr(drive, name)) for name in TRAIN_INPUTS}}

    @functools.cached_property
    def hash(self) -> str:
        """SHA-256 of the definition: datasets with the same hash hold the same numbers."""
        text = json.dumps(self.definition(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


_PART_KINDS = dict(_core.part_output_table())


def _known(model: StudyModel, solver: Engine) -> tuple[StudyModel, Engine]:
    """Return the names of a model and a solver; InputError for one that is not known."""
    one_of("model", model, get_args(StudyModel))
    return model, one_of("solver", solver, get_args(Engine))


def _bounds(name: str, ends: tuple[float | None, float | None]) -> tuple[str, float, float]:
    """A limit with both ends; InputError unless they are numbers in order."""
    if not isinstance(ends, (tuple, list)) or len(ends) != 2:
        raise InputError(f"limits.{name}: found {ends!r}, expected (least or None, most or None)")
    low, high = ends
    given = [-math.inf if low is None else low, math.inf if high is None else high]
    least, most = real_numbers(f"limits.{name}", given)
    if not least <= most:
        raise InputError(f"limits.{name}: found {least:g} to {most:g}, expected min <= max")
    return name, least, most
