"""Structures that a search need not extend, as a search by nearly the same noise has done it."""

from cyclosweep.diagnosis.identify.structures.search import Search

FAR_BEHIND = 0.2
"""Share of the log odds of the best structure by which another is far behind,"""
LEAST_BEHIND = 50.0
"""and by at least so much [nat]."""


def far_behind(search: Search) -> frozenset[frozenset[str]]:
    """Structures of which every extension is far less likely than the best, or has a better origin.

    An extension that is not far behind, and has a part that is not either, is found again from that
    part.

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
    near = {names for names, each in search.visited.items() if each.score >= least}
    children: dict[frozenset[str], set[frozenset[str]]] = {}
    for parent, hypothesis in search.tried:
        children.setdefault(parent.names, set()).add(parent.names | {hypothesis})

    def leads_on(names: frozenset[str], child: frozenset[str]) -> bool:
        others = any(child - {name} in near for name in child if child - {name} != names)
        return child in near and (names in near or not others)

    behind = {
        names
        for names, found in children.items()
        if not any(leads_on(names, child) for child in found)
    }
    return search.not_extended | {names for names in behind if not names <= best.names}
