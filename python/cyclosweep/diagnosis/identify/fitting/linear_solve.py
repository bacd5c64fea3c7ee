"""Linear parameters of a joint fit by the normal equations."""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from cyclosweep.simulation.effects.history import Floats


def solve(design: Floats, target: Floats, hold: Floats) -> Floats:
    """Least squares by normal equations on scaled columns, with a little ridge for lost ranks.

    Parameters
    ----------
    design : ndarray, shape (n, k)
    target : ndarray, shape (n,)
    hold : ndarray, shape (k,)
        Precision with which each parameter is known beforehand to be near zero.

    Returns
    -------
    ndarray, shape (k,)
    """
    norm = np.sqrt(np.einsum("ij,ij->j", design, design))
    norm = np.where(norm > 0, norm, 1.0)
    scaled = design / norm
    gram = scaled.T @ scaled + np.diag(hold / norm**2)
    right = scaled.T @ target
    for ridge in (0.0, 1e-9, 1e-6):
        # LAPACK itself: the checks around it take longer than so small a matrix.
        factor, failed = dpotrf(gram + ridge * np.eye(len(gram)), clean=False)
        if not failed and (ridge > 0 or np.min(np.abs(np.diag(factor))) > 1e-5):
            return np.asarray(dpotrs(factor, right)[0] / norm)
    return np.asarray(np.linalg.lstsq(scaled, target, rcond=1e-10)[0] / norm)
