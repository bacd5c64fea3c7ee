"""Look-alikes of the effects that a search found, each to be tried in the place of the other.

A search in breadth adds the effects one by one, and follows those that explain most at first. Which
of two laws of one class of behaviour it takes is so decided while other effects are still missing.
Once these are known, the other law may do as well or better in its place.
"""

from collections.abc import Iterator, Mapping

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.own_classes import look_alikes


def exchanges(
    best: Candidate,
    start: Candidate,
    visited: Mapping[frozenset[str], Candidate],
    library: Library,
) -> Iterator[tuple[Candidate, str]]:
    """Parts of a structure, each with a look-alike of the effect that was left out.

    Parameters
    ----------
    best : Candidate
        The structure.
    start : Candidate
        What every structure contains; its effects stay.
    visited : mapping of frozenset of str to Candidate
        Structures by the names of their terms. Parts that were not visited are passed over.
    library : Library

    Yields
    ------
    (Candidate, str)
        A structure and the name of the effect to be added to it.
    """
    for term in best.fit.terms:
        if term.effect is None or term.slips or term.name in start.names:
            continue
        names = best.names - {term.name}
        part = start if names == start.names else visited.get(names)
        if part is None:
            continue
        for name in look_alikes(library, best.names, term):
            if name in part.scan.groups:
                yield part, name
