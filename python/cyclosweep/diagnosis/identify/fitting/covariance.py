"""Covariance of the parameters of a least-squares fit, where something is known of them besides."""

import numpy as np

from cyclosweep.simulation.effects.history import Floats

ROUNDING = 1e-10
"""Singular value over the largest one that rounding may make of none."""


def covariance_of(design: Floats, information: Floats, least: float) -> Floats:
    """Covariance of parameters from rows of unit variance and what is known of each besides.

    Parameters
    ----------
    design : ndarray, shape (n, k)
        Derivative of each row by each parameter, over the standard deviation of the row.
    information : ndarray, shape (k,)
        One over the variance of each parameter as far as it is known besides; zero where nothing
        is.
    least : float
        Singular value over the largest one, columns of unit length, below which the rows alone are
        said to tell nothing of a direction; its variance then counts as zero.

    Returns
    -------
    ndarray, shape (k, k)
    """
    rows = np.vstack([design, np.diag(np.sqrt(information))])
    scale = np.linalg.norm(rows, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    # Of the rows, not of their squares: in these what is known besides may be less than rounding.
    _, values, directions = np.linalg.svd(rows / scale, full_matrices=False)
    told = values > (ROUNDING if np.any(information) else least) * values[0]
    inverse = directions[told] / values[told, None] / scale
    return np.asarray(inverse.T @ inverse)
