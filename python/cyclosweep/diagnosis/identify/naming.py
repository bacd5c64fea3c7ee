"""Which effects of an accepted structure may be named, and what is left beside these."""

from dataclasses import dataclass

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.class_check import (
    LawCheck,
    ShownClass,
    check_laws,
    shown_classes,
)
from cyclosweep.diagnosis.identify.search import Search


@dataclass(frozen=True, eq=False)
class Naming:
    """The effects of a structure whose laws stand for their classes of behaviour.

    Attributes
    ----------
    part : Candidate
        The structure with these effects alone; the baseline where there are none.
    checks : tuple of LawCheck
        How each law stood to its class, those first that may be named.
    shown : tuple of ShownClass
        Classes of behaviour that this part leaves.
    """

    part: Candidate
    checks: tuple[LawCheck, ...]
    shown: tuple[ShownClass, ...]

    @property
    def names(self) -> frozenset[str]:
        """Names of the effects that may be named."""
        return frozenset(check.name for check in self.checks if check.holds)

    @property
    def withdrawn(self) -> tuple[LawCheck, ...]:
        """The laws that may not be named."""
        return tuple(check for check in self.checks if not check.holds)


def names_that_hold(search: Search, accepted: Candidate) -> Naming:
    """Withdraw laws that do not stand for their class, until those that are left do.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects.

    Returns
    -------
    Naming
    """
    part, withdrawn = accepted, list[LawCheck]()
    while True:
        checks = check_laws(part.fit)
        gone = [check for check in checks if not check.holds]
        if not gone:
            return Naming(part, (*checks, *withdrawn), shown_classes(part.fit))
        withdrawn += gone
        names = {check.name for check in checks if check.holds}
        terms = tuple(term for term in part.fit.terms if term.name in names)
        part = search.refit(terms) if terms else search.baseline
