"""Identification: structures are fitted until none explains the recording better."""

from collections.abc import Callable

import numpy as np

from cyclosweep.diagnosis.calibrate import noise_beyond
from cyclosweep.diagnosis.friction_in_noise import (
    is_likelier,
    model_error_noise,
    without_hidden_friction,
)
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.stages.far_behind import far_behind
from cyclosweep.diagnosis.identify.stages.friction_first import CONVERGED, friction_first
from cyclosweep.diagnosis.identify.stages.other_laws import visit_rivals
from cyclosweep.diagnosis.identify.stages.stage import error_factor, visibility
from cyclosweep.diagnosis.identify.stages.staged_search import search_in_stages
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import decide, no_more_than_fits
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.whole_loop import stepwise
from cyclosweep.diagnosis.whole_loop.play_crossings import take_recorded_crossings
from cyclosweep.simulation.effects.history import Floats

RESTARTS = 2
"""Times the search starts over because the noise turned out to be another."""
LOUD = 1000.0
"""Signal-to-noise ratio from which a mismatch is judged against the error of models from the start:
no law of an effect is exact to a thousandth."""
LOUD_FRICTION = 300.0
"""The same for a mismatch that is mostly friction, whose laws err more than others: what they miss
hides from the noise alone all that is smaller, and the search against it is in vain."""
MOST_OF_MISMATCH = 0.75
"""Share of the mean square mismatch that friction alone explains, from which it is mostly that."""
CLEAR = 100.0
"""Signal-to-noise ratio from which a mismatch that named effects do not explain is searched in
stages at once: against the noise alone the error of a large effect's law hides what is smaller."""
FEW_PIECES = 5.0
"""Independent pieces below which what remains unexplained is no noise but error of the model."""
FEWEST_PIECES = 1.0
"""Independent pieces below which slow noise is error of the model from the start, where the error
of the calibrated model is also `ABOVE_STEPS` times what neighbouring rows differ by."""
ABOVE_STEPS = 40.0
"""Error of the calibrated model over what neighbouring rows differ by. Noise alone has less: 12 at
an autocorrelation of 0.99, and 27 at 0.998, the largest that is estimated."""
LARGER_THAN_LEFT = 2.0
"""Noise over what a structure leaves, from which it is none: an autoregression near one describes
the slow errors of a model as noise of any size."""
SAME_NOISE = 0.04
"""Change of correlation, and of the logarithm of the size, up to which noise is the same."""
NEARLY_SAME_NOISE = 0.15
"""The same, up to which structures that are far apart by one noise are so by the other."""


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
    error = instead_of_slow_noise(search, flexible)
    if error is not None:
        search = Search(search.problem, error, search.library, search.seed)
    calibrated = search.noise
    mismatch = visibility(search.baseline.fit, calibrated, flexible)
    # Two frictions and their presliding have many optima: they are looked for once more.
    one = friction is not None and sum(term.slips for term in friction.terms) == 1
    begun = friction if one else None
    if calibrated.structured or mismatch > LOUD:
        return _by_size(search, flexible, say, begun)
    if mismatch > LOUD_FRICTION and calibrated.independent_pieces >= FEW_PIECES:
        large = _mostly_friction(search, mismatch, begun)
        if large is not None:
            search = _with_interval_noise(search, large)
            return _crossing_as_recorded(search_in_stages(search, flexible, say, large))
    given_up = False
    for _ in range(RESTARTS):
        search.run(say)
        best = search.best()
        if best is None:
            break
        noise = noise_beyond(search.problem, search.library, best.fit)
        if _is_same(noise, search.noise) or is_likelier(search.noise, noise):
            break
        given_up = mismatch > CLEAR and _leaves_something(search)
        say("starting over with better-known noise")
        known = far_behind(search) if _is_same(noise, search.noise, NEARLY_SAME_NOISE) else None
        search = Search(search.problem, noise, search.library, search.seed)
        search.not_extended = known or frozenset()
        if given_up:
            break
    else:
        search.run(say)
    if not given_up and not _leaves_something(search) and not is_within_slow_noise(search):
        visit_rivals(search)
        return _crossing_as_recorded(search)
    if search.noise.independent_pieces < FEW_PIECES:
        error = model_error_noise(search.problem, calibrated, flexible)
        again = Search(search.problem, error, search.library, search.seed)
        return _by_size(again, flexible, say)
    return _crossing_as_recorded(search_in_stages(search, flexible, say))


def _crossing_as_recorded(search: Search) -> Search:
    """Let the friction of what was found, and of its rivals, meet the play as recorded.

    Parameters
    ----------
    search : Search
        After it has run.

    Returns
    -------
    Search
        The same one.
    """
    found = [search.start]
    if search.start is search.baseline:
        found = [candidate for candidate, _ in decide(search).explanations]
    for candidate in found:
        take_recorded_crossings(search, candidate)
    return search


def _mostly_friction(
    search: Search, mismatch: float, known: FittedStructure | None
) -> FittedStructure | None:
    """Friction that explains most of a mismatch.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    mismatch : float
        Signal-to-noise ratio of what it has to explain.
    known : FittedStructure or None
        Friction that was found before.

    Returns
    -------
    FittedStructure or None
        None where there is none, or another effect is as large.
    """
    noise = search.noise.with_model_error(error_factor(mismatch))
    found = known or friction_first(search, noise)
    if found is None:
        return None
    # In a few runs a stiffening and a side load were fitted beside it.
    slipping = tuple(term for term in found.terms if term.slips)
    alone = found
    if len(slipping) < len(found.terms):
        alone = fit(search.problem, noise, slipping, found, rounds=CONVERGED)
    left = (alone.rmse_deg / search.baseline.fit.rmse_deg) ** 2
    return found if left <= 1.0 - MOST_OF_MISMATCH else None


def _with_interval_noise(search: Search, known: FittedStructure) -> Search:
    """Start over with the noise below a coarse dial's steps, where it shows only beside a friction.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    known : FittedStructure
        Friction that explains most of the mismatch.

    Returns
    -------
    Search
        The same one where the dial is fine, or its steps were in the noise already.
    """
    problem = search.problem
    if problem.resolution_deg <= 0.0 or search.noise.step_deg > 0.0:
        return search
    noise = noise_beyond(problem, search.library, known)
    if noise.step_deg == 0.0:
        return search
    return Search(problem, noise, search.library, search.seed)


def _leaves_something(search: Search) -> bool:
    """Whether the best structure of a search leaves more than noise, or holds what has no name.

    Noise of heavy tails may take the places where a fit in a bad optimum is far off for outliers.

    Parameters
    ----------
    search : Search
        After it has run.

    Returns
    -------
    bool
    """
    decision = decide(search)
    if decision.best is None:
        return decision.unexplained
    return no_more_than_fits(decision, decision.best, search, 0.0).unexplained


def is_within_slow_noise(search: Search) -> bool:
    """Whether nothing more is found only because the noise is said to be far larger.

    An autoregression near one describes what a structure leaves as a small part of a noise far
    larger, of which the recording holds not one independent piece.

    Parameters
    ----------
    search : Search
        After it has run.

    Returns
    -------
    bool
    """
    best, noise = decide(search).best, search.noise
    return bool(
        best is not None
        and best.fit.terms
        and noise.pieces_and_breaks < FEWEST_PIECES
        and noise.spread_deg > LARGER_THAN_LEFT * best.fit.rmse_deg
    )


def instead_of_slow_noise(search: Search, flexible: Floats) -> Noise | None:
    """Noise beside error of the model, where a large mismatch stands beside slow noise.

    In a single run, along which the noise hardly changes, nothing tells it from error of the model.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    flexible : ndarray, shape (n, k)
        Columns of a flexible model.

    Returns
    -------
    Noise or None
        None where the noise is known, or the mismatch is small.
    """
    noise = search.noise
    if noise.structured or noise.step_deg > 0 or noise.pieces_and_breaks >= FEWEST_PIECES:
        return None
    steps = model_error_noise(search.problem, noise, flexible)
    large = search.baseline.fit.rmse_deg > ABOVE_STEPS * steps.sigma_deg
    return steps if large else None


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

    def renewed(searched: Search, accepted: FittedStructure) -> Search:
        noise = noise_beyond(searched.problem, searched.library, accepted)
        believed = noise.spread_deg <= LARGER_THAN_LEFT * accepted.rmse_deg
        believed &= not searched.noise.structured or noise.independent_pieces >= FEWEST_PIECES
        if not believed or noise.structured or _is_same(noise, searched.noise):
            return searched
        return Search(searched.problem, noise, searched.library, searched.seed)

    staged = _crossing_as_recorded(search_in_stages(search, flexible, say, begun, renewed))
    say("fitting whole loops")
    staged.chosen = stepwise.whole_loop_structure(staged)
    return staged


def _is_same(first: Noise, second: Noise, room: float = SAME_NOISE) -> bool:
    """Whether two estimates of the noise agree.

    Parameters
    ----------
    first : Noise
        One estimate.
    second : Noise
        The other.
    room : float
        Change of the correlation, and of the logarithm of the size, up to which they do.

    Returns
    -------
    bool
    """
    correlation = abs(first.correlation - second.correlation)
    size = abs(np.log(first.sigma_deg / second.sigma_deg))
    return bool(correlation < room and size < room)
