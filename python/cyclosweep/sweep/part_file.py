"""One Parquet file of a study: written by the core from its own arrays, or by polars."""

from __future__ import annotations

from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
import polars as pl

import cyclosweep._core as _core
from cyclosweep.sweep.kernel_columns import KernelArrays

if TYPE_CHECKING:
    import numpy.typing as npt

__all__ = ["COMPRESSION", "write_arrays", "write_rows"]

COMPRESSION: Literal["lz4"] = "lz4"

_Schema = tuple[tuple[str, pl.DataType], ...]


def write_rows(
    rows: pl.DataFrame, file: Path, metadata: dict[str, str], rows_per_group: int
) -> None:
    """Write a table as a Parquet file.

    Parameters
    ----------
    rows : polars.DataFrame
        What is written.
    file : Path
        Where; what is there is replaced.
    metadata : dict of str to str
        Keys and texts of the footer.
    rows_per_group : int
        Rows of a row group at most.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    rows.write_parquet(
        file, compression=COMPRESSION, row_group_size=rows_per_group, metadata=metadata
    )


def write_arrays(
    arrays: KernelArrays,
    rows: pl.DataFrame,
    file: Path,
    metadata: dict[str, str],
    rows_per_group: int,
) -> None:
    """Write a table of what the models computed, faster than :func:`write_rows`.

    The core writes the real numbers: as they are, compressed only where they repeat. All other
    columns are encoded by polars and appended. Schema, types, values, nulls and the range of every
    column are those that polars writes.

    Parameters
    ----------
    arrays : KernelArrays
        What the models computed.
    rows : polars.DataFrame
        Columns of it as a table, all of its rows.
    file, metadata, rows_per_group
        As for :func:`write_rows`.

    Raises
    ------
    OSError
        When it cannot be written.
    """
    built = None
    if arrays.any_refused and arrays.status is not None:
        built = arrays.status == 0
    reals = {name for name, dtype in rows.schema.items() if dtype == pl.Float64}
    others = BytesIO()
    rows.select(pl.exclude(reals)).write_parquet(
        others, compression=COMPRESSION, row_group_size=rows_per_group
    )
    _core.write_parquet(
        str(file),
        _template(tuple(rows.schema.items())),
        others.getvalue(),
        list(metadata.items()),
        [_reals(arrays, name, built) if name in reals else None for name in rows.columns],
        rows.height,
        rows_per_group,
    )


@cache
def _template(schema: _Schema) -> bytes:
    """File without rows, whose schema is that which polars gives to such columns."""
    file = BytesIO()
    pl.DataFrame(schema=dict(schema)).write_parquet(file)
    return file.getvalue()


def _reals(
    arrays: KernelArrays, name: str, built: npt.NDArray[np.bool_] | None
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_] | None]:
    """Values of a column, and in which rows there is one; none where there is in all."""
    values = np.asarray(arrays.inputs.get(name, arrays.results.get(name)), dtype=np.float64)
    if name in arrays.inputs:
        return values, None
    if name in arrays.may_not_apply and (absent := np.isnan(values)).any():
        return values, ~absent if built is None else built & ~absent
    return values, built
