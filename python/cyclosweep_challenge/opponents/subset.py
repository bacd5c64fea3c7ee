"""Best subset of the library by an information criterion, all subsets up to three columns."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from cyclosweep_challenge.opponents.view import Regressed, Reply, effects_of

LARGEST = 3


def best_subset(view: Regressed, cost: float) -> Reply:
    """Gain of the best subset in an information criterion.

    Parameters
    ----------
    view : Regressed
        The recording.
    cost : float
        Cost of a column in deviance: 2 for Akaike's criterion, log N for Schwarz's.
    """
    table, names = view.library
    count = view.residual.size
    gram = table.T @ table
    moment = table.T @ view.residual
    total = float(view.residual @ view.residual)
    best = -np.inf
    chosen: list[int] = []
    for size in range(1, LARGEST + 1):
        index = np.array(list(combinations(range(len(names)), size)))
        blocks = gram[index[:, :, None], index[:, None, :]] + 1e-9 * count * np.eye(size)
        sides = moment[index]
        weights = np.linalg.solve(blocks, sides[..., None])[..., 0]
        left = np.maximum(total - np.sum(weights * sides, axis=1), 1e-12)
        gain = count * np.log(total / left) - cost * size
        k = int(np.argmax(gain))
        if gain[k] > best:
            best, chosen = float(gain[k]), [int(j) for j in index[k]]
    return Reply(best, best > 0.0, effects_of(names, chosen))


def aic_subset(view: Regressed) -> Reply:
    """Best subset by Akaike's criterion."""
    return best_subset(view, 2.0)


def bic_subset(view: Regressed) -> Reply:
    """Best subset by Schwarz's criterion."""
    return best_subset(view, float(np.log(view.residual.size)))
