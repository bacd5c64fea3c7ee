"""Calibration: the noise of the recording, and the published model fitted to it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.staged_search import visibility
from cyclosweep.diagnosis.prepare.local_events import event_rows
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.diagnosis.prepare.problem import Problem, gaps
from cyclosweep.diagnosis.prepare.thinning import MOST_ROWS
from cyclosweep.simulation.effects.history import Floats

ENOUGH = 400.0
"""Signal-to-noise ratio of a mismatch beyond which further rows tell hardly more: what the laws of
its causes miss is larger than the noise, and alike in neighbouring rows."""
FEWEST_ROWS = 1500
"""About so many rows are kept however large a mismatch is."""
LEAST_THINNED = 1.8
"""Rows over those that are enough from which a recording is thinned; taking every second one is the
least that thinning can do."""


def calibrate_on_enough_rows(calibrated: Callable[[int], Search]) -> Search:
    """Calibrate on about as many rows as tell a mismatch from noise: the larger it is, the fewer.

    Where the noise is not known beside the error of the model, all rows are kept.

    Parameters
    ----------
    calibrated : callable
        From about the largest number of rows to the calibrated search on them.

    Returns
    -------
    Search
    """
    search = calibrated(MOST_ROWS)
    if search.noise.structured:
        return search
    assert search.flexible is not None
    rows = len(search.problem.history)
    seen = max(visibility(search.baseline.fit, search.noise, search.flexible), ENOUGH)
    enough = max(rows * (ENOUGH / seen) ** 2, FEWEST_ROWS)
    return search if rows < LEAST_THINNED * enough else calibrated(int(enough))


def mismatch(search: Search, flexible: Floats) -> float:
    """Signal-to-noise ratio of what the calibrated model misses, in all samples of a recording.

    Samples that were passed over count like their neighbours.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model.

    Returns
    -------
    float
    """
    rows = search.problem.rows
    passed_over = len(rows.row) / float(rows.samples.sum())
    return float(visibility(search.baseline.fit, search.noise, flexible) * np.sqrt(passed_over))


def calibrate(problem: Problem, library: Library, seed: int) -> Search:
    """Estimate the noise, fit stiffness, free play and datum, and calibrate the global test.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    library : Library
        Hypotheses on that recording.
    seed : int
        Seed of every random draw.

    Returns
    -------
    Search
        Its ``baseline`` is the calibrated published model; no effect has been fitted yet.
    """
    flexible = flexible_basis(problem, library, None)
    search = Search(problem, noise_left(problem, flexible), library, seed)
    search.flexible = flexible
    return search


def noise_beyond(problem: Problem, library: Library, known: FittedStructure | None) -> Noise:
    """Estimate the noise that a flexible model leaves of a recording.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    library : Library
        Hypotheses, whose shapes the flexible model contains.
    known : FittedStructure or None
        A structure whose terms the flexible model contains as well.

    Returns
    -------
    Noise
    """
    return noise_left(problem, flexible_beyond(problem, library, known))


def flexible_beyond(problem: Problem, library: Library, known: FittedStructure | None) -> Floats:
    """Columns of a flexible model that contains a structure.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    library : Library
        Hypotheses, whose shapes the flexible model contains.
    known : FittedStructure or None
        A structure whose terms the flexible model contains as well.

    Returns
    -------
    ndarray, shape (fitted, k)
        Orthonormal.
    """
    columns = None
    if known is not None:
        use, history = problem.fitted, known.history
        terms = [term.columns(history)[use] for term in known.terms]
        columns = np.column_stack([history.elastic_nm[use], *terms])
    return flexible_basis(problem, library, columns)


def noise_left(problem: Problem, flexible: Floats, *, all_noise: bool = False) -> Noise:
    """Estimate the noise that the columns of a flexible model leave of a recording.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    flexible : ndarray, shape (fitted, k)
        Orthonormal columns.
    all_noise : bool
        Take what is left for noise even where it looks like error of the model.

    Returns
    -------
    Noise
    """
    use = problem.fitted
    angle, run = problem.angle_deg[use], problem.history.run[use]
    gap, weight = problem.gap[use], problem.weight[use]
    row_gap = gaps(use, problem.history.run, None)[use]
    kept = ~event_rows(angle, flexible, run)
    if kept.all():
        return estimate_noise(
            angle, flexible, gap, problem.resolution_deg, weight, row_gap, all_noise=all_noise
        )
    beyond = np.r_[False, ~kept[:-1]]
    noise = estimate_noise(
        angle[kept],
        orthonormal(flexible[kept]),
        np.where(beyond, 0.0, gap)[kept],
        problem.resolution_deg,
        weight[kept],
        np.where(beyond, 0.0, row_gap)[kept],
        all_noise=all_noise,
    )
    return replace(noise, gap=row_gap if noise.by_rows else gap)
