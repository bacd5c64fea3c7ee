"""Structures that a search extends next: the best, and the best of those that have names alone."""

from collections.abc import Sequence

from cyclosweep.diagnosis.identify.candidate import Candidate

FAR_BEHIND = 0.2
"""Share of the log odds of the best structure by which another is far behind,"""
LEAST_BEHIND = 50.0
"""and by at least so much [nat]."""


def least_near(score: float) -> float:
    """Log odds [nat] from which a structure is not far behind one of these log odds."""
    return score - max(FAR_BEHIND * score, LEAST_BEHIND)


def front(found: Sequence[Candidate], breadth: int, named_breadth: int) -> list[Candidate]:
    """Structures to extend by one more term.

    What is far behind is left out: the term that it lacks beside the best one is by then the larger
    of the two, and both together are reached from the best one.

    Parameters
    ----------
    found : sequence of Candidate
        Structures, each of other terms, the best first.
    breadth : int
        Most structures of whatever terms.
    named_breadth : int
        Most structures without a term that has no name.

    Returns
    -------
    list of Candidate
    """

    def near_the_first(candidates: Sequence[Candidate]) -> list[Candidate]:
        return [n for n in candidates if n.score >= least_near(candidates[0].score)]

    kept = near_the_first(found)[:breadth]
    named = near_the_first([n for n in found if n.all_recognised])[:named_breadth]
    return [*kept, *(n for n in named if all(n is not other for other in kept))]
