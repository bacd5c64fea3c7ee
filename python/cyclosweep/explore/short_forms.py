"""Short forms of the two questions that are asked most: what is best, and what drives it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import polars as pl

from cyclosweep.errors import InputError, names_of
from cyclosweep.explore.pareto import pareto_front
from cyclosweep.explore.sobol import BatchFunction, sobol_indices
from cyclosweep.explore.tables import Table
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Study

__all__ = ["pareto", "sensitivity"]


def pareto(
    table: Table,
    *,
    minimise: str | Sequence[str] = (),
    maximise: str | Sequence[str] = (),
    **options: Any,
) -> pl.DataFrame:
    """Pareto front of a table, with the objectives named by their sense.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, as for :func:`~cyclosweep.pareto_front`.
    minimise, maximise : str or sequence of str
        Columns, or expressions of columns, that are to be small and great.
    **options
        Further arguments of :func:`~cyclosweep.pareto_front`.

    Returns
    -------
    polars.DataFrame
        The front, as :func:`~cyclosweep.pareto_front` returns it.

    Raises
    ------
    InputError
        For no objective, what is no name, and as :func:`~cyclosweep.pareto_front`.

    Examples
    --------
    >>> import cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9, 10])
    >>> pareto(space, minimise=["output_pin_count", "twist_1tn_deg"]).height
    4
    """
    wanted = []
    for what, given in (("minimise", minimise), ("maximise", maximise)):
        if isinstance(given, (list, tuple)) and not given:
            continue
        names = names_of(what, given, or_one=True)
        wanted += [Objective(name, what == "maximise") for name in names]
    if not wanted:
        raise InputError("minimise, maximise: found neither, expected an objective")
    return pareto_front(table, wanted, **options)


def sensitivity(
    model: Space | Study | BatchFunction,
    outputs: str | Sequence[str] | None = None,
    **options: Any,
) -> pl.DataFrame:
    """First-order and total Sobol indices of every input for the outputs.

    Parameters
    ----------
    model : Space, Study or function
        As for :func:`~cyclosweep.sobol_indices`.
    outputs : str or sequence of str, optional
        Results wanted; by default every number.
    **options
        Further arguments of :func:`~cyclosweep.sobol_indices`.

    Returns
    -------
    polars.DataFrame
        A row for each result and input, as :func:`~cyclosweep.sobol_indices` returns it.

    Raises
    ------
    InputError
        As :func:`~cyclosweep.sobol_indices`.

    Examples
    --------
    >>> found = sensitivity(
    ...     lambda x: 2 * x[:, 0] + x[:, 1], inputs={"a": (0.0, 1.0), "b": (0.0, 1.0)}
    ... )
    >>> found["total"].round(1).to_list()
    [0.8, 0.2]
    """
    return sobol_indices(model, outputs, **options)
