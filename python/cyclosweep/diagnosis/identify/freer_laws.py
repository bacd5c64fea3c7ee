"""Laws that miss a part of their class are given more freedom before they lose their name.

A search gives a law more freedom where its residual asks for it. Beside a large friction what a law
misses may be too little to ask for it, and still be a part of its class that is too large to leave.
"""

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.class_check import check_laws
from cyclosweep.diagnosis.identify.enrichment import TRIED, freer_laws
from cyclosweep.diagnosis.identify.free_offsets import with_free_offsets
from cyclosweep.diagnosis.identify.law_in_class import LawCheck, own_classes
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
                found = _with_freer(search, accepted, check)
        if found is None:
            break
        accepted = found
    return with_free_offsets(search, accepted)


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
