"""Sobol indices: what share of a result's variance each input makes, to a stated accuracy."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
import polars as pl

import cyclosweep._core as _core
from cyclosweep.design.numbers import finite_number, whole_number
from cyclosweep.errors import InputError, did_you_mean, instance_of, names_of
from cyclosweep.explore.tables import Rows, batches
from cyclosweep.sweep.distributions import Distribution, uniform
from cyclosweep.sweep.progress import ShowProgress
from cyclosweep.sweep.scan import scan
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Study

__all__ = ["driving_inputs", "sobol_indices"]

_Reals = npt.NDArray[np.float64]

BatchFunction = Callable[[_Reals], Any]
"""Takes points, shape (points, inputs), and returns a result of shape (points,), or several by
name."""

_RESAMPLES = 100
"""Bootstrap resamples of a half-width: it then has an error of 7 %, and memory stays moderate."""
_BATCH_POINTS = 100_000
"""Points that a function is given at a time, at most."""
_LEAST_DRAWS = 32
"""Draws without which there is no estimate: a bootstrap of fewer says nothing."""

SCHEMA: dict[str, Any] = {
    "result": pl.String, "input": pl.String,
    "first_order": pl.Float64, "first_order_half_width": pl.Float64,
    "total": pl.Float64, "total_half_width": pl.Float64,
    "draws": pl.UInt32, "share_used": pl.Float64,
}  # fmt: skip
"""Columns of a table of Sobol indices."""


class _Model(Protocol):
    """What is evaluated: draws first..last, one row a draw and a column a point of it."""

    inputs: tuple[str, ...]

    def values(self, first: int, last: int) -> dict[str, _Reals]: ...


class _Accuracy(NamedTuple):
    half_width: float
    confidence: float
    first: int
    most: int
    seed: int


def sobol_indices(
    model: Space | Study | BatchFunction,
    results: str | Sequence[str] | None = None,
    *,
    inputs: Mapping[str, Distribution | tuple[float, float]] | None = None,
    half_width: float = 0.05,
    confidence: float = 0.95,
    first_draws: int = 256,
    most_draws: int = 2**15,
    seed: int = 0,
    progress: ShowProgress = None,
) -> pl.DataFrame:
    """First-order and total Sobol indices of every input for every result.

    Parameters
    ----------
    model : Space, Study or function
        A space or study, whose inputs are drawn independently from its axes' ranges, lists and
        distributions (its layout, limits and constraints do not count); or a function of your
        own that takes points of shape (points, inputs) and returns a result of shape (points,),
        or a mapping of such results.
    results : str or sequence of str, optional
        Results wanted; by default every number that the study or function gives.
    inputs : mapping, optional
        For a function alone: a distribution or ``(low, high)`` of each input, in order.
    half_width : float
        Half-width of the confidence interval that is to be reached [1].
    confidence : float
        Of that interval [1].
    first_draws, most_draws : int
        Draws begun with, doubled until the half-width is reached for a result or there would be
        more than the most. A draw takes as many evaluations as there are inputs, and two.
    seed : int
        Seed of the sample and of the bootstrap.
    progress : bool or callable, optional
        Whether there is a progress bar, by default on a terminal after two seconds; or a
        function that is told how much is done and how much there is.

    Returns
    -------
    polars.DataFrame
        A row for each result and input: ``first_order``, the share of the result's variance that
        the input makes by itself; ``total``, its share together with what it does jointly with
        others; their half-widths; ``draws``; ``share_used``, the share of draws in which every
        variant has the result. Null where a result does not vary or too few draws have it.

    Raises
    ------
    InputError
        For an unknown result, a study of a table, or a function that returns something else.

    Notes
    -----
    The sample is that of Saltelli [1]_ from scrambled Sobol points, made and evaluated by the
    core; estimators and bootstrap are SALib's [2]_ (``pip install 'cyclosweep[explore]'``).
    Draws with an infeasible variant are left out. Indices are shares of the variance over the
    ranges asked for only where ``share_used`` is near 1; elsewhere the inputs are no longer
    independent, and narrower ranges say more. An estimate below zero is zero within its error.

    .. [1] A. Saltelli et al., "Variance based sensitivity analysis of model output",
       Comput. Phys. Commun. 181 (2010), doi:10.1016/j.cpc.2009.09.018, Table 2 (b) and (f).
    .. [2] J. Herman and W. Usher, "SALib", J. Open Source Softw. 2 (2017),
       doi:10.21105/joss.00097.

    Examples
    --------
    >>> found = sobol_indices(
    ...     lambda x: 2 * x[:, 0] + x[:, 1], inputs={"a": (0.0, 1.0), "b": (0.0, 1.0)}
    ... )
    >>> found.select("input", pl.col("total").round(1)).rows()
    [('a', 0.8), ('b', 0.2)]
    """
    accuracy = _Accuracy(
        finite_number("half_width", half_width), finite_number("confidence", confidence),
        whole_number("first_draws", first_draws, least=_LEAST_DRAWS),
        whole_number("most_draws", most_draws, least=_LEAST_DRAWS),
        whole_number("seed", seed, least=0, most=2**32 - 1),
    )  # fmt: skip
    if not accuracy.half_width > 0:
        raise InputError(f"half_width: found {half_width:g}, expected more than 0")
    if not 0.5 <= accuracy.confidence < 1:
        raise InputError(f"confidence: found {confidence:g}, expected 0.5 to 1")
    wanted = None
    if results is not None:
        wanted = names_of("results", results, or_one=True)
    if isinstance(model, Space | Study):
        if inputs is not None:
            raise InputError("inputs: only for a function, a space has its axes")
        study = Study.of(model)
        known = _known_results(study, wanted)
        return _refined(_Sweep(study, known, accuracy, progress), known, accuracy)
    if not callable(model):
        raise InputError(f"model: found {model!r}, expected a space, a study or a function")
    if not inputs:
        raise InputError("inputs: none, expected a range or distribution of each input")
    return _refined(_Function(model, inputs, accuracy.seed), wanted, accuracy)


def driving_inputs(indices: pl.DataFrame) -> pl.DataFrame:
    """Which input drives which result: total Sobol indices, a row a result, a column an input.

    Parameters
    ----------
    indices : polars.DataFrame
        What :func:`sobol_indices` returned.

    Returns
    -------
    polars.DataFrame
        ``result``, ``driven_by`` (the input of the greatest total index; null where the result
        does not vary) and a column of total indices [1] for each input.

    Raises
    ------
    InputError
        For a table without these columns.
    """
    instance_of("indices", indices, pl.DataFrame)
    for name in ("result", "input", "total"):
        if name not in indices.columns:
            raise InputError(
                f"indices: no column {name}, expected a table as sobol_indices returns it"
            )
    wide = indices.pivot("input", index="result", values="total", maintain_order=True)
    most = (
        indices.filter(pl.col("total").is_not_null())
        .sort("total", descending=True, maintain_order=True)
        .group_by("result", maintain_order=True)
        .agg(pl.col("input").first().alias("driven_by"))
    )
    inputs = [name for name in wide.columns if name != "result"]
    whole = wide.join(most, on="result", how="left", maintain_order="left")
    return whole.select("result", "driven_by", *inputs)


class _Sweep:
    """Draws of a study's inputs, swept."""

    def __init__(
        self, study: Study, results: Sequence[str], accuracy: _Accuracy, progress: ShowProgress
    ) -> None:
        space = study.space
        if space.method == "table":
            raise InputError("sensitivity: found the rows of a table, expected axes with ranges")
        if not space.axes:
            raise InputError("sensitivity: no axes, expected at least one input that varies")
        self.inputs = tuple(axis.name for axis in space.axes)
        self._group = len(space.axes) + 2
        drawn = dataclasses.replace(
            space, method="saltelli", total=self._group, seed=accuracy.seed, start=0, stop=1
        )
        # Limits and constraints say what is wanted, not what the physics gives.
        self._study = dataclasses.replace(
            study, space=drawn, limits=(), constraints={}, objectives=(), keep=None, only_ok=False
        )
        self._results, self._progress = list(results), progress

    def values(self, first: int, last: int) -> dict[str, _Reals]:
        """Every result of draws first..last, shape (draws, inputs + 2); NaN where there is none."""
        start, stop = first * self._group, last * self._group
        space = dataclasses.replace(self._study.space, total=stop, start=start, stop=stop)
        study = dataclasses.replace(self._study, space=space)
        found = {name: np.full(stop - start, np.nan) for name in self._results}
        rows = Rows(scan(study), study.schema(), stop - start)
        columns = [pl.col(name).cast(pl.Float64) for name in self._results]
        label = f"sensitivity, {last:,} draws"
        for batch in batches(rows, [pl.col("variant"), *columns], label, progress=self._progress):
            place = batch["variant"].to_numpy() - np.uint64(start)
            for name, values in found.items():
                values[place] = batch[name].to_numpy()
        return {name: values.reshape(-1, self._group) for name, values in found.items()}


class _Function:
    """Draws of a function's inputs, in batches."""

    def __init__(
        self,
        function: BatchFunction,
        inputs: Mapping[str, Distribution | tuple[float, float]],
        seed: int,
    ) -> None:
        self.inputs = tuple(inputs)
        self._function, self._seed = function, seed
        self._axes = [
            (name, *(given if isinstance(given, Distribution) else uniform(*given)).core())
            for name, given in inputs.items()
        ]

    def values(self, first: int, last: int) -> dict[str, _Reals]:
        """Every result of draws first..last, shape (draws, inputs + 2)."""
        group = len(self.inputs) + 2
        found: dict[str, list[_Reals]] = {}
        for points in self._points(first * group, last * group):
            for name, column in _by_name(self._function(points), len(points)).items():
                found.setdefault(name, []).append(column)
        return {name: np.concatenate(parts).reshape(-1, group) for name, parts in found.items()}

    def _points(self, start: int, stop: int) -> Iterator[_Reals]:
        for begin in range(start, stop, _BATCH_POINTS):
            end = min(begin + _BATCH_POINTS, stop)
            yield _core.sample(self._axes, "saltelli", stop, self._seed, begin, end).T


def _by_name(returned: Any, count: int) -> dict[str, _Reals]:
    """Results of a function by name; InputError unless there is a number for each point."""
    given = returned if isinstance(returned, Mapping) else {"result": returned}
    found = {}
    for name, values in given.items():
        column = np.asarray(values, dtype=np.float64)
        if column.shape != (count,):
            raise InputError(
                f"function: {name} has shape {column.shape}, expected ({count},), a number a point"
            )
        found[str(name)] = column
    return found


def _known_results(study: Study, wanted: Sequence[str] | None) -> list[str]:
    axes = {axis.name for axis in study.space.axes}
    known = [
        name
        for name, dtype in study.schema().items()
        if name not in axes and name != "variant" and (dtype.is_numeric() or dtype == pl.Boolean())
    ]
    for name in wanted or ():
        if name not in known:
            raise InputError(f"results: no column {name}{did_you_mean(name, known)}")
    kept = known if study.keep is None else [name for name in known if name in study.keep]
    return list(wanted or kept)


def _refined(model: _Model, wanted: Sequence[str] | None, accuracy: _Accuracy) -> pl.DataFrame:
    """Double the sample until every result is known well enough, or there are enough draws."""
    draws = min(accuracy.first, accuracy.most)
    values = model.values(0, draws)
    names = list(values if wanted is None else wanted)
    for name in names:
        if name not in values:
            raise InputError(f"results: no result {name}{did_you_mean(name, values)}")
    tables: dict[str, pl.DataFrame] = {}
    while True:
        for name in names:
            if name not in tables or not _is_known(tables[name], accuracy.half_width):
                tables[name] = _indices(name, model.inputs, values[name], accuracy)
        if 2 * draws > accuracy.most or all(
            _is_known(tables[name], accuracy.half_width) for name in names
        ):
            return pl.concat([tables[name] for name in names])
        more = model.values(draws, 2 * draws)
        values = {name: np.concatenate([values[name], more[name]]) for name in values}
        draws *= 2


def _is_known(table: pl.DataFrame, half_width: float) -> bool:
    """Whether all half-widths are reached; where a result does not vary there are none to reach."""
    widths = table.select("first_order_half_width", "total_half_width").to_numpy()
    return not np.any(widths > half_width) and not _is_scarce(table)


def _is_scarce(table: pl.DataFrame) -> bool:
    used = table["share_used"][0] * table["draws"][0]
    return bool(0 < used < _LEAST_DRAWS)


def _indices(name: str, inputs: Sequence[str], values: _Reals, accuracy: _Accuracy) -> pl.DataFrame:
    """Indices of one result from what there is of it."""
    try:
        from SALib.analyze import sobol
    except ImportError as error:
        raise InputError("Sobol indices need SALib: pip install 'cyclosweep[explore]'") from error
    whole = values[np.isfinite(values).all(axis=1)]
    count = len(inputs)
    empty = np.full(count, np.nan)
    found = dict.fromkeys(("S1", "S1_conf", "ST", "ST_conf"), empty)
    # Rounding alone is no variance.
    varies = whole.size > 0 and np.ptp(whole) > 1e-12 * np.abs(whole).max()
    if len(whole) >= _LEAST_DRAWS and varies:
        problem = {"num_vars": count, "names": list(inputs), "bounds": [[0.0, 1.0]] * count}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            found = sobol.analyze(
                problem, whole.reshape(-1), calc_second_order=False, num_resamples=_RESAMPLES,
                conf_level=accuracy.confidence, print_to_console=False,
                # Zero is no seed to SALib.
                seed=accuracy.seed + 1,
            )  # fmt: skip
    columns = {
        "result": [name] * count, "input": list(inputs),
        "first_order": found["S1"], "first_order_half_width": found["S1_conf"],
        "total": found["ST"], "total_half_width": found["ST_conf"],
        "draws": [len(values)] * count, "share_used": [len(whole) / len(values)] * count,
    }  # fmt: skip
    return pl.DataFrame(columns, schema=SCHEMA, nan_to_null=True)
