"""Best subset of the library by an information criterion, all subsets up to three columns."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from cyclosweep_challenge.opponents.seen import Said, Seen, effects_of

LARGEST = 3


def best_subset(seen: Seen, price: float) -> Said:
    """Gain of the best subset in an information criterion.

    Parameters
    ----------
    seen : Seen
        The recording.
    price : float
        Cost of a column in deviance: 2 for Akaike's criterion, log N for Schwarz's.
    """
    table, names = seen.library
    count = seen.residual.size
    gram = table.T @ table
    moment = table.T @ seen.residual
    total = float(seen.residual @ seen.residual)
    best = -np.inf
    chosen: list[int] = []
    for size in range(1, LARGEST + 1):
        index = np.array(list(combinations(range(len(names)), size)))
        blocks = gram[index[:, :, None], index[:, None, :]] + 1e-9 * count * np.eye(size)
        sides = moment[index]
        weights = np.linalg.solve(blocks, sides[..., None])[..., 0]
        left = np.maximum(total - np.sum(weights * sides, axis=1), 1e-12)
        gain = count * np.log(total / left) - price * size
        k = int(np.argmax(gain))
        if gain[k] > best:
            best, chosen = float(gain[k]), [int(j) for j in index[k]]
    return Said(best, best > 0.0, effects_of(names, chosen))


def aic_subset(seen: Seen) -> Said:
    """Best subset by Akaike's criterion."""
    return best_subset(seen, 2.0)


def bic_subset(seen: Seen) -> Said:
    """Best subset by Schwarz's criterion."""
    return best_subset(seen, float(np.log(seen.residual.size)))
