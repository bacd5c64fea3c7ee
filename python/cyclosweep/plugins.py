"""What a module named by `--plugin` adds: columns and constraints of every study, and effects."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import TypeVar

import polars as pl

from cyclosweep.errors import InputError

__all__ = ["COLUMNS", "CONSTRAINTS", "LOADED", "Batch", "Column", "column", "constraint", "load"]

Batch = Callable[[pl.DataFrame], object]
"""A function of some rows of a study, that returns one value a row."""

_F = TypeVar("_F", bound=Batch)


@dataclass(frozen=True, eq=False)
class Column:
    """A column of the user's own: how its values follow from the other columns of a row.

    Attributes
    ----------
    value : str, polars.Expr or callable
        An expression of columns as text, one of polars, or a function that takes rows as a
        :class:`polars.DataFrame` and returns as many values.
    unit, meaning : str
        What is stored with a dataset; the unit follows from the name's ending without it.
    needs : sequence of str, optional
        Columns that a function reads. Without it every input and result is computed for it.
    is_condition : bool
        Whether the values of a function are true or false instead of numbers.
    """

    value: str | pl.Expr | Batch
    unit: str = ""
    meaning: str = ""
    needs: Sequence[str] | None = None
    is_condition: bool = False

    def __post_init__(self) -> None:
        check_value("column", self.value)


def check_value(where: str, value: object) -> None:
    """Refuse what no value of a column follows from.

    Parameters
    ----------
    where : str
        What a message names.
    value : str, polars.Expr or callable
        What was given.

    Raises
    ------
    InputError
        For anything else.
    """
    if not (isinstance(value, (str, pl.Expr)) or callable(value)):
        raise InputError(
            f"{where}: found {value!r}, expected an expression as text or of polars, or a function"
        )


COLUMNS: dict[str, Column] = {}
"""Columns that every study gets which has what they need, by name."""

LOADED: list[str] = []
"""Modules that were loaded, as a worker in another process has to load them again."""

CONSTRAINTS: dict[str, Column] = {}
"""Conditions that the variants of every study have to meet, by name."""


def column(
    name: str, *, unit: str = "", meaning: str = "", needs: Sequence[str] | None = None
) -> Callable[[_F], _F]:
    """Make a function a column of every study.

    Parameters
    ----------
    name : str
        Of the column, with its unit at the end.
    unit, meaning : str
        What is stored with a dataset.
    needs : sequence of str, optional
        Columns that the function reads; all without it.

    Returns
    -------
    callable
        A decorator.

    Examples
    --------
    >>> @column("pin_mass_kg", needs=["output_pin_count", "output_pin_diameter_mm"])
    ... def pin_mass(rows):
    ...     return rows["output_pin_count"] * rows["output_pin_diameter_mm"] ** 2 * 2.5e-4
    >>> COLUMNS.pop("pin_mass_kg").needs
    ['output_pin_count', 'output_pin_diameter_mm']
    """

    def registered(function: _F) -> _F:
        COLUMNS[name] = Column(function, unit, meaning, needs)
        return function

    return registered


def constraint(name: str, *, needs: Sequence[str] | None = None) -> Callable[[_F], _F]:
    """Make a function a condition that the variants of every study have to meet.

    Parameters
    ----------
    name : str
        Of the constraint; a variant that does not meet it gets the status ``constraint_<name>``.
    needs : sequence of str, optional
        Columns that the function reads; all without it.

    Returns
    -------
    callable
        A decorator.
    """

    def registered(function: _F) -> _F:
        CONSTRAINTS[name] = Column(function, needs=needs, is_condition=True)
        return function

    return registered


def load(module: str) -> ModuleType:
    """Import a module of the user's own, whose decorators then have run.

    An effect is registered by :func:`cyclosweep.simulation.effects.register`.

    Parameters
    ----------
    module : str
        A module's name, looked for in the working directory too, or a file that ends in ``.py``.

    Returns
    -------
    module

    Raises
    ------
    InputError
        When it cannot be imported.
    """
    path = Path(module)
    folder, name = (path.parent, path.stem) if path.suffix == ".py" else (Path(), module)
    if path.suffix == ".py" and not path.is_file():
        raise InputError(f"--plugin: {module}: No such file or directory")
    # Workers in other processes find it by the same path.
    sys.path.insert(0, str(folder.resolve()))
    try:
        found = importlib.import_module(name)
    except Exception as error:
        reason = str(error).partition("\n")[0]
        raise InputError(f"--plugin: {module}: {type(error).__name__}: {reason}") from None
    again = str(path.resolve()) if path.suffix == ".py" else module
    if again not in LOADED:
        LOADED.append(again)
    return found
