"""Identification: structures are fitted until none explains the recording better."""

from collections.abc import Callable

import numpy as np

from cyclosweep.diagnosis.calibrate import noise_beyond
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.staged_search import search_in_stages
from cyclosweep.diagnosis.identify.verdict import decide
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.whole_loop import stepwise

RESTARTS = 2
"""Times the search starts over because the noise turned out to be another."""
SAME_NOISE = 0.04
"""Change of correlation, and of the logarithm of the size, up to which noise is the same."""


def identify(search: Search, say: Callable[[str], None]) -> Search:
    """Fit structures with more and more effects.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        With all visited structures. Another one where the best of them showed the noise to be
        another: the search then starts over with that noise.
    """
    if search.noise.structured:
        say("looking for the largest effect")
        flexible = flexible_basis(search.problem, search.library, None)
        staged = search_in_stages(search, flexible, say)
        say("fitting whole loops")
        staged.chosen = stepwise.whole_loop_structure(staged)
        return staged
    for _ in range(RESTARTS):
        search.run(say)
        best = search.best()
        if best is None:
            break
        noise = noise_beyond(search.problem, search.library, best)
        if _is_same(noise, search.noise):
            break
        say("starting over with better-known noise")
        search = Search(search.problem, noise, search.library, search.seed)
    else:
        search.run(say)
    if decide(search, [], 0.0).unexplained:
        say("starting over with the largest effect")
        flexible = flexible_basis(search.problem, search.library, None)
        return search_in_stages(search, flexible, say)
    return search


def _is_same(first: Noise, second: Noise) -> bool:
    """Whether two estimates of the noise agree.

    Parameters
    ----------
    first : Noise
        One estimate.
    second : Noise
        The other.

    Returns
    -------
    bool
    """
    correlation = abs(first.correlation - second.correlation)
    size = abs(np.log(first.sigma_deg / second.sigma_deg))
    return bool(correlation < SAME_NOISE and size < SAME_NOISE)
