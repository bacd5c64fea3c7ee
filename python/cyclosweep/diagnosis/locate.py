"""Where recording and simulation differ: a map over torque, direction, run, place and time."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.diagnosis.decide import Conclusion
from cyclosweep.diagnosis.hypotheses.unnamed_shapes import clock_of
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.prepare.split import recorded_runs
from cyclosweep.result.mismatch import Direction, Region
from cyclosweep.simulation.effects.history import Flags

MOST_REGIONS = 4
BANDS = 8


@dataclass(frozen=True, eq=False)
class _Cell:
    rows: Flags
    torque: tuple[float, float] | None = None
    direction: Direction | None = None
    run: tuple[int, int] | None = None
    time: tuple[float, float] | None = None
    crank: tuple[float, float] | None = None


def locate(concluded: Conclusion) -> tuple[Region, ...]:
    """Return where the calibrated model and the recording differ.

    Parameters
    ----------
    concluded : Conclusion
        With the baseline and the accepted structure.

    Returns
    -------
    tuple of Region
        The strongest first; none where nothing is missing. Where something remains without a name
        beside accepted effects, the regions are those in which these fail.
    """
    search, accepted = concluded.search, concluded.accepted
    found: list[Region] = []
    if search.baseline.largest_excess >= search.threshold:
        found = find_regions(search, search.baseline)
    if concluded.decision.verdict == "UNKNOWN_PHYSICS" and accepted.fit.terms:
        found = find_regions(search, accepted) or found
    return tuple(found)


def find_regions(search: Search, candidate: Candidate, draws: int = 500) -> list[Region]:
    """Regions with error control, strongest first, each after the ones before are taken out.

    The statistic is the largest standardised cell mean of the projected residual; its distribution
    is simulated under the model of the candidate.
    """
    problem, noise = search.problem, search.noise
    use = problem.fitted
    cells = _cells(search)
    if not cells:
        return []
    _, weight = noise.residual(problem.angle_deg[use], candidate.fit.mean_deg[use])
    columns = np.column_stack([cell.rows[use].astype(np.float64) for cell in cells])
    white = noise.design(columns, weight)
    residual = candidate.fit.residual
    tangent = candidate.fit.tangent
    white = white - tangent @ (tangent.T @ white)
    gram = white.T @ white
    score = white.T @ residual
    size = np.sqrt(np.diag(gram))
    testable = size > 1e-6 * max(float(size.max()), 1e-300)
    size = np.where(testable, size, np.inf)
    rng = np.random.default_rng([search.seed, 2])
    values, vectors = np.linalg.eigh(gram)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    null = np.abs(root @ rng.standard_normal((len(values), draws))) / size[:, None]
    maxima = np.sort(null.max(axis=0))
    excess = max(candidate.fit.chi2 - search.noise.freedom, 1e-9)
    raw = (problem.angle_deg - candidate.fit.mean_deg)[use]
    found: list[Region] = []
    for _ in range(MOST_REGIONS):
        z = np.abs(score) / size
        best = int(np.argmax(z))
        p = (1 + np.count_nonzero(maxima >= z[best])) / (1 + draws)
        if p > 0.05 or not testable[best]:
            break
        cell = cells[best]
        gain = float(z[best] ** 2)
        found.append(_region(search, cell, float(raw[cell.rows[use]].mean()), gain / excess, p))
        direction = white[:, best] / np.linalg.norm(white[:, best])
        residual = residual - direction * (direction @ residual)
        white = white - np.outer(direction, direction @ white)
        score = white.T @ residual
        left = np.linalg.norm(white, axis=0)
        testable &= left > 0.2 * np.where(np.isfinite(size), size, 0.0)
        size = np.where(testable, left, np.inf)
    return found


def _region(search: Search, cell: _Cell, mean: float, share: float, p: float) -> Region:
    history = search.problem.history
    rows = cell.rows & search.problem.fitted
    temperature = None
    if history.temperature_c is not None and (cell.time or cell.run):
        part = history.temperature_c[rows]
        temperature = (round(float(part.min()), 2), round(float(part.max()), 2))
    return Region(
        torque_nm=cell.torque,
        direction=cell.direction,
        run=cell.run,
        time_s=cell.time,
        crank_deg=cell.crank,
        temperature_c=temperature,
        mean_residual_deg=mean,
        share_of_excess=float(np.clip(share, 0.0, 1.0)),
        p_value=p,
    )


def _cells(search: Search) -> list[_Cell]:
    problem = search.problem
    history, use = problem.history, problem.fitted
    count = int(use.sum())
    torque = history.applied_nm
    top = history.largest_torque_nm
    loading = history.sense * history.side > 0
    cells: list[_Cell] = []

    def add(rows: Flags, **where: object) -> None:
        if np.count_nonzero(rows & use) >= max(3, count // 400):
            cells.append(_Cell(rows & use, **where))  # type: ignore[arg-type]

    bands = np.linspace(-1, 1, 2 * BANDS + 1) * top
    for low, high in [(a, b) for w in (1, 2, 4) for a, b in zip(bands, bands[w:], strict=False)]:
        inside = (torque >= low) & (torque <= high)
        torque_range = (round(float(low), 3), round(float(high), 3))
        add(inside, torque=torque_range)
        add(inside & loading, torque=torque_range, direction="loading")
        add(inside & ~loading, torque=torque_range, direction="unloading")
    add(loading, direction="loading")
    labels = recorded_runs(problem)
    for k in range(history.run_count if history.run_count <= 60 else 0):
        add(history.run == k, run=(labels[k], labels[k]))
        add(history.run >= k, run=(labels[k], labels[-1]))
    if history.crank_deg is not None:
        for place in np.unique(np.round(history.crank_deg, 1))[:40]:
            near = np.abs(history.crank_deg - place) < 0.06
            add(near, crank=(float(place), float(place)))
    clock = clock_of(history)
    index = np.flatnonzero(use)
    for parts in (10, 30):
        edges = index[np.linspace(0, len(index) - 1, parts + 1).astype(int)]
        for a, b in pairwise(edges):
            rows = np.zeros(len(use), dtype=bool)
            rows[a : b + 1] = True
            span = (round(float(clock[a]), 3), round(float(clock[b]), 3))
            spanned = (labels[history.run[a]], labels[history.run[b]])
            add(rows, time=span if history.time_s is not None else None, run=spanned)
    return cells
