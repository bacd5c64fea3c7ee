"""Probability that as much evidence for an effect arises by chance."""

import numpy as np

from cyclosweep.diagnosis.identify.structures.alarm import DRAWS
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search


def chance_of_effect(search: Search, accepted: Candidate, index: int) -> float:
    """Probability of as much evidence for an effect by chance, all other accepted ones known.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure that was accepted.
    index : int
        Which of its terms.

    Returns
    -------
    float
    """
    name = accepted.fit.terms[index].name
    without = search.visited.get(accepted.names - {name})
    if without is None and len(accepted.names) == 1:
        without = search.baseline
    if without is None:
        return 1.0 / (DRAWS + 1)
    by_scan = search.alarm.p_value(without.excesses.get(name, 0.0))
    return min(by_scan, max(_by_fit(without, accepted, index), 1.0 / (DRAWS + 1)))


def _by_fit(without: Candidate, accepted: Candidate, index: int) -> float:
    """Bound of the same probability by what the effect adds to the fit.

    A scan of what is left sees little of an effect of many steps of a coarse dial, or far beyond
    the tails of the noise. Where the effect is absent, a Bayes factor of x has a probability of
    1/x at most (Markov's inequality), for each hypothesis that was tried in each of two ways.

    Parameters
    ----------
    without : Candidate
        The structure without the effect.
    accepted : Candidate
        The structure with it.
    index : int
        Which of its terms.

    Returns
    -------
    float
        Bayes factor by Schwarz's criterion; at most one.
    """
    fitted, noise = accepted.fit, accepted.fit.noise
    exact = np.zeros(fitted.problem.count)
    gained = 0.5 * (
        noise.misfit(without.fit.residual_deg, exact) - noise.misfit(fitted.residual_deg, exact)
    )
    parameters = len(fitted.amplitude_places(index)) + len(fitted.terms[index].shape)
    cost = 0.5 * parameters * np.log(len(exact)) + np.log(2 * len(without.scan.groups))
    return float(np.exp(min(cost - gained, 0.0)))
