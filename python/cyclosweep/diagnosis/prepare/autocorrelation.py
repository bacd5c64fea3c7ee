"""Autocorrelation of what a flexible model leaves, by restricted likelihood."""

import numpy as np

from cyclosweep.simulation.effects.history import Floats

CORRELATIONS = np.r_[0.0:0.975:0.01, 0.98:0.9981:0.003]
"""Autocorrelations that are tried."""


def autocorrelation(left: Floats, basis: Floats, gap: Floats) -> tuple[float, float]:
    """Restricted likelihood of the autocorrelation: its best value and an upper one.

    Parameters
    ----------
    left : ndarray, shape (n,)
        What the basis leaves of the twist, without outliers [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    gap : ndarray, shape (n,)
        Steps since the row before, zero where unrelated.

    Returns
    -------
    best, upper : float
    """
    near = np.flatnonzero((gap > 0) & (gap < 1.5))
    if len(near) < 20:
        return 0.0, 0.0
    rows = np.column_stack([basis, left])
    now, before = rows[near], rows[near - 1]
    alone = np.ones(len(left), dtype=bool)
    alone[near] = False
    current, crossed = now.T @ now, now.T @ before
    crossed = crossed + crossed.T
    earlier = before.T @ before
    start = rows[alone].T @ rows[alone]
    k = basis.shape[1]
    freedom = len(left) - k
    grid = CORRELATIONS
    value = np.empty(len(grid))
    for index, rho in enumerate(grid):
        gram = start + (current - rho * crossed + rho**2 * earlier) / (1 - rho**2)
        inner, edge = gram[:k, :k], gram[:k, k]
        sign, determinant = np.linalg.slogdet(inner)
        rest = gram[k, k] - edge @ np.linalg.solve(inner, edge)
        spread = len(near) * np.log(1 - rho**2)
        value[index] = -0.5 * (spread + determinant + freedom * np.log(max(rest, 1e-300)))
        if sign <= 0:
            value[index] = -np.inf
    best = int(np.argmax(value))
    # The higher it is, the dearer an underestimate.
    drop = 1.0 + 2.0 * grid[best] ** 2
    within = np.flatnonzero(value > value[best] - drop)
    if best == 0 and value[0] - value[1] > 1.0:
        return 0.0, 0.0
    return float(grid[best]), float(grid[within[-1]])
