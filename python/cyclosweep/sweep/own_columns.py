"""Columns and conditions of the user's own: an expression of polars, one as text, or a function."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import polars as pl

from cyclosweep.design.units import Quantity
from cyclosweep.errors import InputError, did_you_mean
from cyclosweep.plugins import Batch, Column, check_value
from cyclosweep.sweep.expressions import condition, expression

__all__ = [
    "Column",
    "Formula",
    "Own",
    "column_of",
    "digest",
    "formula",
    "own_quantity",
    "unit_of_name",
]

Own = str | pl.Expr | Batch | Column
"""How a column of the user's own is given."""

_UNITS = {
    "_nm_per_arcmin": "N m/arcmin",
    "_nm_per_rad": "N m/rad",
    "_rad_per_nm": "rad/(N m)",
    "_n_per_mm": "N/mm",
    "_kg_m2": "kg m^2",
    "_arcmin": "arcmin",
    "_rpm": "rpm",
    "_mpa": "MPa",
    "_gpa": "GPa",
    "_deg": "deg",
    "_rad": "rad",
    "_mm3": "mm^3",
    "_mm2": "mm^2",
    "_mm": "mm",
    "_nm": "N m",
    "_kw": "kW",
    "_kg": "kg",
    "_hz": "Hz",
    "_n": "N",
    "_s": "s",
}
"""Units by the ending of a name, the longer endings first."""


def unit_of_name(name: str) -> str:
    """Unit that the ending of a name states; 1 where it states none.

    Parameters
    ----------
    name : str
        Of a column.

    Returns
    -------
    str

    Examples
    --------
    >>> unit_of_name("rim_mm"), unit_of_name("stiffness_nm_per_arcmin"), unit_of_name("cost")
    ('mm', 'N m/arcmin', '1')
    """
    return next((unit for ending, unit in _UNITS.items() if name.endswith(ending)), "1")


def own_quantity(name: str, unit: str, meaning: str) -> Quantity:
    """Unit and meaning of a column of the user's own, as stored with a dataset.

    Parameters
    ----------
    name : str
        The column.
    unit, meaning : str
        What the user said; empty for nothing.

    Returns
    -------
    Quantity
    """
    return Quantity("", unit or unit_of_name(name), meaning or "column of the study's own")


@dataclass(frozen=True, eq=False)
class Formula:
    """A column of the user's own, checked against the columns that a study has.

    Attributes
    ----------
    name : str
        The column.
    needs : tuple of str
        Columns that it is computed from.
    dtype : polars.DataType
        Float64 or Boolean.
    value : polars.Expr or callable
        How.
    """

    name: str
    needs: tuple[str, ...]
    dtype: pl.DataType
    value: pl.Expr | Batch

    def add_to(self, rows: pl.DataFrame) -> pl.DataFrame:
        """Add the column to rows that have what it needs.

        Parameters
        ----------
        rows : polars.DataFrame
            Some variants.

        Returns
        -------
        polars.DataFrame
            NaN is null there.

        Raises
        ------
        InputError
            When a function fails, or returns anything but a value for each row.
        """
        if isinstance(self.value, pl.Expr):
            column = self.value
        else:
            column = pl.lit(self._called(self.value, rows.select(self.needs)))
        column = column.cast(self.dtype)
        if self.dtype == pl.Float64():
            column = column.fill_nan(None)
        return rows.with_columns(column.alias(self.name))

    def _called(self, function: Batch, rows: pl.DataFrame) -> pl.Series:
        try:
            found = function(rows)
            if isinstance(found, pl.Expr):
                found = rows.select(found).to_series()
            values = found if isinstance(found, pl.Series) else pl.Series(np.asarray(found))
            values = values.cast(self.dtype)
        except Exception as error:
            reason = str(error).partition("\n")[0]
            raise InputError(f"{self.name}: {type(error).__name__}: {reason}") from error
        if len(values) != rows.height:
            raise InputError(
                f"{self.name}: found {len(values)} values of {rows.height} rows, expected as many"
            )
        return values


def column_of(value: object, where: str) -> Column:
    """Return a column of the user's own as such; InputError for what cannot be one.

    Parameters
    ----------
    value : str, polars.Expr, callable or Column
        What the user gave.
    where : str
        For the message.

    Returns
    -------
    Column
    """
    if isinstance(value, Column):
        return value
    check_value(where, value)
    return Column(cast(Any, value))


def formula(
    name: str,
    column: Column,
    columns: Mapping[str, pl.DataType],
    *,
    where: str,
    is_condition: bool = False,
) -> Formula:
    """Check a column of the user's own against the columns that a study has.

    Parameters
    ----------
    name : str
        The column.
    column : Column
        What the user gave.
    columns : mapping of str to polars.DataType
        Columns of the study before it, and the drive's inputs that do not vary.
    where : str
        What a message names.
    is_condition : bool
        Whether it has to be true or false.

    Returns
    -------
    Formula

    Raises
    ------
    InputError
        For a column that is not there, or a value that does not follow from one row alone.
    """
    value = column.value
    if isinstance(value, str):
        read = condition if is_condition else expression
        value = read(value, columns, where=where)
    needs = column.needs
    if isinstance(value, pl.Expr):
        needs = list(dict.fromkeys(value.meta.root_names()))
    for other in needs or ():
        if other not in columns:
            raise InputError(f"{where}: no column {other}{did_you_mean(other, columns)}")
    if isinstance(value, pl.Expr):
        dtype = _dtype_of(value, columns, where)
    else:
        dtype = pl.Boolean() if is_condition or column.is_condition else pl.Float64()
    if is_condition and dtype != pl.Boolean():
        raise InputError(f"{where}: found {dtype}, expected true or false")
    return Formula(name, tuple(columns if needs is None else needs), dtype, value)


def _dtype_of(value: pl.Expr, columns: Mapping[str, pl.DataType], where: str) -> pl.DataType:
    if value.meta.has_multiple_outputs():
        raise InputError(f"{where}: found several columns in {value}, expected one")
    try:
        frame = pl.LazyFrame(schema=dict(columns)).select(value.alias("value"))
        dtype = frame.collect_schema()["value"]
    except pl.exceptions.PolarsError as error:
        raise InputError(f"{where}: {str(error).splitlines()[0]}") from None
    if dtype != pl.Boolean() and not dtype.is_numeric():
        raise InputError(f"{where}: found {dtype}, expected a number or a truth value")
    if _reads_other_rows(value, columns):
        raise InputError(f"{where}: found {value}, expected a value that follows from its own row")
    return pl.Boolean() if dtype == pl.Boolean() else pl.Float64()


def _reads_other_rows(value: pl.Expr, columns: Mapping[str, pl.DataType]) -> bool:
    """Whether an expression gives something else for three rows than for each of them alone."""
    numbers: dict[str, list[float]] = {"n": [1, 2, 5], "x": [0.3, 1.7, 4.1]}
    rows = pl.DataFrame(
        {
            name: pl.Series(numbers["x" if dtype.is_float() else "n"]).cast(dtype)
            if dtype.is_numeric()
            else pl.Series([None] * 3, dtype=dtype)
            for name in dict.fromkeys(value.meta.root_names())
            for dtype in [columns[name]]
        }
    )
    if rows.width == 0:
        return False
    together = rows.with_columns(value.alias("value"))["value"]
    alone = [rows[k : k + 1].with_columns(value.alias("value"))["value"] for k in range(3)]
    return not together.equals(pl.concat(alone), null_equal=True)


def digest(column: Column) -> str:
    """What identifies a column of the user's own in a study's hash.

    Parameters
    ----------
    column : Column
        The column.

    Returns
    -------
    str
        The text of an expression; of a function its name and a digest of its own code, so that
        a change in what it calls is not seen.
    """
    if isinstance(column.value, str):
        return column.value
    if isinstance(column.value, pl.Expr):
        return hashlib.sha256(column.value.meta.serialize()).hexdigest()
    code: Any = getattr(column.value, "__code__", None)
    name = getattr(column.value, "__qualname__", type(column.value).__qualname__)
    text = (name, column.needs, code and (code.co_code, code.co_names, repr(_constants(code))))
    return hashlib.sha256(repr(text).encode()).hexdigest()


def _constants(code: Any) -> list[object]:
    """Constants of a function's code; of functions within it their code, not their address."""
    return [
        (each.co_code, _constants(each)) if hasattr(each, "co_code") else each
        for each in code.co_consts
    ]
