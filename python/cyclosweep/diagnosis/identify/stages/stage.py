"""One stage of a search, judged against the noise and the error of its own models together.

No law of an effect is exact. Where effects are far above the noise, evidence that is counted
against the noise alone prefers any shape with more freedom to the right law that is slightly off,
and then nothing is named. The model error is a share of what the stage has to explain. It vanishes
where that is hardly above the noise, so that what is faint is judged against the noise alone.
"""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise, orthonormal
from cyclosweep.simulation.effects.history import Floats

MODEL_ERROR_SHARE = 0.3
"""Model error over what a stage has to explain, as root mean squares."""
FAINT = 30.0
"""Signal-to-noise ratio up to which a mismatch is judged against the noise alone."""


def visibility(fitted: FittedStructure, noise: Noise, flexible: Floats) -> float:
    """Signal-to-noise ratio of what a structure leaves and a flexible model takes up.

    Parameters
    ----------
    fitted : FittedStructure
        The structure, by whatever noise it was fitted.
    noise : Noise
        Noise of the recording, without model error.
    flexible : ndarray, shape (fitted, k)
        Columns of the flexible model. What it cannot take up, outliers among it, does not count.

    Returns
    -------
    float
    """
    noise = noise.plain
    use = fitted.problem.fitted
    left, weight = noise.residual(fitted.problem.angle_deg[use], fitted.mean_deg[use])
    basis = orthonormal(noise.design(flexible, weight))
    taken_up = float(np.sum((basis.T @ left) ** 2)) - basis.shape[1]
    return float(np.sqrt(max(taken_up, 0.0)))


def error_factor(left: float) -> float:
    """Size of noise and model error together over that of the noise.

    A model error that is wrong in as many places as a residual has independent pieces counts as
    noise of a variance larger by rows over pieces.

    Parameters
    ----------
    left : float
        Signal-to-noise ratio of what a stage has to explain.
    """
    beyond = max(left**2 - FAINT**2, 0.0)
    return float(np.sqrt(1.0 + MODEL_ERROR_SHARE**2 * beyond / INDEPENDENT_PIECES))


def stage_of(searched: Search, flexible: Floats, accepted: FittedStructure) -> Search:
    """Search of one stage, with nothing visited.

    Parameters
    ----------
    searched : Search
        The search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    accepted : FittedStructure
        What was accepted before.

    Returns
    -------
    Search
    """
    factor = error_factor(visibility(accepted, searched.noise, flexible))
    noise = searched.noise.with_model_error(factor)
    return Search(searched.problem, noise, searched.library, searched.seed, accepted)
