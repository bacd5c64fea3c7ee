"""Refinement of a joint fit: least squares and elastic law in turn, until both have settled."""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit_parameters import usual_change
from cyclosweep.diagnosis.identify.fitting.joint_fit import JointFit
from cyclosweep.diagnosis.identify.fitting.secant_fit import minimise
from cyclosweep.simulation.effects.history import Floats

EXPANSIONS = 10
"""Most times the likelihood is expanded about the point that a refinement has led to. A refinement
holds the elastic law, and what else follows from the linear parameters, as it was there: it has to
be repeated until both have settled."""
LEAST_GAIN = 1.0
"""Fall of chi-squared below which a further expansion is not worth its time."""
LEAST_SHARE = 1e-4
"""The same as a share of chi-squared: it is large where a structure lacks an effect."""
STEPS_A_ROUND = 2
"""Steps with updated slopes that are tried for each iteration with measured ones."""
MOST_RISES = 2
"""Expansions that may each leave more than the one before, until a refinement is given up."""
FAR_ABOVE = 2.0
"""Misfit of an expansion, over the least so far, from which a refinement is given up at once."""
HOPELESS = 5.0
"""Misfit over that of a rival, from which a refinement is checked after every few rounds."""
ROUNDS_FAR_OFF = 6
"""Most rounds between these checks."""
LEAST_FALL = 0.5
"""Misfit that such rounds leave, over that before them, from which a refinement that is checked is
given up."""
SETTLED = 1e-2
"""Largest move of a parameter, in usual changes, that is the end of a refinement."""


def refine(
    work: JointFit,
    start: Floats,
    bounds: tuple[Floats, Floats],
    rounds: int,
    rival: float = np.inf,
) -> Floats:
    """Move the nonlinear parameters of a fit by least squares until they settle.

    Path and elastic law may drive each other ever further, as where two terms make up for each
    other; the fit then ends at the expansion of the least misfit that it passed.

    Parameters
    ----------
    work : JointFit
        The fit, which ends expanded about the result.
    start : ndarray, shape (p,)
        Parameters, in the fit's own scale.
    bounds : pair of ndarray, shape (p,)
        Lower and upper bounds.
    rounds : int
        Most iterations of a refinement.
    rival : float
        Misfit of another fit, which this one is to come near; see `HOPELESS`.

    Returns
    -------
    ndarray, shape (p,)
        Parameters of the best expansion.
    """
    of = work.fit_parameters
    scale = np.array([usual_change(each, value) for each, value in zip(of, start, strict=True)])
    here = best = work.expand_at(start)
    slopes: Floats | None = None
    fresh = False
    rises = 0
    for count in range(EXPANSIONS):
        before = here
        far_off = best.misfit > HOPELESS * rival
        steps = STEPS_A_ROUND * (min(rounds, ROUNDS_FAR_OFF) if far_off else rounds)
        values, slopes, fresh = minimise(
            work.residual, here.values, bounds, scale, steps, slopes, fresh=fresh
        )
        moved = float(np.max(np.abs(values - here.values) / scale))
        here = work.expand_at(values)
        best = min(best, here, key=lambda each: each.misfit)
        rises += here.misfit - before.misfit > _least_change(here.misfit)
        if rises >= MOST_RISES or here.misfit > FAR_ABOVE * best.misfit:
            break
        if best.misfit > max(HOPELESS * rival, LEAST_FALL * before.misfit):
            break
        gained_little = abs(before.chi2 - here.chi2) < _least_change(here.chi2)
        if moved < SETTLED or (count and gained_little):
            break
    if best is not here:
        work.return_to(best)
    return best.values


def _least_change(left: float) -> float:
    """Least change that counts of chi-squared, or of misfit, where so much is left."""
    return max(LEAST_GAIN, LEAST_SHARE * left)
