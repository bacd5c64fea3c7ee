"""Share of the mismatch between calibrated model and recording that named effects explain."""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.result import Explained
from cyclosweep.simulation.effects.history import Floats

DRAWS = 500
"""Bootstrap draws of the interval."""


def explained_share(before: FittedStructure, after: FittedStructure, seed: int) -> Explained:
    """Share of the mean square beyond the noise that a structure takes away.

    Parameters
    ----------
    before, after : FittedStructure
        The calibrated published model, and the structure.
    seed : int
        Seed of the bootstrap over stretches of the recording.

    Returns
    -------
    Explained
        Without a share where there is no mismatch beyond the noise.
    """
    problem = before.problem
    use = problem.fitted
    weight = problem.weight[use]
    errors = [fit.residual_deg**2 * weight for fit in (before, after)]
    count = min(int(INDEPENDENT_PIECES), max(int(np.count_nonzero(use)) // 3, 1))
    stretch = np.arange(len(weight)) * count // max(len(weight), 1)
    totals = [np.bincount(stretch, error, count) for error in errors]
    noise = np.bincount(stretch, weight, count) * before.noise.spread_deg**2
    rng = np.random.default_rng([seed, 5])
    drawn = rng.integers(0, count, (DRAWS, count))

    def share(first: Floats, second: Floats) -> Floats:
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(np.clip(1.0 - np.maximum(second, 0.0) / first, 0.0, 1.0))

    first, second = (total - noise for total in totals)
    if first.sum() <= 0.0:
        return Explained()
    draws = share(first[drawn].sum(axis=1), second[drawn].sum(axis=1))
    low, high = np.nanquantile(draws, [0.025, 0.975])
    return Explained(
        share=float(share(first.sum(keepdims=True), second.sum(keepdims=True))[0]),
        ci95=(float(low), float(high)),
    )


def beyond_noise_deg(fitted: FittedStructure) -> float:
    """Root mean square of what a structure leaves beyond the noise.

    Parameters
    ----------
    fitted : FittedStructure

    Returns
    -------
    float
        In deg.
    """
    return float(np.sqrt(max(fitted.rmse_deg**2 - fitted.noise.spread_deg**2, 0.0)))
