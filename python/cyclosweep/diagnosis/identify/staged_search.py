"""Search in stages: large effects first, each stage judged against the error of its own models.

No law of an effect is exact. Where effects are far above the noise, evidence that is counted
against the noise alone prefers any shape with more freedom to the right law that is slightly off,
and then nothing is named. Here each stage counts it against noise and model error together. The
model error is a share of what the stage has to explain. It vanishes where that is hardly above the
noise, so that what is faint is judged against the noise alone.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.bent_friction import bent_instead_of_others
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.freer_laws import freer_instead_of_others, with_freer_laws
from cyclosweep.diagnosis.identify.friction_first import (
    CONVERGED,
    PARAMETER_CHARGE,
    friction_first,
    from_better_start,
)
from cyclosweep.diagnosis.identify.law_in_class import cancels
from cyclosweep.diagnosis.identify.model_error_terms import (
    TIMES_WHAT_IS_LEFT,
    without_model_error,
)
from cyclosweep.diagnosis.identify.other_laws import with_better_laws
from cyclosweep.diagnosis.identify.placement import best_placed
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.testability import size_of
from cyclosweep.diagnosis.identify.variants import in_better_variant, with_refined_drag
from cyclosweep.diagnosis.identify.verdict import (
    NEARLY_ALL,
    decide,
    likely,
    named_if_close,
    probabilities,
    with_further_rivals,
)
from cyclosweep.diagnosis.identify.worth import INDISPENSABLE, still_needed, worth
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise, orthonormal
from cyclosweep.simulation.effects.history import Floats

MODEL_ERROR_SHARE = 0.3
"""Model error over what a stage has to explain, as root mean squares."""
FAINT = 30.0
"""Signal-to-noise ratio up to which a mismatch is judged against the noise alone."""
MOST_STAGES = 8
"""Stages of a search: two for each of four effects, as what was accepted may be given up again."""
HARDLY_LESS_LIKELY = 10.0
"""Log odds by which a structure that is accepted whole may be behind the best one [nat]."""


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


def search_in_stages(
    searched: Search,
    flexible: Floats,
    say: Callable[[str], None],
    begun: FittedStructure | None = None,
    renewed: Callable[[Search, FittedStructure], Search] = lambda search, accepted: search,
) -> Search:
    """Explain the largest mismatch first, then what is left of it, stage by stage.

    Parameters
    ----------
    searched : Search
        A search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    say : callable
        Called with a few words before each long step.
    begun : FittedStructure, optional
        What was accepted before; without it friction is looked for first.
    renewed : callable
        From a search against the noise alone and what is accepted to the search by the noise that
        this leaves; the same search where that is no other noise.

    Returns
    -------
    Search
        The search of the last stage, which starts from everything that the stages before it
        accepted; the one given where they accepted nothing.
    """

    def factor_of(left_by: FittedStructure) -> float:
        return error_factor(visibility(left_by, searched.noise, flexible))

    def refitted(terms: tuple[Term, ...], near: FittedStructure) -> FittedStructure:
        again = fit(searched.problem, searched.noise, terms, near, rounds=CONVERGED)
        return in_better_variant(again)

    rivals: list[tuple[Candidate, float]] = []
    last = first = searched
    fitted: FittedStructure = searched.baseline.fit
    mismatch = fitted.rmse_deg
    factor = factor_of(fitted)
    if begun is not None:
        fitted = refitted(begun.terms, begun)
    elif factor > 1.0:
        first_friction = friction_first(searched, searched.noise.with_model_error(factor))
        fitted = fitted if first_friction is None else in_better_variant(first_friction)
    accepted = fitted.terms
    restarted = shed = False
    kept_their_start = {frozenset(term.name for term in accepted)}
    for _ in range(MOST_STAGES):
        if not accepted and factor_of(fitted) == 1.0:
            break
        better_known = renewed(searched, fitted) if accepted else searched
        if better_known is not searched:
            searched = better_known
            rivals.clear()
            fitted = refitted(accepted, fitted)
            accepted = fitted.terms
        search = _stage(searched, flexible, fitted)
        search.run(say)
        decision = named_if_close(search, decide(search, [], 0.0), NEARLY_ALL)
        if accepted:
            last = search
        best = decision.best
        if best is None or best.score < search.start.score:
            # What leaves nothing more may still be less likely than what was accepted.
            break
        if accepted and not restarted and best.names not in kept_their_start:
            turned = from_better_start(searched.noise, best.fit, PARAMETER_CHARGE)
            turned = with_refined_drag(turned, {term.name for term in accepted})
            kept_their_start.add(best.names)
            if turned is not best.fit:
                # What was found beside friction in the wrong state, or drag of another shape, may
                # be the error of that.
                restarted = True
                before = {term.name for term in accepted}
                kept = tuple(term for term in turned.terms if term.name in before)
                fitted = refitted(kept, turned)
                accepted = fitted.terms
                continue
        needed = accepted if shed else still_needed(search, best, accepted)
        if len(needed) < len(accepted):
            # What was taken first may have stood in for what was found since.
            if not needed:
                searched = first
            shed, last, fitted = True, searched, searched.baseline.fit
            rivals.clear()
            if needed:
                fitted = refitted(needed, best.fit)
            accepted = fitted.terms
            continue
        found = without_model_error(best.fit, search.start.fit, mismatch)
        if decision.unexplained:
            doubtful = _doubtful(search, best)
            found = tuple(term for term in found if term.name not in doubtful)
        part = search.visited.get(frozenset(term.name for term in found), search.start)
        before = {term.name for term in accepted}
        if {term.name for term in found} == before and not decision.unexplained:
            # The likelier of two structures that leave nothing may hold too much. It is no rival
            # then: what makes it likelier may be model error.
            whole = _accepted_whole(search, best, mismatch)
            if whole:
                decision = replace(decision, explanations=likely(probabilities(whole)))
                best, found = whole[0], whole[0].fit.terms
        if {term.name for term in found} == before:
            other = _without_cancelling(search, best, mismatch)
            best, found = (best, found) if other is None else (other, other.fit.terms)
        freer_form = freer_instead_of_others(search, best, part)
        if freer_form is None:
            acceptable = search.visited.get(frozenset(term.name for term in found), search.start)
            freer_form = bent_instead_of_others(search, acceptable)
        if freer_form is not None:
            fitted = refitted(freer_form.fit.terms, freer_form.fit)
            accepted, last = fitted.terms, _stage(searched, flexible, fitted)
            rivals.clear()
            continue
        if {term.name for term in found} == before:
            break
        if not decision.unexplained:
            so_far = 1.0 - sum(share for _, share in rivals)
            others = [each for each in decision.explanations if each[0] is not best]
            rivals += [(candidate, so_far * share) for candidate, share in others]
        fitted = refitted(found, best.fit)
        accepted = fitted.terms
    if len(last.start.fit.terms) < len(accepted):
        last = _stage(searched, flexible, fitted)
    last.rivals_of_start = rivals
    return _with_settled_laws(searched, flexible, last, say)


def _with_settled_laws(
    searched: Search, flexible: Floats, last: Search, say: Callable[[str], None]
) -> Search:
    """Settle the laws of what the stages accepted, once all of it is known.

    Parameters
    ----------
    searched : Search
        The search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    last : Search
        The search of the last stage.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        That search, or one from a structure of other laws, or of freer ones.
    """
    rivals = last.rivals_of_start
    if last.start is not last.baseline:
        settled, others = with_better_laws(last)
        rivals = [each for each in rivals if each[0].names != frozenset(settled.names)]
        rivals, better = with_further_rivals(rivals, others), best_placed(settled)
        if better is not last.start.fit:
            last = _stage(searched, flexible, better)
        freer = with_freer_laws(last, last.start).fit
        if freer is not last.start.fit:
            last = _stage(searched, flexible, freer)
            if not last.suffices(last.start):
                # What a freer law leaves may be another thing than what the law left.
                last.run(say)
    last.rivals_of_start = [each for each in rivals if each[0].names != last.start.names]
    return last


def _stage(searched: Search, flexible: Floats, accepted: FittedStructure) -> Search:
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


def _accepted_whole(search: Search, best: Candidate, mismatch_deg: float) -> list[Candidate]:
    """Structures that leave nothing, and of which no term may be model error.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    list of Candidate
        Those that are hardly less likely than the best, most probable first.
    """
    least = max(best.score - HARDLY_LESS_LIKELY, search.start.score)

    def is_whole(other: Candidate) -> bool:
        recognised = other.all_recognised and search.suffices(other)
        return recognised and _adds_no_model_error(search, other, mismatch_deg)

    return [each for each in search.explanations() if each.score >= least and is_whole(each)]


def _adds_no_model_error(search: Search, other: Candidate, mismatch_deg: float) -> bool:
    """Whether a structure holds more than a stage started from, none of it perhaps model error.

    Parameters
    ----------
    search : Search
        Search of the stage.
    other : Candidate
        Structure that may be accepted whole.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    bool
        Whether it may.
    """
    if not search.start.names < other.names:
        return False
    kept = without_model_error(other.fit, search.start.fit, mismatch_deg)
    return len(kept) == len(other.fit.terms)


def _without_cancelling(search: Search, best: Candidate, mismatch_deg: float) -> Candidate | None:
    """Part of a structure that is accepted in its place where its new terms cancel each other.

    Two laws whose difference is any curve may fit best and leave nothing to accept, though one of
    them alone explains most of it.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    Candidate or None
        None where no new terms cancel, or no part is worth as much as is asked.
    """
    start = search.start
    new = [k for k, term in enumerate(best.fit.terms) if term.name not in start.names]
    if not best.all_recognised or not any(cancels(best.fit, k) for k in new):
        return None
    least = start.score + INDISPENSABLE

    def holds(other: Candidate) -> bool:
        part = other.score >= least and other.names < best.names
        return part and _adds_no_model_error(search, other, mismatch_deg)

    return max(
        (each for each in search.visited.values() if holds(each)),
        key=lambda each: each.score,
        default=None,
    )


def _doubtful(search: Search, best: Candidate) -> frozenset[str]:
    """Terms that are not to be accepted of a structure that leaves something, or holds the unnamed.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.

    Returns
    -------
    frozenset of str
        Names of the terms without a name, and of those that do not stand out from what is left.
    """
    fitted = best.fit
    left = beyond_noise_deg(fitted)
    found = set[str]()
    for k, (term, recognised) in enumerate(zip(fitted.terms, best.recognised, strict=True)):
        if term.name in search.start.names:
            continue
        clear = float(np.std(size_of(fitted, k))) >= TIMES_WHAT_IS_LEFT * left
        if not (recognised and clear) or worth(search, term.name, best) < INDISPENSABLE:
            found.add(term.name)
    return frozenset(found)
