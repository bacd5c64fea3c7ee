"""Laws that miss a part of their class are given more freedom before they lose their name.

A search gives a law more freedom where its residual asks for it. Beside a large friction what a law
misses may be too little to ask for it, and still be a part of its class that is too large to leave.
"""

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.class_check import check_laws
from cyclosweep.diagnosis.identify.enrichment import TRIED, freer_laws
from cyclosweep.diagnosis.identify.search import Search

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
                index = accepted.fit.names.index(check.name)
                offers = freer_laws(accepted, search.library, index, TRIED)
                found = search.first_better(accepted, offers)
        if found is None:
            break
        accepted = found
    return accepted
