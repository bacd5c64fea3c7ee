"""Another law of the class in the place of one that fitted best and does not stand for it.

The likeliest law of a loud effect need not be the right one: an eccentric dial has two amplitudes,
and takes up what the friction beside it misses as well. Where it is withdrawn, a law of the same
class that does stand for the class is named.
"""

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.naming import Naming, names_that_hold
from cyclosweep.diagnosis.identify.other_laws import rivals_of
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.worth import INDISPENSABLE

MOST_WORSE = 1.25
"""Root mean square error with the other law over that with the withdrawn ones, up to which it takes
their place: the withdrawn ones fit better, else they would not have been found."""


def with_law_that_holds(search: Search, accepted: Candidate, naming: Naming) -> Naming | None:
    """Name another law of the class of one that was withdrawn, beside those that hold.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects alone, fitted to the rows in contact.
    naming : Naming
        Which of them may be named.

    Returns
    -------
    Naming or None
        The likeliest structure in which all laws hold; None where there is none, or where the
        withdrawn laws fit far better.
    """
    part, worst = naming.part, MOST_WORSE * accepted.fit.rmse_deg
    gone = {check.name for check in naming.withdrawn}
    rivals = {
        name
        for term in accepted.fit.terms
        if term.name in gone and term.effect is not None and not term.slips
        for name in rivals_of(search, accepted.fit, term)
        if name in part.scan.groups
    }
    best: Naming | None = None
    for name in sorted(rivals):
        child = search.extend(part, name)
        if child is None or not child.all_recognised or child.fit.rmse_deg > worst:
            continue
        if child.score < max(part.score + INDISPENSABLE, best.part.score if best else -1e300):
            continue
        found = names_that_hold(search, child, child)
        if not found.withdrawn and name in found.names:
            best = found
    return best
