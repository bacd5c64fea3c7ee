"""Calibration: the noise of the recording, and the published model fitted to it."""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.local_events import event_rows
from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.diagnosis.prepare.problem import Problem, gaps
from cyclosweep.simulation.effects.history import Floats


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
    step, white = problem.resolution_deg, problem.white_noise_deg
    if kept.all():
        return estimate_noise(
            angle, flexible, gap, step, weight, row_gap, white_deg=white, all_noise=all_noise
        )
    beyond = np.r_[False, ~kept[:-1]]
    noise = estimate_noise(
        angle[kept],
        orthonormal(flexible[kept]),
        np.where(beyond, 0.0, gap)[kept],
        step,
        weight[kept],
        np.where(beyond, 0.0, row_gap)[kept],
        white_deg=white,
        all_noise=all_noise,
    )
    return replace(noise, gap=row_gap if noise.by_rows else gap)
