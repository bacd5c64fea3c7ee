"""A basis flexible enough that hardly anything but noise is left, for estimating that noise."""

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library, Signature
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem, line_design
from cyclosweep.simulation.effects.datum_drift import FEWEST_RUNS, MOST_RUNS
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.effects.order_names import from_recorded_position, travels

SMOOTH = (
    "torque and direction",
    "smooth odd curve",
    "even curve",
    "hysteresis",
    "compliance by run",
    "compliance by position",
    "position offsets",
)
"""Families of unnamed shapes that join the named effects in the basis."""
CLEAR_WAVE = 0.2
"""Share of what the basis leaves from which a wave along the travel of the mesh joins it, where its
amplitudes are those of the other branches: correlated noise makes waves, but never the same twice.
All waves together would take the noise itself away, over a whole band of frequencies."""
OWN_PART = 0.3
"""Root mean square of a wave that the basis has to leave. What is left of a wave that the basis
nearly contains is the noise of the angle by which its position is known."""
MOST_WAVES = 3
"""Most waves that join the basis."""


def flexible_basis(problem: Problem, library: Library, extra: Floats | None = None) -> Floats:
    """Orthonormal columns: the baseline exactly, then what else there is to see, strongest first.

    Parameters
    ----------
    problem : Problem
        The recording, n rows of which are fitted.
    library : Library
        Signatures of all hypotheses on those rows.
    extra : ndarray, shape (n, q), optional
        Further columns that must be in it, as the tangent space of an accepted model.

    Returns
    -------
    ndarray, shape (n, k)
    """
    use = problem.fitted
    history = problem.history
    line = line_design(history, history.applied_nm, one_sided=problem.one_sided)[use]
    certain = line if extra is None else np.column_stack([line, extra])
    inner = orthonormal(certain, 1e-10)
    wanted = [
        s
        for s in library.signatures
        if (s.named and not travels(s.shape)) or s.hypothesis in SMOOTH
    ]
    if not wanted:
        return inner
    index = np.concatenate([np.arange(s.first, s.stop) for s in wanted])
    rest = library.columns[:, index] / np.sqrt(len(inner))
    offsets = _run_offsets(problem, library)
    if offsets.shape[1]:
        rest = np.column_stack([rest, offsets / np.sqrt(len(inner))])
    rest = rest - inner @ (inner.T @ rest)
    # Directions by the small matrix of inner products: what is kept lies far above its rounding.
    size, mix = np.linalg.eigh(rest.T @ rest)
    strongest = np.argsort(-size)
    strongest = strongest[size[strongest] > (2e-3) ** 2 * max(size[-1], 1e-300)]
    most = max(len(inner) // 4 - inner.shape[1], 0)
    strongest = strongest[:most]
    kept = rest @ (mix[:, strongest] / np.sqrt(size[strongest]))
    return _with_clear_waves(problem, library, np.column_stack([inner, kept]))


def _run_offsets(problem: Problem, library: Library) -> Floats:
    """An offset of each run, where no effect of the library gives one.

    Runs that begin elsewhere are no noise, whatever moves them; as noise they would be slow and as
    large as they are.

    Parameters
    ----------
    problem : Problem
        The recording, n rows of which are fitted.
    library : Library
        Signatures of all hypotheses.

    Returns
    -------
    ndarray, shape (n, runs or 0)
    """
    run, count = problem.history.run[problem.fitted], problem.history.run_count
    known = any("each_run" in s.shape for s in library.signatures)
    runs = np.arange(count if not known and FEWEST_RUNS <= count <= MOST_RUNS else 0)
    return np.asarray(run[:, None] == runs, np.float64)


def _with_clear_waves(problem: Problem, library: Library, basis: Floats) -> Floats:
    """Basis with the waves along the travel of the mesh that explain much of what it leaves.

    Parameters
    ----------
    problem : Problem
        The recording, n rows of which are fitted.
    library : Library
        Signatures of all hypotheses on those rows.
    basis : ndarray, shape (n, k)
        Orthonormal columns.

    Returns
    -------
    ndarray, shape (n, k + q)
    """
    waves = [s for s in library.signatures if s.named and travels(s.shape)]
    use = problem.fitted
    branch = 2 * problem.history.run[use] + (problem.history.sense[use] > 0)
    left = problem.angle_deg[use]
    left = left - basis @ (basis.T @ left)
    for _ in range(MOST_WAVES if waves else 0):
        found = [library.columns[:, s.first : s.stop] for s in waves]
        share = [_repeated_share(wave - basis @ (basis.T @ wave), left, branch) for wave in found]
        place = int(np.argmax(share))
        if share[place] < CLEAR_WAVE:
            break
        wave = np.column_stack([found[k] for k in _with_neighbours(waves, place)])
        new = orthonormal(wave - basis @ (basis.T @ wave), 1e-3)
        basis = np.column_stack([basis, new])
        left = left - new @ (new.T @ left)
    return basis


def _with_neighbours(waves: list[Signature], place: int) -> list[int]:
    """A wave and those next to it, between which its order may lie unless it is a whole number.

    Parameters
    ----------
    waves : list of Signature
        All waves along a travel.
    place : int
        Index of the wave.

    Returns
    -------
    list of int
    """
    wave = waves[place]
    if from_recorded_position(wave.shape):
        return [place]
    return [
        k
        for k in range(max(place - 1, 0), min(place + 2, len(waves)))
        if waves[k].hypothesis == wave.hypothesis and not from_recorded_position(waves[k].shape)
    ]


def _repeated_share(wave: Floats, left: Floats, branch: np.ndarray) -> float:
    """Share of a residual that a wave explains on each branch as it is fitted to the others.

    Parameters
    ----------
    wave : ndarray, shape (n, 2)
    left : ndarray, shape (n,)
        The residual.
    branch : ndarray of int, shape (n,)
        Label of the branch of each row.

    Returns
    -------
    float
        Negative where the branches contradict each other.
    """
    parts = [branch == label for label in np.unique(branch)]
    inner = np.array([wave[part].T @ wave[part] for part in parts])
    along = np.array([wave[part].T @ left[part] for part in parts])
    others = inner.sum(axis=0) - inner
    size = float(np.trace(inner.sum(axis=0)))
    if size < OWN_PART**2 * wave.size or len(parts) < 2:
        return 0.0
    others = others + 1e-6 * size * np.eye(wave.shape[1])
    fitted = np.linalg.solve(others, (along.sum(axis=0) - along)[:, :, None])[:, :, 0]
    change = np.einsum("pi,pij,pj->", fitted, inner, fitted) - 2.0 * np.sum(fitted * along)
    return float(-change / max(float(left @ left), 1e-300))
