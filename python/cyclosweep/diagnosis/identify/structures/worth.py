"""What a term of a structure is worth beside the other terms."""

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import strength_of
from cyclosweep.result.part import NORMAL_95

INDISPENSABLE = 10.0
"""Log likelihood that a named effect must be worth beside an unnamed shape to be accepted [nat]."""


def worth(search: Search, name: str, candidate: Candidate) -> float:
    """Log likelihood that a term is worth beside the others, which are fitted again without it.

    Parameters
    ----------
    search : Search
        Search by whose noise it is counted.
    name : str
        Name of the term.
    candidate : Candidate
        The structure.

    Returns
    -------
    float
        In nat.
    """
    others = tuple(term for term in candidate.fit.terms if term.name != name)
    without = fit(search.problem, search.noise, others, candidate.fit)
    return 0.5 * search.chi2_gain(without, candidate.fit)


def still_needed(search: Search, best: Candidate, accepted: tuple[Term, ...]) -> tuple[Term, ...]:
    """Terms accepted before, but frictions that are dispensable beside what a stage has found.

    A friction taken first may have stood in for another cause; curves and offsets are not asked
    again, because shapes without a name that wander hold any of them.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.
    accepted : tuple of Term
        The terms accepted before.

    Returns
    -------
    tuple of Term
        As they are in the best structure.
    """
    before = {term.name for term in accepted}
    kept = tuple(term for term in best.fit.terms if term.name in before)
    if len(kept) == len(best.fit.terms):
        return kept
    return tuple(
        term for term in kept if not term.slips or worth(search, term.name, best) >= INDISPENSABLE
    )


def without_unseen_friction(search: Search, candidate: Candidate) -> Candidate:
    """Leave out frictions that are not seen beside the other terms, which fit as well alone.

    Such a one stood in for what was found after it.

    Parameters
    ----------
    search : Search
        Search by whose noise it is counted.
    candidate : Candidate
        The structure.

    Returns
    -------
    Candidate
        The same one where there is none, or nothing but friction.
    """
    terms = candidate.fit.terms
    if all(term.slips for term in terms):
        return candidate
    unseen = {
        term.name
        for k, term in enumerate(terms)
        if term.slips and strength_of(search, candidate.fit, k) < NORMAL_95
    }
    if not unseen:
        return candidate
    part = search.refit(tuple(t for t in terms if t.name not in unseen), candidate.fit)
    as_well = search.chi2_gain(part.fit, candidate.fit) < NORMAL_95**2
    return part if as_well and part.all_recognised else candidate
