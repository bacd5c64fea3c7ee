"""What of the best structure of a stage is accepted, so that the next stage starts from it."""

from collections.abc import Set
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.law_in_class import cancels
from cyclosweep.diagnosis.identify.laws.model_error_terms import (
    TIMES_WHAT_IS_LEFT,
    without_model_error,
)
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.diagnosis.identify.structures.verdict import Decision, likely, probabilities
from cyclosweep.diagnosis.identify.structures.worth import INDISPENSABLE, worth

HARDLY_LESS_LIKELY = 10.0
"""Log odds by which a structure that is accepted whole may be behind the best one [nat]."""


@dataclass(frozen=True)
class Accepted:
    """What a stage accepts.

    Attributes
    ----------
    best : Candidate
        Structure that the terms are taken from.
    terms : tuple of Term
        Those accepted; where they are those that the stage started from, it adds nothing.
    decision : Decision
        Explanations of the stage, of structures accepted whole where these were taken.
    """

    best: Candidate
    terms: tuple[Term, ...]
    decision: Decision

    @property
    def names(self) -> frozenset[str]:
        """Names of the terms."""
        return frozenset(term.name for term in self.terms)

    def part(self, search: Search) -> Candidate:
        """Structure of the accepted terms alone; the start of the stage where it has not been."""
        return search.visited.get(self.names, search.start)


def acceptable(
    search: Search,
    decision: Decision,
    best: Candidate,
    before: Set[str],
    mismatch_deg: float,
) -> tuple[Candidate, Accepted]:
    """Choose what a stage accepts of the best structure that it found.

    Parameters
    ----------
    search : Search
        Search of the stage.
    decision : Decision
        What it says of the stage.
    best : Candidate
        Its best structure.
    before : set of str
        Names of the terms accepted so far.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    part : Candidate
        Part of the best structure that is no model error, as the stage found it.
    accepted : Accepted
        What is accepted in the end.
    """
    found = without_model_error(best.fit, search.start.fit, mismatch_deg)
    if decision.unexplained:
        doubtful = _doubtful(search, best)
        found = tuple(term for term in found if term.name not in doubtful)
    accepted = Accepted(best, found, decision)
    part = accepted.part(search)
    if accepted.names == before and not decision.unexplained:
        # The likelier of two structures that leave nothing may hold too much. It is no rival
        # then: what makes it likelier may be model error.
        whole = _accepted_whole(search, best, mismatch_deg)
        if whole:
            decision = replace(decision, explanations=likely(probabilities(whole)))
            accepted = Accepted(whole[0], whole[0].fit.terms, decision)
    if accepted.names == before:
        other = _without_cancelling(search, accepted.best, mismatch_deg)
        if other is not None:
            accepted = Accepted(other, other.fit.terms, accepted.decision)
    return part, accepted


def _accepted_whole(search: Search, best: Candidate, mismatch_deg: float) -> list[Candidate]:
    """Structures that leave nothing, and of which no term may be model error.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    list of Candidate
        Those that are hardly less likely than the best, most probable first.
    """
    least = max(best.score - HARDLY_LESS_LIKELY, search.start.score)

    def is_whole(other: Candidate) -> bool:
        recognised = other.all_recognised and search.suffices(other)
        return recognised and _adds_no_model_error(search, other, mismatch_deg)

    return [each for each in search.explanations() if each.score >= least and is_whole(each)]


def _adds_no_model_error(search: Search, other: Candidate, mismatch_deg: float) -> bool:
    """Whether a structure holds more than a stage started from, none of it perhaps model error.

    Parameters
    ----------
    search : Search
        Search of the stage.
    other : Candidate
        Structure that may be accepted whole.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    bool
        Whether it may.
    """
    if not search.start.names < other.names:
        return False
    kept = without_model_error(other.fit, search.start.fit, mismatch_deg)
    return len(kept) == len(other.fit.terms)


def _without_cancelling(search: Search, best: Candidate, mismatch_deg: float) -> Candidate | None:
    """Part of a structure that is accepted in its place where its new terms cancel each other.

    Two laws whose difference is any curve may fit best and leave nothing to accept, though one of
    them alone explains most of it.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    Candidate or None
        None where no new terms cancel, or no part is worth as much as is asked.
    """
    start = search.start
    new = [k for k, term in enumerate(best.fit.terms) if term.name not in start.names]
    if not best.all_recognised or not any(cancels(best.fit, k) for k in new):
        return None
    least = start.score + INDISPENSABLE

    def holds(other: Candidate) -> bool:
        part = other.score >= least and other.names < best.names
        return part and _adds_no_model_error(search, other, mismatch_deg)

    return max(
        (each for each in search.visited.values() if holds(each)),
        key=lambda each: each.score,
        default=None,
    )


def _doubtful(search: Search, best: Candidate) -> frozenset[str]:
    """Terms that are not to be accepted of a structure that leaves something, or holds the unnamed.

    Parameters
    ----------
    search : Search
        Search of the stage.
    best : Candidate
        Its best structure.

    Returns
    -------
    frozenset of str
        Names of the terms without a name, and of those that do not stand out from what is left.
    """
    fitted = best.fit
    left = beyond_noise_deg(fitted)
    found = set[str]()
    for k, (term, recognised) in enumerate(zip(fitted.terms, best.recognised, strict=True)):
        if term.name in search.start.names:
            continue
        clear = float(np.std(recalibrated_twist(fitted, k))) >= TIMES_WHAT_IS_LEFT * left
        if not (recognised and clear) or worth(search, term.name, best) < INDISPENSABLE:
            found.add(term.name)
    return frozenset(found)
