"""Structures that a search need not extend, as a search by nearly the same noise has done it."""

from cyclosweep.diagnosis.identify.search import Search

FAR_BEHIND = 0.2
"""Share of the log odds of the best structure by which another is far behind,"""
LEAST_BEHIND = 50.0
"""and by at least so much [nat]."""


def far_behind(search: Search) -> frozenset[frozenset[str]]:
    """Structures of which every extension is far less likely than the best structure.

    A better estimate of the noise scales the evidence of all structures alike. It does not bring
    those together that are far apart, and fits beside them are most of the time of a search.

    Parameters
    ----------
    search : Search
        After it has run.

    Returns
    -------
    frozenset of frozenset of str
        By the names of their terms; those that this search was told not to extend are among them.
    """
    best = search.best()
    if best is None:
        return search.not_extended
    least = best.score - max(FAR_BEHIND * best.score, LEAST_BEHIND)
    likeliest: dict[frozenset[str], float] = {}
    for parent, hypothesis in search.tried:
        child = search.visited.get(parent.names | {hypothesis})
        score = -float("inf") if child is None else child.score
        likeliest[parent.names] = max(likeliest.get(parent.names, score), score)
    behind = {names for names, score in likeliest.items() if score < least}
    return search.not_extended | {names for names in behind if not names <= best.names}
