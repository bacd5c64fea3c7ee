"""Tables of pandas, pyarrow and NumPy, mappings and lists of rows, as frames of polars."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import polars as pl

from cyclosweep.errors import InputError

__all__ = ["as_frame"]


def as_frame(table: object, what: str = "frame") -> pl.DataFrame:
    """Return a table as a frame of polars.

    Parameters
    ----------
    table : polars.DataFrame or LazyFrame, pandas.DataFrame, pyarrow.Table, mapping or ndarray
        A mapping of names to columns, or a structured array, has a column for each name; a list of
        mappings has a row for each. Anything that offers Arrow's interface of streams is taken.
    what : str
        What it is called in a message.

    Returns
    -------
    polars.DataFrame

    Raises
    ------
    InputError
        For what is no table.

    Examples
    --------
    >>> as_frame({"eccentricity_mm": [0.5, 0.6]}).shape
    (2, 1)
    """
    if isinstance(table, pl.DataFrame):
        return table
    if isinstance(table, pl.LazyFrame):
        return table.collect()
    try:
        if isinstance(table, np.ndarray) and table.dtype.names is not None:
            return pl.DataFrame({name: _column(table[name]) for name in table.dtype.names})
        if isinstance(table, Mapping):
            return pl.DataFrame({name: _column(values) for name, values in table.items()})
        if isinstance(table, list) and table and all(isinstance(row, Mapping) for row in table):
            return pl.DataFrame(table, infer_schema_length=None)
        if type(table).__module__.partition(".")[0] == "pandas":
            given: Any = table
            return pl.DataFrame({str(name): _column(given[name].to_numpy()) for name in given})
        if hasattr(table, "__arrow_c_stream__"):
            return pl.DataFrame(table)
    except OverflowError:
        raise InputError(f"{what}: found an integer beyond the range of 64 bits") from None
    except (TypeError, ValueError, pl.exceptions.PolarsError) as error:
        reason = str(error).partition("\n")[0]
        raise InputError(f"{what}: not a table of columns of one length: {reason}") from None
    raise InputError(
        f"{what}: found {type(table).__name__}, expected a table of polars, pandas or pyarrow, a "
        "mapping of columns or a structured array"
    )


def _column(values: Any) -> pl.Series:
    if isinstance(values, np.ndarray) and values.dtype == object:
        # pandas keeps text and mixed columns as objects, a missing text as NaN.
        values = [None if isinstance(v, float) and np.isnan(v) else v for v in values.tolist()]
        return pl.Series(values, strict=False)
    if isinstance(values, (list, tuple)) and any(isinstance(value, str) for value in values):
        # Numbers among texts are texts, as in a file; whoever wants numbers names the cell.
        values = [None if value is None else str(value) for value in values]
    return pl.Series(values)
