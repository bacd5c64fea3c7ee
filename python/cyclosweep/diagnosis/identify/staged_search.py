"""Search in stages: large effects first, each stage judged against the error of its own models.

No law of an effect is exact. Where effects are far above the noise, evidence that is counted
against the noise alone prefers any shape with more freedom to the right law that is slightly off,
and then nothing is named. Here each stage counts it against noise and model error together. The
model error is a share of what the stage has to explain. It vanishes where that is hardly above the
noise, so that what is faint is judged against the noise alone.
"""

from collections.abc import Callable

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_EFFECT,
    MOST_POSITIONS,
    POSITION,
)
from cyclosweep.diagnosis.hypotheses.shape_columns import positions
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.freer_laws import (
    freer_instead_of_others,
    with_freer_laws,
)
from cyclosweep.diagnosis.identify.friction_first import (
    CONVERGED,
    PARAMETER_CHARGE,
    friction_first,
    from_better_start,
)
from cyclosweep.diagnosis.identify.law_in_class import (
    LEAST_OF_CLASS,
    amplitude_count,
    cancels,
    makes_others_grow,
    share_class,
)
from cyclosweep.diagnosis.identify.other_laws import with_better_laws
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.small_laws_check import errors_of_larger
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.testability import size_of
from cyclosweep.diagnosis.identify.verdict import decide, named_if_close
from cyclosweep.diagnosis.identify.worth import INDISPENSABLE, still_needed, worth
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise, orthonormal
from cyclosweep.simulation.effects.history import Flags, Floats, History

MODEL_ERROR_SHARE = 0.3
"""Model error over what a stage has to explain, as root mean squares."""
FAINT = 30.0
"""Signal-to-noise ratio up to which a mismatch is judged against the noise alone."""
MOST_STAGES = 8
"""Stages of a search: two for each of four effects, as what was accepted may be given up again."""
LEAST_OF_MISMATCH = 0.04
"""Size from which an effect is told from the model error of the others, as a share of the mismatch
of the calibrated model."""
LEAST_OF_FAMILY = 0.25
"""Size from which an effect is told from the model error of an effect of the same family that was
accepted before, as a share of the other's size."""
BY_CHANCE = 1e-4
"""Probability of a law of run offsets, found among a hundred, up to which it is no chance."""
TIMES_WHAT_IS_LEFT = 3.0
"""Size of an effect over what the whole structure leaves beyond the noise, from which it is no
model error in any case: laws that err by as much as the effect would leave more."""


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
        return fit(searched.problem, searched.noise, terms, near, rounds=CONVERGED)

    rivals: list[tuple[Candidate, float]] = []
    last = first = searched
    fitted: FittedStructure = searched.baseline.fit
    mismatch = fitted.rmse_deg
    factor = factor_of(fitted)
    if begun is not None:
        fitted = refitted(begun.terms, begun)
    elif factor > 1.0:
        fitted = friction_first(searched, searched.noise.with_model_error(factor)) or fitted
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
        decision = named_if_close(search, decide(search, [], 0.0))
        if accepted:
            last = search
        best = decision.best
        if best is None or best.score < search.start.score:
            # What leaves nothing more may still be less likely than what was accepted.
            break
        if accepted and not restarted and best.names not in kept_their_start:
            turned = from_better_start(searched.noise, best.fit, PARAMETER_CHARGE)
            kept_their_start.add(best.names)
            if turned is not best.fit:
                # What was found beside friction in the wrong state may be the error of that state.
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
        freer_form = freer_instead_of_others(search, best, part)
        if freer_form is not None:
            fitted = refitted(freer_form.fit.terms, freer_form.fit)
            accepted, last = fitted.terms, _stage(searched, flexible, fitted)
            rivals.clear()
            continue
        if {term.name for term in found} == {term.name for term in accepted}:
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
    return _with_settled_laws(searched, flexible, last)


def _with_settled_laws(searched: Search, flexible: Floats, last: Search) -> Search:
    """Settle the laws of what the stages accepted, once all of it is known.

    Parameters
    ----------
    searched : Search
        The search against the noise alone.
    flexible : ndarray, shape (fitted, k)
        Columns of a flexible model, see `visibility`.
    last : Search
        The search of the last stage.

    Returns
    -------
    Search
        That search, or one from a structure of other laws, or of freer ones.
    """
    rivals = last.rivals_of_start
    if last.start is not last.baseline:
        better = with_better_laws(last)
        if better is not last.start.fit:
            last = _stage(searched, flexible, better)
        freer = with_freer_laws(last, last.start).fit
        if freer is not last.start.fit:
            last = _stage(searched, flexible, freer)
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


def without_model_error(
    fitted: FittedStructure, accepted: FittedStructure, mismatch_deg: float
) -> tuple[Term, ...]:
    """Terms of a structure but those that may be model error of a term accepted before.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    accepted : FittedStructure
        Structure of the terms accepted before.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    tuple of Term
    """
    before = {t.name: float(np.std(size_of(accepted, k))) for k, t in enumerate(accepted.terms)}
    size = [float(np.std(size_of(fitted, k))) for k in range(len(fitted.terms))]
    left = beyond_noise_deg(fitted)
    errors = errors_of_larger(fitted)
    kept = []
    for k, term in enumerate(fitted.terms):
        others = [(size[j], each) for j, each in enumerate(fitted.terms) if each.name in before]
        family = max((s for s, each in others if each.family == term.family), default=0.0)
        alike = max((s for s, each in others if share_class(each, term)), default=0.0)
        if term.name in CLASSES_OF_EFFECT and _may_be_chance(fitted, k, size[k], left):
            beside = (s for s, each in others if each.name in CLASSES_OF_EFFECT)
            alike = max(alike, *beside, 0.0)
        mates = [j for j, each in enumerate(fitted.terms) if j != k and share_class(each, term)]
        least = max(LEAST_OF_MISMATCH * mismatch_deg, LEAST_OF_FAMILY * family)
        stands_out = size[k] >= min(least, TIMES_WHAT_IS_LEFT * left)
        stands_out &= size[k] >= LEAST_OF_CLASS * alike and term.name not in errors
        largest = max((size[j] for j in mates), default=0.0)
        small = size[k] < LEAST_OF_MISMATCH * mismatch_deg
        shrunk = size[k] < LEAST_OF_CLASS * before.get(term.name, 0.0)
        replaced = (small or shrunk) and size[k] < LEAST_OF_CLASS * largest
        replaced |= small and term.name in errors
        if (term.name in before and not replaced) or (
            stands_out and not cancels(fitted, k) and not makes_others_grow(fitted, k, accepted)
        ):
            kept.append(term)
    return tuple(kept)


def offset_count(history: History, fitted: Flags, name: str) -> int:
    """Number of offsets that a recording has for a law to follow.

    Parameters
    ----------
    history : History
        Load history of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    name : str
        Name of the effect: one that goes with the position has an offset for each position of a
        run, unless it moves steadily, the others one for each run.

    Returns
    -------
    int
    """
    if history.crank_deg is None or POSITION not in CLASSES_OF_EFFECT[name]:
        return history.run_count
    place = positions(history.crank_deg[fitted])
    if len(np.unique(place)) > MOST_POSITIONS:
        return history.run_count
    return len(np.unique(np.column_stack([history.run[fitted], place]), axis=0))


def _may_be_chance(fitted: FittedStructure, index: int, size: float, left: float) -> bool:
    """Whether a law of run offsets may by chance hold what another one misses of them.

    Offsets of runs are a few numbers. Of what is left of them, k columns drawn at random leave less
    than a share s of the mean square with probability s to the half of their number less k.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Place of the law's term.
    size : float
        Root mean square of its twist [deg].
    left : float
        Root mean square of what the whole structure leaves beyond the noise [deg].

    Returns
    -------
    bool
    """
    offsets = [k for k, term in enumerate(fitted.terms) if term.name in CLASSES_OF_EFFECT]
    counted = sum(amplitude_count(fitted, k) for k in offsets)
    name = fitted.terms[index].name
    free = offset_count(fitted.history, fitted.problem.fitted, name) - 1 - counted
    share = left**2 / max(left**2 + size**2, 1e-300)
    return free <= 0 or share ** (0.5 * free) > BY_CHANCE
