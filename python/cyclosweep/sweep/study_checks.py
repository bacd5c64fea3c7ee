"""Checks of what a study is given: limits, objectives, names of models and columns to keep."""

from __future__ import annotations

import difflib
import math
from collections.abc import Container, Iterable, Mapping
from typing import cast, get_args

import polars as pl

from cyclosweep.design.drive import Drive
from cyclosweep.design.numbers import real_numbers
from cyclosweep.design.part_units import PART_INPUTS, PART_OUTPUTS, TRAIN_OUTPUTS
from cyclosweep.design.parts import PART_DEFAULTS, Engine
from cyclosweep.design.units import INPUTS, OUTPUTS, is_quantity
from cyclosweep.errors import InputError, did_you_mean, instance_of, one_of
from cyclosweep.plugins import COLUMNS, Column
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.objective import Objective

__all__ = [
    "check_kept",
    "check_limits",
    "check_objectives",
    "check_parts",
    "checked_bounds",
    "checked_objectives",
    "checked_solver",
    "registered_columns",
]


def checked_bounds(name: str, ends: object) -> tuple[str, float, float]:
    """A limit with both ends.

    Parameters
    ----------
    name : str
        What is limited.
    ends : tuple of two numbers
        Its ends, None for no limit.

    Returns
    -------
    tuple of (str, float, float)

    Raises
    ------
    InputError
        Unless one of them is there and they are numbers in order.
    """
    if not isinstance(ends, (tuple, list)) or len(ends) != 2:
        raise InputError(f"limits.{name}: found {ends!r}, expected (least or None, most or None)")
    low, high = ends
    if low is None and high is None:
        raise InputError(f"limits.{name}: found neither min nor max, expected one of them")
    given = [-math.inf if low is None else low, math.inf if high is None else high]
    least, most = real_numbers(f"limits.{name}", given)
    for end in (least, most):
        if math.isnan(end):
            raise InputError(f"limits.{name}: found nan, expected a number or None")
    if not least <= most:
        raise InputError(f"limits.{name}: found {least:g} to {most:g}, expected min <= max")
    return name, least, most


def checked_objectives(given: object) -> tuple[Objective, ...]:
    """Return objectives, one alone or several.

    Parameters
    ----------
    given : Objective, sequence of them or None
        What was found.

    Returns
    -------
    tuple of Objective

    Raises
    ------
    InputError
        For anything else, or one objective twice.
    """
    many = list(given) if isinstance(given, (list, tuple)) else [] if given is None else [given]
    found = []
    for each in many:
        instance_of("objective", each, Objective)
        found.append(cast(Objective, each))
    if len(set(found)) != len(found):
        raise InputError("objective: found one twice, expected each once")
    return tuple(found)


def checked_solver(given: object, model: str) -> Engine:
    """Return how equilibria are found, by default the faster one.

    Parameters
    ----------
    given : str or None
        What was found.
    model : str
        The study's model.

    Returns
    -------
    {"quadratic", "full"}

    Raises
    ------
    InputError
        For another name, or one that would change nothing.
    """
    engine = one_of("solver", "quadratic" if given is None else given, get_args(Engine))
    if engine == "full" and model == "published":
        raise InputError(
            "solver: found 'full' with the published model, which solves no equilibria; expected "
            'model = "components" beside it'
        )
    return cast(Engine, engine)


def registered_columns(known: Mapping[str, object], own: Mapping[str, Column]) -> dict[str, Column]:
    """Columns of plugins that have in a study what they need.

    Parameters
    ----------
    known : mapping of str to object
        Columns of the study and inputs of its drive, by name.
    own : mapping of str to Column
        Columns of the study's own.

    Returns
    -------
    dict of str to Column

    Raises
    ------
    InputError
        For a need that no study has and whose name is nearly that of an input or result.
    """
    there = {*known, *COLUMNS, *own}
    every = {*there, *INPUTS, *PART_INPUTS, *OUTPUTS, *PART_OUTPUTS, *TRAIN_OUTPUTS}
    for name, each in COLUMNS.items():
        unknown = [need for need in each.needs or () if need not in there and not is_quantity(need)]
        for need in unknown:
            if meant := difflib.get_close_matches(need, every, n=1, cutoff=_LIKELY):
                raise InputError(
                    f"--plugin: column {name} needs {need}, which is no input or result, did you "
                    f"mean {meant[0]}?"
                )
    return {name: each for name, each in COLUMNS.items() if there.issuperset(each.needs or ())}


_LIKELY = 0.8
"""Likeness from which an unknown name is taken for a misspelt one."""


def check_parts(drive: Drive, varying: Container[str]) -> None:
    """Refuse a component model of which no variant could be built.

    Parameters
    ----------
    drive : Drive
        The drive of the study.
    varying : container of str
        Inputs that vary.

    Raises
    ------
    InputError
        With the dimensions for which nothing stands in.
    """
    required = [name for name, (kind, *_) in PART_DEFAULTS.items() if kind == "required"]
    missing = [name for name in required if getattr(drive, name) is None and name not in varying]
    if missing:
        raise InputError(
            f"model: found 'components' of {drive.name}, which lacks {' and '.join(missing)}, "
            "expected them in the drive file or as axes"
        )


def check_limits(
    names: Iterable[str], known: Mapping[str, object], varying: Container[str]
) -> None:
    """Refuse a limit on a single column that cannot have one.

    Parameters
    ----------
    names : iterable of str
        Columns and expressions that are limited; expressions are checked elsewhere.
    known : mapping of str to object
        Columns and inputs there are, by name.
    varying : container of str
        Inputs that vary.

    Raises
    ------
    InputError
        For an unknown column, a word, or a key of the component model that does not vary.
    """
    for name in names:
        if not name.isidentifier():
            continue
        if name in PART_DEFAULTS and name not in varying:
            raise InputError(f"limits.{name}: does not vary, expected an axis or a result")
        if name not in known or name in ("criterion", "solver_status"):
            hint = did_you_mean(name, known)
            raise InputError(f"limits.{name}: no such column, expected an input or a result{hint}")


def check_objectives(
    objectives: Iterable[Objective],
    schema: Mapping[str, pl.DataType],
    known: Mapping[str, pl.DataType],
) -> None:
    """Refuse an objective that is no number in this study.

    Parameters
    ----------
    objectives : iterable of Objective
        What the best variants are best in.
    schema : mapping of str to polars.DataType
        Columns of the study.
    known : mapping of str to polars.DataType
        The same and inputs that do not vary, which an expression may name.

    Raises
    ------
    InputError
        For an unknown column, or a word.
    """
    for objective in objectives:
        name = objective.column
        dtype = schema.get(name)
        if dtype is None and name.isidentifier():
            hint = did_you_mean(name, schema)
            raise InputError(f"objective: no column {name} in this study{hint}")
        if isinstance(dtype, pl.Enum):
            raise InputError(f"objective: {name} is no number, expected one")
        if dtype is None:
            number(name, known, where="objective")


def check_kept(keep: Iterable[str], schema: Mapping[str, object]) -> None:
    """Refuse a column to keep that a study does not have.

    Parameters
    ----------
    keep : iterable of str
        Columns to keep.
    schema : mapping of str to object
        Columns of the study, by name.

    Raises
    ------
    InputError
        For a column that is not there.
    """
    for name in keep:
        if name not in schema:
            hint = did_you_mean(name, schema)
            raise InputError(f"columns: no column {name} in this study{hint}")
