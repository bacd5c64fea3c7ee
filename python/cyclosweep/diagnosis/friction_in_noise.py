"""Friction that a flexible model did not hold, and that was therefore taken for noise.

Friction whose presliding is long, or unlike that of the shapes which the flexible model is made of,
leaves a residual that is large and smooth: an autoregression near one describes it as noise, and
everything then lies within the noise. Abrupt friction leaves large errors after each reversal,
which pass for outliers. A friction of a few parameters that explains most of the mismatch is no
noise. It is looked for with noise as small as what rows differ by, and believed where the recording
is far likelier with it and the noise that is then left, or where it leaves hardly anything. The
likelihood does not see the latter: a drift of a recording of a few independent pieces costs next to
nothing as noise, however large it is. Beside noise that is nearly a drift both count a little: a
friction that takes away most of it is believed at a smaller gain of likelihood.
"""

import numpy as np

from cyclosweep.diagnosis.calibrate import flexible_beyond, noise_left
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.stages.friction_first import CONVERGED, friction_first
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.noise_estimate import as_model_error
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.history import Floats

SLOW = 0.3
"""Autocorrelation of the noise from which friction is looked for in it."""
HEAVY = 5.0
"""Degrees of freedom of the noise's tails up to which friction is looked for in it: a law of
friction that the flexible model misses leaves a few large errors after each reversal, which pass
for outliers."""
VERY_SLOW = 0.9
"""Autocorrelation from which noise is nearly a drift. What is left beside friction is then error of
the model, if its tails are heavy, too: slow noise is even, and outliers are not slow."""
FAR_ABOVE_STEPS = 4.0
"""Error of the calibrated model, over what rows differ by, from which friction is looked for in the
noise."""
FAR_LIKELIER = 100.0
"""Log likelihood that the recording must gain [nat]. Noise of an autocorrelation of 0.99 gains a
few nats from each parameter that is fitted to it."""
LIKELIER = 20.0
"""The same where friction takes away most of what looked like a drift: of 378 recordings of slow
noise and nothing missing, friction took away a third of the error in one, and gained nothing."""
LEFT_OF_DRIFT = 0.3
"""Share of the calibrated model's error that it then leaves at most."""
HARDLY_ANYTHING = 0.1
"""Share of the calibrated model's error that noise never leaves of itself when friction is fitted
to it."""


def without_hidden_friction(
    search: Search, flexible: Floats
) -> tuple[Search, Floats, FittedStructure | None]:
    """Search with the noise that friction leaves, where friction was taken for noise.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    flexible : ndarray, shape (fitted, k)
        Orthonormal columns of the flexible model that left the noise.

    Returns
    -------
    search : Search
        The one given where its noise holds no friction.
    flexible : ndarray, shape (fitted, k)
        Columns of the flexible model that left its noise.
    friction : FittedStructure or None
        The friction that was taken for noise.
    """
    noise, problem, library = search.noise, search.problem, search.library
    white = noise.best_correlation < SLOW and noise.tail > HEAVY
    if noise.structured or white or noise.step_deg > 0:
        return search, flexible, None
    little = model_error_noise(problem, noise, flexible)
    if search.baseline.fit.rmse_deg < FAR_ABOVE_STEPS * little.sigma_deg:
        return search, flexible, None
    found = friction_first(search, little)
    if found is None:
        return search, flexible, None
    known = fit(problem, little, found.terms, found, rounds=CONVERGED)
    beyond = flexible_beyond(problem, library, known)
    slow = noise_left(problem, beyond, all_noise=True)
    left_share = known.rmse_deg / search.baseline.fit.rmse_deg
    far = is_likelier(slow, noise)
    # Noise of a long memory costs next to nothing where it is drift; white noise is no drift.
    if not far and noise.best_correlation >= SLOW and left_share < HARDLY_ANYTHING:
        return Search(problem, little, library, search.seed), flexible, known
    drift = noise.best_correlation >= VERY_SLOW and left_share < LEFT_OF_DRIFT
    if not (far or (drift and is_likelier(slow, noise, LIKELIER))):
        return search, flexible, None
    left = noise_left(problem, beyond)
    if left.best_correlation >= VERY_SLOW and left.tail <= HEAVY:
        left = model_error_noise(problem, left, beyond)
    return Search(problem, left, library, search.seed), beyond, known


def model_error_noise(problem: Problem, noise: Noise, flexible: Floats) -> Noise:
    """Noise of a recording, if what a flexible model leaves of it is error of the model.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    noise : Noise
        What the flexible model leaves, described as noise.
    flexible : ndarray, shape (fitted, k)
        Its orthonormal columns.

    Returns
    -------
    Noise
    """
    angle = problem.angle_deg[problem.fitted]
    left = angle - flexible @ (flexible.T @ angle)
    return as_model_error(noise, left, problem.resolution_deg, float(np.ptp(angle)))


def is_likelier(noise: Noise, other: Noise, least: float = FAR_LIKELIER) -> bool:
    """Whether a recording is likelier with one description of its noise than with another.

    Parameters
    ----------
    noise : Noise
        What one model leaves.
    other : Noise
        What another one leaves.
    least : float
        Log likelihood that it must gain [nat].

    Returns
    -------
    bool
    """
    return log_likelihood(noise) >= log_likelihood(other) + least


def log_likelihood(noise: Noise) -> float:
    """Log likelihood [nat] of rows of this noise, but for a constant."""
    rows = len(noise.gap)
    density = noise.tail_gain - float(np.log(noise.sigma_deg))
    return rows * density - 0.5 * noise.log_determinant
