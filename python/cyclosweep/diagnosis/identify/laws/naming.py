"""Which effects of an accepted structure may be named, and what is left beside these."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.line_basis import line_basis
from cyclosweep.diagnosis.identify.laws.class_check import (
    ShownClass,
    check_laws,
    shown_classes,
)
from cyclosweep.diagnosis.identify.laws.law_in_class import LawCheck, withdrawn_where
from cyclosweep.diagnosis.identify.laws.one_class_check import without_laws_of_one_class
from cyclosweep.diagnosis.identify.laws.small_laws_check import without_small_laws
from cyclosweep.diagnosis.identify.laws.travel_check import (
    without_faint_waves,
    without_waves_of_a_curve,
)
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import of_any_size
from cyclosweep.diagnosis.identify.structures.worth import INDISPENSABLE, worth


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

    def without_withdrawn(self) -> "Naming":
        """The same where the effects that may be named are all there is."""
        return Naming(self.part, tuple(check for check in self.checks if check.holds), ())


def names_that_hold(search: Search, accepted: Candidate, best: Candidate) -> Naming:
    """Withdraw laws that do not stand for their class, until those that are left do.

    The laws that are left are fitted again alone. Beside friction, and in a simulation of whole
    loops, the others stay as stand-ins while these are judged: without them friction would take
    their place.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects.
    best : Candidate
        The same with what has no name.

    Returns
    -------
    Naming
    """
    if accepted.fit.independent_share < 1.0:
        return _beside_stand_ins(search, accepted)

    # Otherwise chi-squared is counted against another noise.
    same_noise = best.fit.noise.model_error_factor == search.noise.model_error_factor

    @cache
    def is_needless(name: str) -> bool:
        """Whether a law explains next to nothing beside what has no name and the other laws.

        Of two laws that stand for each other beside it neither is named: nothing tells which.
        """
        beside_unnamed = same_noise and name in best.names and not best.all_recognised
        return beside_unnamed and worth(search, name, best) < INDISPENSABLE

    part, withdrawn, beside = accepted, list[LawCheck](), list[LawCheck]()
    while True:
        checks = _beside_the_line(part.fit, check_laws(part.fit, beside))
        judged = all(check.holds for check in checks)
        if judged:
            # Those that are left stood for their class together with the small ones.
            larger = without_small_laws(part.fit, checks)
            checks = without_laws_of_one_class(part.fit, larger)
            checks = without_waves_of_a_curve(search.baseline.fit, part.fit, checks)
            checks = _without_lesser_laws(part.fit, checks, best.fit)
            checks = withdrawn_where(is_needless, checks)
            checks = without_faint_waves(search, part.fit, checks)
            checks = _of_known_size(search, part.fit, checks)
            judged = checks == larger
        gone = [check for check in checks if not check.holds]
        withdrawn += gone
        held = {check.name for check in checks if check.holds}
        kept = tuple(term for term in part.fit.terms if term.name in held)
        if gone and part.fit.keeps_line and any(term.slips for term in kept):
            beside += gone
        elif gone:
            part, beside = search.refit(kept, part.fit) if kept else search.baseline, []
        if judged:
            part = search.refit(kept, part.fit) if beside else part
            holding = (check for check in checks if check.holds)
            return Naming(part, (*holding, *withdrawn), shown_classes(part.fit))


def _beside_the_line(fitted: FittedStructure, checks: Sequence[LawCheck]) -> tuple[LawCheck, ...]:
    """Withdraw elastic laws that have taken the place of the drive's own elasticity.

    Parameters
    ----------
    fitted : FittedStructure
        Structure of effects.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    elastic = {
        term.name
        for term in fitted.terms
        if term.elastic or (term.effect is not None and term.effect.elastic)
    }
    if fitted.keeps_line or not elastic:
        return tuple(checks)
    # The others were fitted beside a wrong line: they are judged when they are fitted without it.
    return tuple(replace(check, holds=check.name not in elastic) for check in checks)


def _of_known_size(
    search: Search, fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw laws that fit as well at any size down to none, or let friction do so.

    A stiffening that ends at next to no torque is free play by another name, a creep that never
    ends within the recording is a drift, and a take-up at next to no torque tells the compliance
    before the friction from that behind it: other parameters can make up for the whole of it.

    Parameters
    ----------
    search : Search
        Search of the recording.
    fitted : FittedStructure
        Structure of effects.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    return withdrawn_where(of_any_size(search, fitted).__contains__, checks)


def _without_lesser_laws(
    fitted: FittedStructure, checks: Sequence[LawCheck], best: FittedStructure
) -> tuple[LawCheck, ...]:
    """Withdraw laws that explain less than what has no name, of which they may be a part.

    Parameters
    ----------
    fitted : FittedStructure
        Structure of effects.
    checks : sequence of LawCheck
        Of its laws.
    best : FittedStructure
        The same with what has no name.

    Returns
    -------
    tuple of LawCheck
    """
    if best.noise.model_error_factor != fitted.noise.model_error_factor:
        # Chi-squared is counted against another noise.
        return tuple(checks)
    unnamed = fitted.chi2 - best.chi2
    place = {term.name: index for index, term in enumerate(fitted.terms)}
    line = line_basis(fitted)

    def explains_less(name: str) -> bool:
        law = fitted.whitened_contribution(place[name], fitted.noise)
        law -= line @ (line.T @ law)
        return float(law @ law) < unnamed

    return withdrawn_where(explains_less, checks)


def _beside_stand_ins(search: Search, accepted: Candidate) -> Naming:
    """Withdraw laws of a simulation, each judged beside the whole classes of those before it.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure fitted to whole loops.

    Returns
    -------
    Naming
    """
    withdrawn = list[LawCheck]()
    while True:
        checks = check_laws(accepted.fit, withdrawn)
        gone = [check for check in checks if not check.holds]
        if not gone:
            break
        withdrawn += gone
    checks, part = without_small_laws(accepted.fit, checks), accepted
    while True:
        withdrawn += [check for check in checks if not check.holds]
        checks = tuple(check for check in checks if check.holds)
        if withdrawn:
            alone = accepted.fit.only({check.name for check in checks}) if checks else None
            part = search.baseline if alone is None else search.judged(alone, 0.0, 0.0)
        checks = without_waves_of_a_curve(search.baseline.fit, part.fit, checks)
        checks = without_faint_waves(search, part.fit, checks)
        checks = _of_known_size(search, part.fit, checks)
        if all(check.holds for check in checks):
            break
    return Naming(part, (*checks, *withdrawn), shown_classes(part.fit))
