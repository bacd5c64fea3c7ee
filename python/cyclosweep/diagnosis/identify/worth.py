"""What a term of a structure is worth beside the other terms."""

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term

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
    return 0.5 * search.gain(without, candidate.fit)


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
