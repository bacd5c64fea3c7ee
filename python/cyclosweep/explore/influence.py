"""Which input goes with which result in rows that are there: shares of variance, one pass."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError, names_of
from cyclosweep.explore.feasible import INTERVALS
from cyclosweep.explore.intervals import Cut, cut_inputs, input_columns
from cyclosweep.explore.tables import Conditions, Table, batches, conditions, open_table
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.progress import ShowProgress

__all__ = ["input_influence", "variance_share"]

_Reals = npt.NDArray[np.float64]


def input_influence(
    table: Table,
    results: str | Sequence[str] | None = None,
    limits: Conditions | None = None,
    *,
    inputs: Sequence[str] | None = None,
    intervals: int = INTERVALS,
    only_ok: bool = True,
    progress: ShowProgress = None,
) -> pl.DataFrame:
    """Share of each result's variance that goes with each input by itself.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, as for :func:`~cyclosweep.explore.pareto.pareto_front`; read batch by batch, nothing
        is evaluated anew.
    results : str or sequence of str, optional
        Columns or expressions; by default every column of numbers after a sweep's status.
    limits : mapping, sequence of str or str, optional
        Rows that count, as there.
    inputs : sequence of str, optional
        Columns looked at; by default the inputs that vary in a sweep.
    intervals : int
        Into how many equal intervals a range is cut; few values are taken one by one.
    only_ok : bool
        Whether only rows with the status ``ok`` count, where there is such a column.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    polars.DataFrame
        ``result``, ``driven_by`` (the input of the greatest share) and a column of shares [1] for
        each input; null where a result does not vary.

    Raises
    ------
    InputError
        For an unknown column, or no inputs or results given for a table that is no sweep's.

    Notes
    -----
    The share is the correlation ratio epsilon^2 of Kelley (1935): the variance of the means of
    the intervals over the whole variance, less what chance alone would give. Where the inputs are
    independent (a grid or sample, nearly all of it feasible) it estimates the first-order Sobol
    index; where they are not, an input's share holds what others do that go along with it. What
    inputs do jointly is in none of the shares: :func:`~cyclosweep.explore.sobol.sobol_indices`
    tells it.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(
    ...     cs.Drive.reference_87(), shaft_1_length_mm=[70.0, 80.0], bush_wall_mm=[1.0, 1.1]
    ... )
    >>> input_influence(space, "twist_1tn_deg")["driven_by"].item()
    'shaft_1_length_mm'
    """
    rows = open_table(table)
    names = input_columns(rows, inputs)
    if results is not None:
        wanted = names_of("results", results, or_one=True)
    else:
        columns = list(rows.schema)
        if "status" not in columns:
            raise InputError("results: none given, expected names of columns")
        after = columns[columns.index("status") + 1 :]
        wanted = [name for name in after if rows.schema[name].is_numeric()]
    kept = conditions(limits, rows.schema, only_ok=only_ok)
    values = [number(text, rows.schema, where="results") for text in wanted]
    cuts = cut_inputs(rows, names, whole_number("intervals", intervals, least=2))
    sums = [[_Sums(len(cut.low)) for cut in cuts] for _ in wanted]
    selected = [value.alias(f"__{k}") for k, value in enumerate(values)]
    flag = pl.all_horizontal(pl.lit(True), *kept).fill_null(False).alias("__inside")
    columns_read = [*(pl.col(cut.name).cast(pl.Float64) for cut in cuts), *selected, flag]
    for whole in batches(rows, columns_read, "influence of inputs", progress=progress):
        batch = whole.filter("__inside")
        if batch.is_empty():
            continue
        places = [_places(cut, batch) for cut in cuts]
        for k, of_result in enumerate(sums):
            column = batch[f"__{k}"].fill_null(np.nan).to_numpy()
            for place, sum_ in zip(places, of_result, strict=True):
                counted = np.isfinite(column) & (place >= 0)
                sum_.add(place[counted], column[counted])
    shares = [[sum_.share() for sum_ in of_result] for of_result in sums]
    return _table(wanted, [cut.name for cut in cuts], shares)


class _Sums:
    """Counts, sums and squares of a result by interval of an input."""

    def __init__(self, count: int) -> None:
        self._count, self._sum = np.zeros(count), np.zeros(count)
        self._square = 0.0
        self._origin: float | None = None

    def add(self, place: npt.NDArray[np.intp], values: _Reals) -> None:
        if len(values) == 0:
            return
        if self._origin is None:
            # About a value that is near all of them the squares keep their digits.
            self._origin = float(values.mean())
        size = len(self._count)
        deviation = values - self._origin
        self._count += np.bincount(place, minlength=size)
        self._sum += np.bincount(place, weights=deviation, minlength=size)
        self._square += float(deviation @ deviation)

    def share(self) -> float:
        if self._origin is None:
            return float("nan")
        return variance_share(self._count, self._sum, self._square, self._origin)


def variance_share(count: _Reals, sums: _Reals, square: float, origin: float) -> float:
    """Correlation ratio epsilon^2 of Kelley (1935) from sums by interval.

    Parameters
    ----------
    count, sums : ndarray, shape (intervals,)
        Number of values and sum of their deviations from `origin`.
    square : float
        Sum of all deviations squared.
    origin : float
        A value near all of them.

    Returns
    -------
    float
        Share [1] of the variance between intervals, less what chance alone would give; NaN where
        nothing varies, or there is no more than a value an interval.
    """
    rows, filled = count.sum(), count > 0
    groups = int(filled.sum())
    if rows <= groups:
        return float("nan")
    total = square - sums.sum() ** 2 / rows
    between = (sums[filled] ** 2 / count[filled]).sum() - sums.sum() ** 2 / rows
    # Rounding alone is no variance.
    if total <= 1e-24 * rows * max(origin**2, 1e-300):
        return float("nan")
    within = max(total - between, 0.0) / (rows - groups)
    return float(min(max((between - (groups - 1) * within) / total, 0.0), 1.0))


def _places(cut: Cut, batch: pl.DataFrame) -> npt.NDArray[np.intp]:
    """Interval of each row; -1 where the input has no value."""
    values = batch[cut.name].fill_null(np.nan).to_numpy()
    is_number = np.isfinite(values)
    return np.where(is_number, cut.place(np.where(is_number, values, cut.low[0])), -1)


def _table(
    results: Sequence[str], inputs: Sequence[str], shares: Sequence[Sequence[float]]
) -> pl.DataFrame:
    driven = [
        None if np.isnan(row).all() else inputs[int(np.nanargmax(row))] for row in np.array(shares)
    ]
    columns = dict(zip(inputs, np.array(shares).T, strict=True))
    return pl.DataFrame(
        {"result": list(results), "driven_by": driven, **columns},
        schema_overrides={"driven_by": pl.String},
        nan_to_null=True,
    )
