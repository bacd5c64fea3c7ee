"""What a study has beyond the models: own columns, and conditions its variants have to meet."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.own_columns import Column, Formula, formula

__all__ = ["Extras", "extras_of"]


@dataclass(frozen=True, eq=False)
class Extras:
    """Own columns and conditions of a study, checked.

    Attributes
    ----------
    columns : tuple of Formula
        Own columns, in an order in which they can be computed.
    conditions : tuple of (str, Formula)
        For each condition the status of variants that do not meet it.
    """

    columns: tuple[Formula, ...]
    conditions: tuple[tuple[str, Formula], ...]

    def needed(self, names: Iterable[str]) -> list[str]:
        """Columns from which some columns are computed, themselves included.

        Parameters
        ----------
        names : iterable of str
            Columns; ``status`` needs what the conditions read.

        Returns
        -------
        list of str
            Each once.
        """
        found = dict.fromkeys(names)
        if "status" in found:
            found |= dict.fromkeys(name for _, rule in self.conditions for name in rule.needs)
        for column in reversed(self.columns):
            if column.name in found:
                found |= dict.fromkeys(column.needs)
        return list(found)

    def early(self, cheap: set[str]) -> list[tuple[str, Formula]]:
        """Conditions that need no model.

        Parameters
        ----------
        cheap : set of str
            Columns that are known before the models compute.

        Returns
        -------
        list of (str, Formula)
        """
        return [(status, rule) for status, rule in self.conditions if cheap.issuperset(rule.needs)]


def extras_of(
    columns: Mapping[str, Column],
    limits: Iterable[tuple[str, float, float]],
    constraints: Mapping[str, Column],
    known: Mapping[str, pl.DataType],
) -> Extras:
    """Check own columns and conditions against the columns of a study.

    Parameters
    ----------
    columns : mapping of str to Column
        Own columns.
    limits : iterable of (str, float, float)
        Expressions or own columns with their least and greatest value.
    constraints : mapping of str to Column
        Conditions.
    known : mapping of str to polars.DataType
        Columns of the study and inputs of its drive.

    Returns
    -------
    Extras

    Raises
    ------
    InputError
        For a column that is not there, or an expression of another kind than expected.
    """
    known = dict(known)
    built = []
    for name, column in columns.items():
        if name in known:
            raise InputError(f"columns.{name}: is a column of this study, expected a new name")
        built.append(formula(name, column, known, where=f"columns.{name}"))
        known[name] = built[-1].dtype
    conditions = []
    for text, least, most in limits:
        where = f"limits.{text}"
        test = Column(number(text, known, where=where).is_between(least, most))
        rule = formula(f"limit_{text}", test, known, where=where, is_condition=True)
        conditions.append((rule.name, rule))
    for name, test in constraints.items():
        where = f"constraints.{name}"
        rule = formula(f"constraint_{name}", test, known, where=where, is_condition=True)
        conditions.append((rule.name, rule))
    return Extras(tuple(built), tuple(conditions))
