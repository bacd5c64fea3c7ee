"""A study: a space of variants with the loads, limits and objective of its sweep."""

from __future__ import annotations

import functools
import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, get_args

import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.numbers import checked_loads
from cyclosweep.design.part_units import TRAIN_OUTPUTS
from cyclosweep.design.parts import PART_DEFAULTS, TRAIN_INPUTS, Engine
from cyclosweep.design.units import quantity
from cyclosweep.errors import InputError, instance_of, naming, one_of
from cyclosweep.notebook import html_table
from cyclosweep.plugins import CONSTRAINTS, Column
from cyclosweep.sweep.derived import check_new_name, fixed_inputs
from cyclosweep.sweep.expressions import names_in
from cyclosweep.sweep.extras import Extras, extras_of
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.own_columns import Own, column_of, own_quantity
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study_checks import (
    check_kept,
    check_limits,
    check_objectives,
    checked_bounds,
    checked_objectives,
    checked_solver,
    registered_columns,
)
from cyclosweep.sweep.study_definition import own_definition, part_definition, train_definition
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
        Column or expression, least and greatest value; a variant outside gets the status
        ``limit_<column>``.
    objectives : tuple of Objective
        What the summary's best variants are best in.
    model : {"published", "components"}
        Whether the component model's columns are there.
    solver : {"quadratic", "full"}
        How the component model finds its equilibria.
    constraints : mapping of str to Column
        Conditions; a variant that does not meet one gets the status ``constraint_<name>``.
    columns : mapping of str to Column
        Columns of the user's own.
    keep : tuple of str or None
        Results that a sweep gives; None for all.
    only_ok : bool
        Whether a sweep gives only variants of the status ``ok``.
    """

    space: Space
    loads_tn: tuple[float, ...] = DEFAULT_LOADS_TN
    limits: tuple[tuple[str, float, float], ...] = ()
    objectives: tuple[Objective, ...] = ()
    model: StudyModel = "published"
    solver: Engine = "quadratic"
    constraints: Mapping[str, Column] = field(default_factory=dict, hash=False)
    columns: Mapping[str, Column] = field(default_factory=dict, hash=False)
    keep: tuple[str, ...] | None = None
    only_ok: bool = False

    @classmethod
    def of(
        cls,
        space: Space | Study,
        *,
        loads_tn: Sequence[float] | None = None,
        limits: Limits | None = None,
        objective: Objective | Sequence[Objective] | None = None,
        model: StudyModel | None = None,
        solver: Engine | None = None,
        constraints: Mapping[str, Own] | None = None,
        columns: Mapping[str, Own] | None = None,
        keep: Sequence[str] | None = None,
        only_ok: bool = False,
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
            ``{column: (least or None, greatest or None)}``, also of own columns and expressions.
        objective : Objective or sequence of them, optional
            What the summary's best variants are best in.
        model : {"published", "components"}, optional
            The published model alone, by default, or with the component model's columns.
        solver : {"quadratic", "full"}, optional
            How the component model finds its equilibria, by default the faster one.
        constraints : mapping, optional
            ``{name: condition}``, as text, polars expression or function; those that read inputs
            alone are applied before the models compute.
        columns : mapping, optional
            ``{name: value}`` of columns of your own: text, polars expression, function of a
            :class:`polars.DataFrame` of some rows, or :class:`cyclosweep.Column`.
        keep : sequence of str, optional
            Results to give, own columns too; all by default. ``variant``, ``status`` and what
            varies are always there.
        only_ok : bool
            Give only variants of the status ``ok``; the summary still counts the others.

        Raises
        ------
        InputError
            For a load that is zero or no finite number, or a limit, objective, constraint or
            column that names an unknown column.
        """
        given = (loads_tn, limits, objective, model, solver, constraints, columns, keep)
        if isinstance(space, Study):
            if any(each is not None for each in given) or only_ok:
                raise InputError("a study already has its loads, limits, objective and model")
            return space
        instance_of("space", space, Space, Study)
        for key, each in (("limits", limits), ("constraints", constraints), ("columns", columns)):
            instance_of(key, {} if each is None else each, Mapping)
        kind = one_of("model", "published" if model is None else model, get_args(StudyModel))
        engine = checked_solver(solver, kind)
        loads = checked_loads(DEFAULT_LOADS_TN if loads_tn is None else loads_tn)
        if len(set(loads)) != len(loads):
            raise InputError(f"loads_tn: found {list(loads)}, expected each load once")
        bounds = [checked_bounds(name, ends) for name, ends in (limits or {}).items()]
        aims = checked_objectives(objective)
        own = {name: column_of(value, f"columns.{name}") for name, value in (columns or {}).items()}
        for name in own:
            check_new_name("columns", name)
        tests = {
            name: column_of(value, f"constraints.{name}")
            for name, value in {**CONSTRAINTS, **(constraints or {})}.items()
        }
        plain = cls(space, loads, tuple(bounds), aims, kind, engine)
        own = {**registered_columns(plain.known, own), **own}
        kept = None if keep is None else tuple(dict.fromkeys(keep))
        study = replace(plain, constraints=tests, columns=own, keep=kept, only_ok=only_ok)
        check_limits(limits or {}, {**study.known, **own}, space.varying)
        schema = study.schema()
        check_objectives(aims, schema, study.namespace)
        check_kept(kept or (), schema)
        return study

    @property
    def objective(self) -> Objective | None:
        """The first objective; None where there is none."""
        return self.objectives[0] if self.objectives else None

    @functools.cached_property
    def extras(self) -> Extras:
        """Own columns and conditions, checked."""
        native = set(self.native_limits)
        others = [limit for limit in self.limits if limit not in native]
        return extras_of(self.columns, others, self.constraints, self.known)

    @functools.cached_property
    def is_extended(self) -> bool:
        """Whether anything is computed beside the models: derived inputs, columns, conditions."""
        extras = self.extras
        return bool(self.space.derived or extras.columns or extras.conditions)

    @functools.cached_property
    def native_limits(self) -> tuple[tuple[str, float, float], ...]:
        """Limits that the models check themselves."""
        native = {name for name, _ in _core.output_table(list(self.loads_tn))}
        native |= {*self.space.drive.inputs(), *(self.space.varying & PART_DEFAULTS.keys())}
        native |= _PART_KINDS.keys() if self.model == "components" else set()
        return tuple(limit for limit in self.limits if limit[0] in native)

    @functools.cached_property
    def known(self) -> dict[str, pl.DataType]:
        """What expressions may name: columns before the own ones, and the drive's inputs."""
        inputs = fixed_inputs(self.space.drive)
        columns = self._modelled_schema()
        del columns["status"]
        return {**inputs, **columns}

    @functools.cached_property
    def namespace(self) -> dict[str, pl.DataType]:
        """What limits and objectives may name: own columns too."""
        return {**self.known, **{column.name: column.dtype for column in self.extras.columns}}

    def on_rows(self, inputs: pl.DataFrame) -> Study:
        """Return this study of the variants of a frame of inputs, derived ones included."""
        study = replace(self, space=self.space.on_rows(inputs))
        study.__dict__["extras"] = self.extras
        if self.model == "components":
            study.__dict__["part_core"] = self.part_core
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
        with naming(path):
            return cls.of(
                file.space(Path(path).parent),
                loads_tn=file.loads_tn,
                limits=file.bounds(),
                objective=file.chosen_objectives(),
                model=file.model,
                solver=file.solver,
                constraints=file.constraints,
                columns=file.own_columns(),
                keep=file.kept_columns(),
                only_ok=file.only_ok,
            )

    @functools.cached_property
    def core(self) -> _core.Study:
        """The core's study; made on first use and never pickled."""
        published = [limit for limit in self.native_limits if limit[0] not in _PART_KINDS]
        return self.space.core(self.loads_tn, published)

    @functools.cached_property
    def part_core(self) -> _core.PartStudy:
        """The core's component model; made on first use and never pickled."""
        numbered = list(enumerate(self.native_limits))
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
        """Result columns of the models and their kinds, without those that vary."""
        table = _core.output_table(list(self.loads_tn))
        if self.model == "components":
            table = [*table, *_PART_KINDS.items()]
        if self.has_train:
            table = [*table, *((name, "real") for name in TRAIN_OUTPUTS)]
        return {name: kind for name, kind in table if name not in self.space.varying}

    @property
    def has_train(self) -> bool:
        """Whether the columns of the torsional train are there: the drive or an axis has a part."""
        drive, varying = self.space.drive, self.space.varying
        return any(getattr(drive, name) is not None or name in varying for name in TRAIN_INPUTS)

    @functools.cached_property
    def statuses(self) -> tuple[str, ...]:
        """Every value the ``status`` column can take."""
        parts = _core.part_status_labels() if self.model == "components" else []
        native = (f"limit_{name}" for name, _, _ in self.native_limits)
        return (*_core.status_labels(), *parts, *native, *(s for s, _ in self.extras.conditions))

    @functools.cached_property
    def status_codes(self) -> dict[str, int]:
        """Number of each status."""
        return {label: code for code, label in enumerate(self.statuses)}

    def schema(self) -> dict[str, pl.DataType]:
        """Columns of a study and their types, in order."""
        own = {column.name: column.dtype for column in self.extras.columns}
        return {**self._modelled_schema(), "status": pl.Enum(self.statuses), **own}

    def _modelled_schema(self) -> dict[str, pl.DataType]:
        return {
            "variant": pl.UInt64(),
            **{axis.name: axis.dtype for axis in self.space.axes},
            **{each.name: pl.Float64() for each in self.space.derived},
            "status": pl.String(),
            **{name: _KIND_DTYPES[kind] for name, kind in self.outputs.items()},
        }

    def given(self) -> list[str]:
        """Columns that a sweep gives, in order."""
        names = list(self.schema())
        kept = names if self.keep is None else self.keep
        always = {"variant", "status", *self.space.varying}
        return [name for name in names if name in always or name in kept]

    def computed(self) -> list[str]:
        """Columns that a sweep has to compute: those given, and what objectives read."""
        read = [name for each in self.objectives for name in names_in(each.column)]
        wanted = {*self.given(), "status", *read}
        varying = ["variant", *self.space.varying]
        return [n for n in self.schema() if n in wanted or (self.objectives and n in varying)]

    def ranged(self) -> list[str]:
        """Columns whose least and greatest value a summary gives: results that are numbers."""
        own = [column.name for column in self.extras.columns if column.dtype != pl.Boolean()]
        kinds = self.outputs.items()
        return [*(name for name, kind in kinds if kind not in ("flag", "solver")), *own]

    def select(self, rows: pl.DataFrame) -> pl.DataFrame:
        """Return what a sweep gives of computed rows."""
        rows = rows.filter(pl.col("status") == "ok") if self.only_ok else rows
        return rows.select(self.given())

    def units(self) -> dict[str, dict[str, str]]:
        """Symbol, unit and meaning of every column, as stored with a dataset."""
        own = {name: (column.unit, column.meaning) for name, column in self.columns.items()}
        inputs = self.space.drive.every_input()
        own |= {d.name: ("", d.text) for d in self.space.derived if d.name not in inputs}
        return {
            name: (own_quantity(name, *own[name]) if name in own else quantity(name))._asdict()
            for name in self.schema()
        }

    def definition(self) -> dict[str, Any]:
        """Return what decides the numbers of a sweep, as stored with a dataset."""
        return {
            **self.space.definition(),
            "loads_tn": [repr(load) for load in self.loads_tn],
            "limits": [[name, repr(low), repr(high)] for name, low, high in self.limits],
            "version": _core.__version__,
            **part_definition(self.space.drive, self.model, self.solver),
            **(train_definition(self.space.drive) if self.has_train else {}),
            **own_definition(self.constraints, self.columns, self.keep, self.only_ok),
        }

    @functools.cached_property
    def hash(self) -> str:
        """SHA-256 of the definition: datasets with the same hash hold the same numbers."""
        text = json.dumps(self.definition(), sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


_PART_KINDS = dict(_core.part_output_table())
