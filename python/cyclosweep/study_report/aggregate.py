"""Counts, means and spreads of a study by its inputs, gathered batch by batch."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.explore.influence import variance_share
from cyclosweep.explore.tables import Conditions, Rows, batches, conditions
from cyclosweep.sweep.expressions import number
from cyclosweep.sweep.stored import StoredStudy

__all__ = ["Aggregate", "AxisBins", "aggregate"]

Reals = npt.NDArray[np.float64]
Counts = npt.NDArray[np.int64]

BINS = 24
"""Stretches into which an input is cut; one with fewer values has a stretch for each."""
CELLS = (96, 64)
"""Cells of the picture of all variants, across and up: each some pixels wide."""


@dataclass(frozen=True)
class AxisBins:
    """One input, cut into stretches.

    Attributes
    ----------
    name : str
        The input.
    centres : ndarray, shape (bins,)
        Middle of each stretch, or the value itself, in the input's unit.
    is_listed : bool
        Whether each stretch is one value.
    total, feasible : ndarray, shape (bins,)
        Variants in each, and those that can be built and keep the limits.
    means, deviations : dict of str to ndarray, shape (bins,)
        Mean and standard deviation of each outcome over the feasible ones; NaN where none is.
    shares : dict of str to float
        Share of each outcome's variance that goes with this input alone, 0 to 1.
    """

    name: str
    centres: Reals
    is_listed: bool
    total: Counts
    feasible: Counts
    means: dict[str, Reals]
    deviations: dict[str, Reals]
    shares: dict[str, float]


@dataclass(frozen=True)
class Aggregate:
    """What one reading of a study's rows gathered.

    Attributes
    ----------
    rows, feasible : int
        Variants, and those that can be built and keep the limits.
    axes : list of AxisBins
        By input.
    ranges : dict of str to (float, float)
        Least and greatest value of each outcome.
    cells : ndarray, shape (across, up), or None
        Feasible variants in each cell of the plane of the first two outcomes.
    """

    rows: int
    feasible: int
    axes: list[AxisBins]
    ranges: dict[str, tuple[float, float]]
    cells: Counts | None


class _Axis:
    """Sums by the stretches of one input."""

    def __init__(self, name: str, values: Reals, is_listed: bool, outcomes: int) -> None:
        self.name, self.is_listed = name, is_listed
        self.values = values
        bins = len(values) if is_listed else BINS
        self.total = np.zeros(bins, np.int64)
        self.feasible = np.zeros(bins, np.int64)
        self.count = np.zeros((outcomes, bins))
        self.sums = np.zeros((outcomes, bins))
        self.squares = np.zeros((outcomes, bins))

    def place(self, column: Reals) -> npt.NDArray[np.intp]:
        """Stretch of each value; the number of stretches where it lies in none."""
        bins = len(self.total)
        if self.is_listed:
            place = np.searchsorted(self.values, column)
            inside = self.values[np.minimum(place, bins - 1)] == column
        else:
            low, high = self.values
            with np.errstate(invalid="ignore"):
                scaled = (column - low) * (bins / (high - low))
                inside = (scaled >= 0) & (scaled <= bins)
            place = np.where(inside, scaled, 0.0).astype(np.intp)
            place = np.minimum(place, bins - 1)
        return np.where(inside, place, bins)

    def add(self, column: Reals, ok: npt.NDArray[np.bool_], outcomes: Sequence[Reals]) -> None:
        """Count a batch; outcomes are less a value near their mean, which keeps sums exact."""
        bins = len(self.total)
        place = self.place(column)
        self.total += np.bincount(place, minlength=bins + 1)[:bins]
        kept = place[ok]
        self.feasible += np.bincount(kept, minlength=bins + 1)[:bins]
        for k, outcome in enumerate(outcomes):
            is_number = np.isfinite(outcome)
            at, y = (kept, outcome) if is_number.all() else (kept[is_number], outcome[is_number])
            self.count[k] += np.bincount(at, minlength=bins + 1)[:bins]
            self.sums[k] += np.bincount(at, y, minlength=bins + 1)[:bins]
            self.squares[k] += np.bincount(at, y * y, minlength=bins + 1)[:bins]

    def result(self, names: Sequence[str], shifts: Sequence[float]) -> AxisBins:
        """Means, spreads and shares; shifts are added to the means again."""
        means, deviations, shares = {}, {}, {}
        for k, name in enumerate(names):
            count, sums, squares = self.count[k], self.sums[k], self.squares[k]
            with np.errstate(invalid="ignore", divide="ignore"):
                mean = sums / count
                deviation = np.sqrt(np.maximum(squares / count - mean**2, 0.0))
            means[name], deviations[name] = mean + shifts[k], deviation
            share = variance_share(count, sums, float(squares.sum()), shifts[k])
            shares[name] = 0.0 if math.isnan(share) else share
        if self.is_listed:
            centres = self.values
        else:
            edges = np.linspace(self.values[0], self.values[1], BINS + 1)
            centres = 0.5 * (edges[1:] + edges[:-1])
        return AxisBins(
            self.name, centres, self.is_listed, self.total, self.feasible, means, deviations, shares
        )


def aggregate(
    study: StoredStudy,
    rows: Rows,
    outcomes: Sequence[str],
    limits: Conditions | None = None,
    *,
    progress: bool | None = None,
) -> Aggregate:
    """Read a study's rows once for counts, means and spreads by its inputs.

    Parameters
    ----------
    study : StoredStudy
        The study.
    rows : Rows
        Its rows.
    outcomes : sequence of str
        Columns or expressions; the first two span the picture of all variants.
    limits : mapping or sequence of str, optional
        Conditions besides the study's own that a feasible variant keeps.
    progress : bool, optional
        Whether there is a bar.

    Returns
    -------
    Aggregate
        Of sizes that do not depend on the number of variants.

    Notes
    -----
    The share of an input is the variance of the outcome's mean over the input's stretches over
    the outcome's whole variance, among feasible variants: the first-order Sobol index where the
    inputs vary independently, less the part that chance gives (omega squared of an analysis of
    variance).
    """
    values = [number(text, rows.schema, where="outcome") for text in outcomes]
    # What follows from other inputs has no share of its own.
    drawn = {axis["name"] for axis in study.definition["axes"]}
    names = [name for name in study.axes if name in drawn and name in rows.schema]
    numbers = [pl.col(name).to_physical().cast(pl.Float64) if isinstance(rows.schema[name], pl.Enum)
               else pl.col(name).cast(pl.Float64) for name in names]  # fmt: skip
    extents = _extents(study, rows, outcomes, values, names, numbers, progress)
    shifts = [0.5 * (extents[text][0] + extents[text][1]) for text in outcomes]
    axes = [_Axis(name, *_stretches(study, name, extents[name]), len(outcomes)) for name in names]
    cells = np.zeros(CELLS, np.int64) if len(outcomes) > 1 else None
    total = feasible = 0
    columns = [
        pl.all_horizontal(conditions(limits, rows.schema)).fill_null(False).alias("__ok"),
        *(each.alias(f"__axis_{k}") for k, each in enumerate(numbers)),
        *(each.alias(f"__outcome_{k}") for k, each in enumerate(values)),
    ]
    for batch in batches(rows, columns, "gathering", progress=progress):
        ok = batch["__ok"].to_numpy()
        total += len(ok)
        feasible += int(ok.sum())
        inner = batch.filter("__ok")
        found = [
            inner[f"__outcome_{k}"].fill_null(math.nan).to_numpy() - shift
            for k, shift in enumerate(shifts)
        ]
        for k, axis in enumerate(axes):
            axis.add(batch[f"__axis_{k}"].fill_null(math.nan).to_numpy(), ok, found)
        if cells is not None:
            ranges = [
                [extents[text][0] - shift, _above(extents[text]) - shift]
                for text, shift in zip(outcomes[:2], shifts[:2], strict=True)
            ]
            counted, _, _ = np.histogram2d(found[0], found[1], bins=CELLS, range=ranges)
            cells += counted.astype(np.int64)
    return Aggregate(
        total,
        feasible,
        [axis.result(outcomes, shifts) for axis in axes],
        {text: extents[text] for text in outcomes},
        cells,
    )


def _above(extent: tuple[float, float]) -> float:
    low, high = extent
    return high if high > low else low + max(abs(low), 1.0) * 1e-9


def _stretches(study: StoredStudy, name: str, extent: tuple[float, float]) -> tuple[Reals, bool]:
    """Values of an input that has few of them, or the two ends between which it lies."""
    axis = next(each for each in study.definition["axes"] if each["name"] == name)
    given = np.array([float(text) for text in axis.get("numbers", ())])
    if axis["form"] == "list" and 0 < len(given) <= BINS:
        return np.unique(given[np.isfinite(given)]), True
    if axis["form"] == "linspace" and len(given) == 3 and given[2] <= BINS:
        return np.linspace(given[0], given[1], int(given[2])), True
    if axis["form"] == "whole" and len(given) == 2 and given[1] - given[0] < BINS:
        return np.arange(given[0], given[1] + 1), True
    low, high = extent
    return np.array([low, high if high > low else low + max(abs(low), 1.0) * 1e-9]), False


def _extents(
    study: StoredStudy,
    rows: Rows,
    outcomes: Sequence[str],
    values: Sequence[pl.Expr],
    names: Sequence[str],
    numbers: Sequence[pl.Expr],
    progress: bool | None,
) -> dict[str, tuple[float, float]]:
    """Least and greatest value of inputs and outcomes; read from the rows where not yet known."""
    known = dict(_of_axes(study.definition["axes"]))
    known.update({k: v for k, v in study.summary.ranges.items() if k not in names})
    asked = {**dict(zip(names, numbers, strict=True)), **dict(zip(outcomes, values, strict=True))}
    missing = {name: value for name, value in asked.items() if name not in known}
    if missing:
        ok = pl.col("status").cast(pl.String) == "ok"
        columns = [
            (value if name in names else pl.when(ok).then(value)).alias(f"__{k}")
            for k, (name, value) in enumerate(missing.items())
        ]
        ends = dict.fromkeys(missing, (math.inf, -math.inf))
        for batch in batches(rows, columns, "ranges", progress=progress):
            for k, name in enumerate(missing):
                column = batch[f"__{k}"].drop_nulls().drop_nans()
                low, high = column.min(), column.max()
                if isinstance(low, float) and isinstance(high, float):
                    ends[name] = (min(ends[name][0], low), max(ends[name][1], high))
        known.update({k: v if v[0] <= v[1] else (0.0, 1.0) for k, v in ends.items()})
    return {name: known[name] for name in asked}


def _of_axes(axes: Sequence[Mapping[str, object]]) -> list[tuple[str, tuple[float, float]]]:
    """Ends of the inputs whose definition tells them."""
    found = []
    for axis in axes:
        listed = axis.get("numbers")
        if not isinstance(listed, list) or axis["form"] not in ("list", "linspace", "interval",
                                                                "whole"):  # fmt: skip
            continue
        given = [float(text) for text in listed]
        ends = given[:2] if axis["form"] != "list" else [v for v in given if math.isfinite(v)]
        if ends:
            found.append((str(axis["name"]), (min(ends), max(ends))))
    return found
