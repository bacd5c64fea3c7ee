"""Identification: structures are fitted until none explains the recording better."""

from collections.abc import Callable

import numpy as np

from cyclosweep.diagnosis.calibrate import noise_beyond
from cyclosweep.diagnosis.friction_in_noise import (
    is_far_likelier,
    model_error_noise,
    without_hidden_friction,
)
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.staged_search import (
    search_in_stages,
    visibility,
    with_settled_laws,
)
from cyclosweep.diagnosis.identify.verdict import decide
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.whole_loop import stepwise
from cyclosweep.simulation.effects.history import Floats

RESTARTS = 2
"""Times the search starts over because the noise turned out to be another."""
LOUD = 1000.0
"""Signal-to-noise ratio from which a mismatch is judged against the error of models from the start:
no law of an effect is exact to a thousandth."""
CLEAR = 100.0
"""Signal-to-noise ratio from which a mismatch that named effects do not explain is searched in
stages at once: against the noise alone the error of a large effect's law hides what is smaller."""
FEW_PIECES = 5.0
"""Independent pieces below which what remains unexplained is no noise but error of the model."""
LARGER_THAN_LEFT = 2.0
"""Noise over what a structure leaves, from which it is none: an autoregression near one describes
the slow errors of a model as noise of any size."""
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
    flexible = search.flexible
    if flexible is None:
        flexible = flexible_basis(search.problem, search.library, None)
    search, flexible, friction = without_hidden_friction(search, flexible)
    calibrated = search.noise
    mismatch = visibility(search.baseline.fit, calibrated, flexible)
    if calibrated.structured or mismatch > LOUD:
        # Two frictions and their presliding have many optima: they are looked for once more.
        one = friction is not None and sum(term.slips for term in friction.terms) == 1
        return _by_size(search, flexible, say, friction if one else None)
    for _ in range(RESTARTS):
        search.run(say)
        best = search.best()
        if best is None:
            break
        noise = noise_beyond(search.problem, search.library, best.fit)
        if _is_same(noise, search.noise) or is_far_likelier(search.noise, noise):
            break
        given_up = mismatch > CLEAR and decide(search, [], 0.0).unexplained
        say("starting over with better-known noise")
        search = Search(search.problem, noise, search.library, search.seed)
        if given_up:
            return with_settled_laws(search, flexible, search_in_stages(search, flexible, say))
    else:
        search.run(say)
    if not decide(search, [], 0.0).unexplained:
        return search
    if _few_pieces(search.noise):
        error = model_error_noise(search.problem, calibrated, flexible)
        again = Search(search.problem, error, search.library, search.seed)
        return _by_size(again, flexible, say)
    return with_settled_laws(search, flexible, search_in_stages(search, flexible, say))


def _few_pieces(noise: Noise) -> bool:
    """Whether noise is so slow that a recording cannot tell it from error of the model."""
    rows, correlation = len(noise.gap), noise.best_correlation
    return rows * (1.0 - correlation) / (1.0 + correlation) < FEW_PIECES


def _by_size(
    search: Search,
    flexible: Floats,
    say: Callable[[str], None],
    begun: FittedStructure | None = None,
) -> Search:
    """Explain a loud mismatch stage by stage, and fit the result to whole loops.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model.
    say : callable
        Called with a few words before each long step.
    begun : FittedStructure, optional
        What is known already.

    Returns
    -------
    Search
        Of the last stage.
    """
    staged = search_in_stages(search, flexible, say, begun)
    if staged.start is not staged.baseline:
        noise = noise_beyond(search.problem, search.library, staged.start.fit)
        believed = noise.spread_deg <= LARGER_THAN_LEFT * staged.start.fit.rmse_deg
        if believed and not noise.structured and not _is_same(noise, search.noise):
            say("starting over with better-known noise")
            search = Search(search.problem, noise, search.library, search.seed)
            staged = search_in_stages(search, flexible, say, staged.start.fit)
    staged = with_settled_laws(search, flexible, staged)
    say("fitting whole loops")
    staged.chosen = stepwise.whole_loop_structure(staged)
    return staged


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
