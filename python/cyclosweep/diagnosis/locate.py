"""Location: where recording and simulation differ in torque, direction, run, place and time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np

from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.hypotheses.behaviour_classes import MOST_POSITIONS, MOST_RUNS
from cyclosweep.diagnosis.hypotheses.shape_columns import clock_of
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.local_events import event_rows
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.prepare.split import recorded_runs
from cyclosweep.result.mismatch import Direction, Region
from cyclosweep.simulation.effects.history import Flags, Floats
from cyclosweep.simulation.effects.mesh_range import mesh_positions

MOST_REGIONS = 4
"""Regions that are given at most."""
DRAWS = 500
"""Simulated residuals."""
LEVEL = 0.05
"""Probability by noise alone below which a region is given."""
LEAST_LEFT = 0.2
"""Share of a cell that earlier regions have to leave for it to become one itself."""
MOST_TAKEN = 0.5
"""Share of its rows that earlier regions may hold."""
BANDS = 8
"""Bands of torque on either side of zero."""
SECTORS = 12
"""Parts of a turn that are cells where the mesh was turned past more positions."""
LEAST_CHANCE = 0.002
"""Probability that is stated of an event: noise of the size of the others makes none."""
STRETCHES = (10, 30)
"""Numbers of equal stretches into which the recording is cut."""


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cell:
    """Rows of the recording that may form a region, and their limits."""

    rows: Flags
    torque: tuple[float, float] | None = None
    direction: Direction | None = None
    run: tuple[int, int] | None = None
    time: tuple[float, float] | None = None
    crank: tuple[float, float] | None = None
    readings: tuple[int, int] | None = None


def locate(concluded: Conclusion) -> tuple[Region, ...]:
    """Return where model and recording differ.

    Parameters
    ----------
    concluded : Conclusion
        With the baseline and the accepted structure.

    Returns
    -------
    tuple of Region
        The strongest first; none where nothing is missing. Where something remains without a name
        beside accepted effects, the regions are those in which these fail; where noise and model
        error hide where that is, those of the calibrated model.
    """
    search, accepted = concluded.search, concluded.accepted
    found: list[Region] = []
    if search.baseline.largest_excess >= search.threshold:
        found = find_regions(search, search.baseline)
    if concluded.decision.unexplained:
        left = find_regions(search, accepted) if accepted.fit.terms else []
        events = event_regions(search.problem, accepted)
        if accepted.fit.terms:
            left, events = _of_repaired(left), _of_repaired(events)
        found = (events + (left or found))[:MOST_REGIONS]
    return tuple(found)


def _of_repaired(regions: Sequence[Region]) -> list[Region]:
    """Mark regions as those in which the repaired model is off."""
    return [replace(region, repaired=True) for region in regions]


def event_regions(problem: Problem, accepted: Candidate) -> list[Region]:
    """Regions of events: stretches of a few runs that are far off all others.

    Parameters
    ----------
    problem : Problem
        The recording prepared for fitting.
    accepted : Candidate
        The structure beside which they stand out.

    Returns
    -------
    list of Region
        The largest first.
    """
    use, labels = np.flatnonzero(problem.fitted), recorded_runs(problem)
    left = accepted.fit.residual_deg
    run = problem.history.run[use]
    event = np.flatnonzero(event_rows(left, np.zeros((len(left), 0)), run))
    if not len(event):
        return []
    all_squares = float(left @ left)
    found = []
    for part in np.split(event, np.flatnonzero(np.diff(event) > 1) + 1):
        rows = np.zeros(len(problem.fitted), dtype=bool)
        rows[use[part]] = True
        cell = _stretch(problem, rows, labels)
        share = float(left[part] @ left[part]) / all_squares
        found.append(_region(problem, cell, float(left[part].mean()), share, LEAST_CHANCE))
    return sorted(found, key=lambda region: region.share_of_excess or 0.0, reverse=True)


def find_regions(search: Search, candidate: Candidate) -> list[Region]:
    """Find regions with error control, each after the ones before are taken out.

    The statistic is the largest standardised cell mean of the projected residual; its distribution
    is simulated under the model of the candidate.

    Parameters
    ----------
    search : Search
        The recording with its noise.
    candidate : Candidate
        The structure whose residual is searched.

    Returns
    -------
    list of Region
        The strongest first.
    """
    problem, fitted, use = search.problem, candidate.fit, search.problem.fitted
    cells = _cells(problem)
    if not cells:
        return []
    columns = np.column_stack([cell.rows[use].astype(np.float64) for cell in cells])
    white = fitted.whitened(columns, fitted.noise)
    white = white - fitted.tangent @ (fitted.tangent.T @ white)
    gram = white.T @ white
    size = np.sqrt(np.diag(gram))
    testable = size > 1e-6 * max(float(size.max()), 1e-300)
    size = np.where(testable, size, np.inf)
    maxima = _largest_by_chance(gram, size, DRAWS, np.random.default_rng([search.seed, 2]))
    raw, residual = fitted.residual_deg, fitted.residual
    found: list[Region] = []
    squares: list[float] = []
    taken = np.zeros(len(raw), dtype=bool)
    for _ in range(MOST_REGIONS):
        z = np.abs(white.T @ residual) / size
        best = int(np.argmax(z))
        p = (1 + np.count_nonzero(maxima >= z[best])) / (1 + DRAWS)
        if p > LEVEL or not testable[best]:
            break
        rows = cells[best].rows[use]
        found.append(_region(problem, cells[best], float(raw[rows].mean()), 0.0, p))
        # Rows of several regions count in the first, so that all shares are at most the whole.
        new = raw[rows & ~taken]
        squares.append(len(new) * float(new.mean()) ** 2)
        taken |= rows
        direction = white[:, best] / np.linalg.norm(white[:, best])
        residual = residual - direction * (direction @ residual)
        white = white - np.outer(direction, direction @ white)
        left = np.linalg.norm(white, axis=0)
        testable &= left > LEAST_LEFT * np.where(np.isfinite(size), size, 0.0)
        testable &= taken @ columns < MOST_TAKEN * columns.sum(axis=0)
        size = np.where(testable, left, np.inf)
    # Where the residual is error of the model, none of it is noise to be taken off.
    noise_deg = 0.0 if search.noise.structured else search.noise.spread_deg
    beyond = float(raw @ raw) - len(raw) * noise_deg**2
    whole = max(beyond, sum(squares), 1e-300)
    return [
        replace(region, share_of_excess=part / whole)
        for region, part in zip(found, squares, strict=True)
    ]


def _largest_by_chance(gram: Floats, size: Floats, draws: int, rng: np.random.Generator) -> Floats:
    """Largest standardised cell mean in each of many residuals of noise alone.

    Parameters
    ----------
    gram : ndarray, shape (cells, cells)
        Covariance of the cells' sums.
    size : ndarray, shape (cells,)
        Standard deviation of each.
    draws : int
        How many residuals.
    rng : Generator
        Source of the draws.

    Returns
    -------
    ndarray, shape (draws,)
    """
    values, vectors = np.linalg.eigh(gram)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    means = np.abs(root @ rng.standard_normal((len(values), draws))) / size[:, None]
    return np.asarray(means.max(axis=0))


def _region(problem: Problem, cell: _Cell, mean: float, share: float, p: float) -> Region:
    """Region of a cell with its mean residual [deg], share of the misfit and p-value.

    Parameters
    ----------
    problem : Problem
        The recording prepared for fitting.
    cell : _Cell
        The cell.
    mean : float
        Mean residual in it [deg].
    share : float
        Its share of the misfit, 0 to 1.
    p : float
        Its p-value.

    Returns
    -------
    Region
    """
    history = problem.history
    temperature = None
    if history.temperature_c is not None and (cell.time or cell.run):
        part = history.temperature_c[cell.rows]
        temperature = (round(float(part.min()), 2), round(float(part.max()), 2))
    return Region(
        torque_nm=cell.torque,
        direction=cell.direction,
        run=cell.run,
        time_s=cell.time,
        readings=cell.readings,
        crank_deg=cell.crank,
        temperature_c=temperature,
        mean_residual_deg=mean,
        share_of_excess=float(np.clip(share, 0.0, 1.0)),
        p_value=p,
    )


def _cells(problem: Problem) -> list[_Cell]:
    """Fitted rows of every cell that has enough of them."""
    use = problem.fitted
    least = max(3, int(use.sum()) // 400)
    every = chain(
        _torque_cells(problem),
        _run_cells(problem),
        _position_cells(problem),
        _time_cells(problem),
    )
    cells = [replace(cell, rows=cell.rows & use) for cell in every]
    return [cell for cell in cells if np.count_nonzero(cell.rows) >= least]


def _torque_cells(problem: Problem) -> Iterator[_Cell]:
    """Bands of torque, in both directions and in each."""
    history = problem.history
    torque = history.applied_nm
    loading = history.sense * history.side > 0
    bands = np.linspace(-1, 1, 2 * BANDS + 1) * history.largest_torque_nm
    for width in (1, 2, 4):
        for low, high in zip(bands, bands[width:], strict=False):
            inside = (torque >= low) & (torque <= high)
            limits = (round(float(low), 3), round(float(high), 3))
            yield _Cell(rows=inside, torque=limits)
            yield _Cell(rows=inside & loading, torque=limits, direction="loading")
            yield _Cell(rows=inside & ~loading, torque=limits, direction="unloading")
    yield _Cell(rows=loading, direction="loading")


def _run_cells(problem: Problem) -> Iterator[_Cell]:
    """Each run, and all from each run on."""
    history, labels = problem.history, recorded_runs(problem)
    for k in range(history.run_count if history.run_count <= MOST_RUNS else 0):
        yield _Cell(rows=history.run == k, run=(labels[k], labels[k]))
        yield _Cell(rows=history.run >= k, run=(labels[k], labels[-1]))


def _position_cells(problem: Problem) -> Iterator[_Cell]:
    """Each mesh position, or parts of a turn where these are many."""
    crank = problem.history.crank_deg
    if crank is None:
        return
    position = mesh_positions(crank)
    places = np.unique(position)
    if len(places) > MOST_POSITIONS:
        width = 360.0 / SECTORS
        sector = (crank % 360.0) // width
        for k in range(SECTORS):
            yield _Cell(rows=sector == k, crank=(k * width, (k + 1) * width))
        return
    for place in places:
        yield _Cell(rows=position == place, crank=(float(place), float(place)))


def _time_cells(problem: Problem) -> Iterator[_Cell]:
    """Stretches of the recording with equal numbers of fitted rows."""
    labels = recorded_runs(problem)
    index = np.flatnonzero(problem.fitted)
    for parts in STRETCHES:
        edges = index[np.linspace(0, len(index) - 1, parts + 1).astype(int)]
        for first, last in pairwise(edges):
            rows = np.zeros(len(problem.fitted), dtype=bool)
            rows[first : last + 1] = True
            yield _stretch(problem, rows, labels)


def _stretch(problem: Problem, rows: Flags, labels: Sequence[int]) -> _Cell:
    """Cell of a stretch of the recording.

    Parameters
    ----------
    problem : Problem
        The recording prepared for fitting.
    rows : ndarray of bool, shape (n,)
        The stretch.
    labels : sequence of int
        Label of each run.

    Returns
    -------
    _Cell
    """
    history = problem.history
    first, last = np.flatnonzero(rows)[[0, -1]]
    clock = clock_of(history)
    span = (round(float(clock[first]), 3), round(float(clock[last]), 3))
    return _Cell(
        rows=rows,
        time=span if history.time_s is not None else None,
        readings=None if history.time_s is not None else _readings(problem, first, last),
        run=(labels[history.run[first]], labels[history.run[last]]),
    )


def _readings(problem: Problem, first: int, last: int) -> tuple[int, int]:
    """First and last reading of a stretch of rows, counted from 1.

    Parameters
    ----------
    problem : Problem
        The recording prepared for fitting.
    first, last : int
        First and last row.

    Returns
    -------
    (int, int)
    """
    samples = np.flatnonzero((problem.rows.row >= first) & (problem.rows.row <= last))
    return int(samples[0]) + 1, int(samples[-1]) + 1
