"""Inputs, and quantities that help to say them, that follow from the axes by an expression."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter

import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.active_pins import CRITERIA
from cyclosweep.design.drive import Drive
from cyclosweep.design.part_units import TRAIN_OUTPUTS
from cyclosweep.design.units import OUTPUTS
from cyclosweep.errors import InputError
from cyclosweep.sweep.axes import Axis
from cyclosweep.sweep.expressions import names_in, number

__all__ = ["Derived", "check_new_name", "constants", "derivations", "fixed_inputs", "with_derived"]

_RESULTS = {*OUTPUTS, *TRAIN_OUTPUTS, *(name for name, _ in _core.part_output_table())}


@dataclass(frozen=True)
class Derived:
    """One quantity of a space that follows from others.

    Attributes
    ----------
    name : str
        An input, whose value it replaces variant by variant, or a name of the user's own.
    text : str
        The expression.
    """

    name: str
    text: str


def derivations(
    drive: Drive, axes: Iterable[Axis], given: Mapping[str, str | float]
) -> tuple[Derived, ...]:
    """Check derived quantities and put them in the order in which they can be computed.

    Parameters
    ----------
    drive : Drive
        Whose keys they may name.
    axes : iterable of Axis
        What varies.
    given : mapping of str to str or float
        Expression of each, by name.

    Returns
    -------
    tuple of Derived

    Raises
    ------
    InputError
        For a name that is an axis or a result, an expression that names what is not there, or
        quantities that follow from each other.
    """
    known: dict[str, pl.DataType] = {axis.name: axis.dtype for axis in axes}
    for name in given:
        if name in known:
            raise InputError(f"derived.{name}: is an axis too, expected one of both")
        if name not in drive.every_input() and not OUTPUTS.keys() & {name}:
            check_new_name("derived", name)
        elif name in OUTPUTS and name not in drive.every_input():
            raise InputError(f"derived.{name}: is a result, expected an input or a new name")
    if "criterion" in given:
        raise InputError("derived.criterion: is a word, expected an axis of its own")
    texts = {name: each if isinstance(each, str) else repr(each) for name, each in given.items()}
    graph = {name: [o for o in names_in(text) if o in texts] for name, text in texts.items()}
    try:
        order = list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        raise InputError(
            f"derived: {' and '.join(dict.fromkeys(error.args[1]))} follow from each other"
        ) from None
    known |= {name: dtype for name, dtype in fixed_inputs(drive).items() if name not in known}
    for name in texts:
        known.pop(name, None)
    for name in order:
        where = f"derived.{name}"
        for other in names_in(texts[name]):
            if other in drive.every_input() and other not in known:
                raise InputError(f"{where}: the drive has no {other}, expected it or an axis")
        is_input = name in drive.every_input()
        number(texts[name], known, where=where, allow_truth=not is_input)
        known[name] = pl.Float64()
    return tuple(Derived(name, texts[name]) for name in order)


def check_new_name(table: str, name: str) -> None:
    """Refuse a name for a quantity of the user's own that means something else already.

    Parameters
    ----------
    table : str
        Of the study file, for the message.
    name : str
        The name.

    Raises
    ------
    InputError
        For a name that is no word, or that of a result or of the columns of every study.
    """
    if not re.fullmatch(r"[^\W\d]\w*", name):
        raise InputError(f"{table}: found {name!r}, expected letters, digits and underscores")
    if name in _RESULTS or name in ("variant", "status") or re.fullmatch(r"twist_\w+tn_deg", name):
        raise InputError(f"{table}.{name}: is a column of every study, expected a new name")


def fixed_inputs(drive: Drive) -> dict[str, pl.DataType]:
    """Inputs that a drive has, and their types in an expression.

    Parameters
    ----------
    drive : Drive
        Whose inputs.

    Returns
    -------
    dict of str to polars.DataType
    """
    values = {**drive.values(), **drive.part_values()}
    types = {name: pl.Float64() for name, value in values.items() if not math.isnan(value)}
    return {**types, "criterion": pl.Enum(CRITERIA)}


def constants(drive: Drive, names: Iterable[str]) -> list[pl.Expr]:
    """Inputs of a drive as columns that are the same in every row.

    Parameters
    ----------
    drive : Drive
        Whose inputs.
    names : iterable of str
        Which ones.

    Returns
    -------
    list of polars.Expr
    """
    values = {**drive.values(), **drive.part_values()}
    found = []
    for name in names:
        if name == "criterion":
            found.append(pl.lit(drive.criterion, dtype=pl.Enum(CRITERIA)).alias(name))
        else:
            found.append(pl.lit(float(values[name]), dtype=pl.Float64).alias(name))
    return found


def with_derived(rows: pl.DataFrame, drive: Drive, derived: Iterable[Derived]) -> pl.DataFrame:
    """Add derived quantities to the axes of some variants.

    Parameters
    ----------
    rows : polars.DataFrame
        With a column for each axis.
    drive : Drive
        What does not vary.
    derived : iterable of Derived
        In an order in which they can be computed.

    Returns
    -------
    polars.DataFrame
        With one more Float64 column for each of them.
    """
    derived = list(derived)
    own = {each.name for each in derived}
    read = dict.fromkeys(name for each in derived for name in names_in(each.text))
    fixed = [name for name in read if name not in rows.columns and name not in own]
    table = rows.with_columns(constants(drive, fixed))
    for each in derived:
        value = number(each.text, dict(table.schema), where=f"derived.{each.name}")
        table = table.with_columns(value.alias(each.name))
    return table.drop(fixed)
