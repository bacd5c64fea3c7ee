"""A basis flexible enough that hardly anything but noise is left, for estimating that noise."""

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem, line_design
from cyclosweep.simulation.effects.history import Floats

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
    wanted = [s for s in library.signatures if s.named or s.hypothesis in SMOOTH]
    if not wanted:
        return inner
    index = np.concatenate([np.arange(s.first, s.stop) for s in wanted])
    rest = library.columns[:, index] / np.sqrt(len(inner))
    rest = rest - inner @ (inner.T @ rest)
    # Directions by the small matrix of inner products: what is kept lies far above its rounding.
    size, mix = np.linalg.eigh(rest.T @ rest)
    strongest = np.argsort(-size)
    strongest = strongest[size[strongest] > (2e-3) ** 2 * max(size[-1], 1e-300)]
    most = max(len(inner) // 4 - inner.shape[1], 0)
    strongest = strongest[:most]
    kept = rest @ (mix[:, strongest] / np.sqrt(size[strongest]))
    return np.column_stack([inner, kept])
