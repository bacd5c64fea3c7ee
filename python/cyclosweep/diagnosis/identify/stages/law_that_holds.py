"""Another law of the class in the place of one that fitted best and does not stand for it.

The likeliest law of a loud effect need not be the right one: an eccentric dial has two amplitudes,
and takes up what the friction beside it misses as well. Where it is withdrawn, a law of the same
class that does stand for the class is named.
"""

from cyclosweep.diagnosis.identify.laws.law_in_class import own_classes
from cyclosweep.diagnosis.identify.laws.naming import Naming, names_that_hold
from cyclosweep.diagnosis.identify.stages.other_laws import rivals_of
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.worth import INDISPENSABLE

MOST_LOST = 0.25
"""Share of the log evidence of the withdrawn laws that may be lost with the other one in their
place: they fit better, else they would not have been found."""


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
        The likeliest structure in which all laws hold and which leaves nothing in the classes of
        the withdrawn ones; None where there is none, or where the withdrawn laws are far likelier.
    """
    part = naming.part
    most_lost = MOST_LOST * search.chi2_gain(part.fit, accepted.fit)
    names = {check.name for check in naming.withdrawn}
    gone = [t for t in accepted.fit.terms if t.name in names and t.effect and not t.slips]
    classes = {behaviour for term in gone for behaviour in own_classes(term)}
    rivals = {name for term in gone for name in rivals_of(search, accepted.fit, term)}
    best, least = None, part.score + INDISPENSABLE
    for name in sorted(rivals & set(part.scan.groups)):
        child = search.extend(part, name)
        if child is None or not child.all_recognised or child.score < least:
            continue
        if search.chi2_gain(child.fit, accepted.fit) > most_lost:
            continue
        found = names_that_hold(search, child, child)
        left = {shown.behaviour for shown in found.shown} & classes
        if not (found.withdrawn or left) and name in found.names:
            best, least = found, child.score
    return best
