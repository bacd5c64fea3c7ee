"""Laws that miss a part of their class are given more freedom before they lose their name.

A search gives a law more freedom where its residual asks for it. Beside a large friction what a law
misses may be too little to ask for it, and still be a part of its class that is too large to leave.
"""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LawCheck,
    amplitude_count,
    cancels,
    makes_others_grow,
    own_classes,
)
from cyclosweep.diagnosis.identify.stages.free_offsets import with_free_offsets
from cyclosweep.diagnosis.identify.stages.other_laws import left_beyond_noise
from cyclosweep.diagnosis.identify.structures.candidate import FURTHER, Candidate
from cyclosweep.diagnosis.identify.structures.enrichment import TRIED, freer_laws
from cyclosweep.diagnosis.identify.structures.scan import evidence
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist

MOST_OWN_GROWTH = 1.5
"""Size of a law in its freer form over its size before, from which it has taken the place of other
effects."""
ROUNDS = 2
"""Times a law is given more freedom."""


def with_freer_laws(search: Search, accepted: Candidate) -> Candidate:
    """Give the laws that do not stand for their classes more freedom of shape.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects.

    Returns
    -------
    Candidate
        The same where no law with more freedom is preferred by the evidence.
    """
    if accepted.fit.independent_share < 1.0 or not accepted.fit.terms:
        return accepted
    for _ in range(ROUNDS):
        found = None
        for check in check_laws(accepted.fit):
            if not check.holds and found is None:
                found = _with_freer(search, accepted, check)
        if found is None:
            break
        accepted = found
    return with_free_offsets(search, accepted)


def freer_instead_of_others(
    search: Search, best: Candidate, acceptable: Candidate
) -> Candidate | None:
    """One law in a form that holds nearly its whole class, where further effects cost more.

    What a dial misses that is tilted as well, a side load and a softening take up between them.

    Parameters
    ----------
    search : Search
        Search of a stage, run.
    best : Candidate
        Its best structure.
    acceptable : Candidate
        The part of it that can be accepted; where that is nothing, the law has to leave no more
        than the best structure does.

    Returns
    -------
    Candidate or None
        The law beside what was accepted before. None where no law of the best structure has such a
        form, or where the evidence prefers the part.
    """
    start, left_by_best = search.start, left_beyond_noise(best.fit)
    for index, term in enumerate(best.fit.terms):
        if term.effect is None or term.slips:
            continue
        others = tuple(t for t in best.fit.terms if t.name in start.names and t is not term)
        same = [k for k, each in enumerate(start.fit.terms) if each.name == term.name]
        known = sum(amplitude_count(start.fit, k) for k in same)
        before = (
            recalibrated_twist(start.fit, same[0]) if same else recalibrated_twist(best.fit, index)
        )
        for terms, _ in freer_laws(best, search.library, index, whole_class=True):
            charge = term.effect.penalty(terms[index].shape)
            if charge <= term.effect.penalty(term.shape):
                continue
            joint = with_right_signs(
                fit(search.problem, search.noise, (*others, terms[index]), best.fit)
            )
            if joint is None or cancels(joint, len(others)):
                continue
            if makes_others_grow(joint, len(others), start.fit):
                continue
            if np.std(recalibrated_twist(joint, len(others))) > MOST_OWN_GROWTH * np.std(before):
                continue
            rank = amplitude_count(joint, len(others)) - known
            added = float(evidence(search.chi2_gain(start.fit, joint), rank))
            further = FURTHER if start.fit.terms and not known else 0.0
            found = search.judged(joint, start.gain + added, start.prior - charge - further)
            enough = acceptable is not start or left_beyond_noise(joint) <= left_by_best
            if enough and found.all_recognised and found.score > acceptable.score:
                return found
    return None


def _with_freer(search: Search, accepted: Candidate, check: LawCheck) -> Candidate | None:
    """Give a law more freedom that does not stand for its class, or the law it takes after.

    What one law leaves of its class another one fills: the one that fails is then not its own.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects.
    check : LawCheck
        Of the law that fails.

    Returns
    -------
    Candidate or None
        None where no law with more freedom is preferred by the evidence.
    """
    alike = [
        k
        for k, term in enumerate(accepted.fit.terms)
        if term.effect is not None and check.behaviour in own_classes(term)
    ]
    own = accepted.fit.names.index(check.name)
    for index in dict.fromkeys([own, *alike]):
        offers = freer_laws(accepted, search.library, index, TRIED, whole_class=True)
        found = search.first_better(accepted, offers)
        if found is not None:
            return found
    return None
