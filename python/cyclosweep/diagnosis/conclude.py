"""Decision: the verdict that the visited structures allow, and the structure that it rests on."""

from dataclasses import dataclass, replace

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.identify.fitting.explained import explained_share
from cyclosweep.diagnosis.identify.fitting.repetition import Repetition
from cyclosweep.diagnosis.identify.laws.naming import Naming, names_that_hold
from cyclosweep.diagnosis.identify.stages.freer_laws import with_freer_laws
from cyclosweep.diagnosis.identify.stages.law_that_holds import with_law_that_holds
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import Testability, testability
from cyclosweep.diagnosis.identify.structures.verdict import (
    MOSTLY,
    Decision,
    accepted_in_stages,
    decide,
    decide_in_stages,
    named_if_close,
    no_more_than_fits,
    verdict_by_probability,
    verdict_by_share,
)
from cyclosweep.diagnosis.identify.structures.worth import without_unseen_friction
from cyclosweep.diagnosis.refuse import check_compliance, check_positive
from cyclosweep.diagnosis.whole_loop.run_comparison import repetition
from cyclosweep.result import Explained

DEFAULT_TOLERANCE = 0.01
"""Size below which an effect does not matter, as a share of the largest elastic twist."""
FEW_READINGS = 100
"""Readings up to which laws that fit about as well are not told apart: so few cannot show that a
law leaves nothing but noise."""
SURE_OF_FEW = 0.99
"""Probability that the best explanation needs to be named from a few readings."""

NAMING = ("IDENTIFIED", "AMBIGUOUS", "MOSTLY_EXPLAINED")
"""Verdicts that name effects."""
MOST_WORSE = 1.02
"""Error of a structure over that of the calibrated model beyond which it repairs nothing. Where a
few rows are far off, a likelihood may be better by effects at an error a little larger."""


@dataclass(frozen=True, eq=False)
class Conclusion:
    """What the evidence says of the structures that were visited.

    Attributes
    ----------
    search : Search
        The structures, and everything they share.
    tolerance_deg : float
        Size below which an effect does not matter [deg].
    decision : Decision
        Verdict and explanations by the fit. `Verification.decision` is the one that is reported: it
        is another one where the drive turns out to have changed from run to run.
    accepted : Candidate
        The effects of the best structure, for repair and prediction; the baseline where nothing was
        found. Those that may not be named stand in for their classes of behaviour.
    naming : Naming
        Which of them may be named.
    repetition : Repetition or None
        How far the residual repeats between runs, where it is error of the model.
    beyond_baseline, beyond_accepted : list of Testability
        Bounds of every effect that is not in the baseline, and not in the accepted structure.
    excluded : frozenset of str
        Effects that are ruled out.
    explained : Explained
        Share of the mismatch that the named effects explain.
    """

    search: Search
    tolerance_deg: float
    decision: Decision
    accepted: Candidate
    naming: Naming
    repetition: Repetition | None
    beyond_baseline: list[Testability]
    beyond_accepted: list[Testability]
    excluded: frozenset[str]
    explained: Explained

    @property
    def best(self) -> Candidate:
        """The best structure, with and without a name; the baseline where nothing was found."""
        return self.search.baseline if self.decision.best is None else self.decision.best


def conclude(search: Search, drive: Drive, tolerance_deg: float | None) -> Conclusion:
    """Choose the verdict, and bound every effect that was not found.

    Parameters
    ----------
    search : Search
        With all visited structures.
    drive : Drive
        The drive, to see whether the calibrated compliance can be its own.
    tolerance_deg : float or None
        Size below which an effect does not matter [deg]; None takes 1 % of the largest twist.

    Returns
    -------
    Conclusion

    Raises
    ------
    NoDiagnosisError
        The calibrated compliance is impossible for this drive, or that of the repaired model for
        any.
    """
    history = search.baseline.fit.history
    check_compliance(search.problem, drive, history.compliance_deg_per_nm)
    if search.baseline.fit.line_compliance_deg_per_nm <= 0.0:
        check_positive(search.problem.history.compliance_deg_per_nm)
    tolerance = DEFAULT_TOLERANCE * history.largest_twist_deg
    if tolerance_deg is not None:
        tolerance = tolerance_deg
    p_values = {n: search.alarm.p_value(value) for n, value in search.baseline.excesses.items()}
    beyond_baseline = testability(search, search.baseline, p_values)
    repeats = None
    if search.noise.structured:
        repeats = repetition(search.problem, (search.chosen or search.baseline).fit)
    decision, accepted, naming, explained = _decided(search, beyond_baseline, tolerance)
    check_positive(accepted.fit.line_compliance_deg_per_nm)
    decision = no_more_than_fits(decision, accepted, search, explained.share or 0.0)
    beyond_accepted = beyond_baseline
    if accepted is not search.baseline:
        beyond_accepted = testability(search, accepted, p_values)
        unnamed = {check.name for check in naming.withdrawn} & set(accepted.fit.names)
        beyond_accepted += [bound for bound in beyond_baseline if bound.name in unnamed]
    possible = {term.name for each, _ in decision.explanations for term in each.fit.terms}
    below = {bound.name for bound in beyond_accepted if bound.upper95_deg < tolerance}
    return Conclusion(
        search=search,
        tolerance_deg=tolerance,
        decision=decision,
        accepted=accepted,
        naming=naming,
        repetition=repeats,
        beyond_baseline=beyond_baseline,
        beyond_accepted=beyond_accepted,
        excluded=frozenset(below - possible),
        explained=explained,
    )


def _decided(
    search: Search, beyond_baseline: list[Testability], tolerance_deg: float
) -> tuple[Decision, Candidate, Naming, Explained]:
    """Choose the structure, and which of its names hold.

    Parameters
    ----------
    search : Search
        With all visited structures.
    beyond_baseline : list of Testability
        Bounds of every effect beside the calibrated model.
    tolerance_deg : float
        Size below which an effect does not matter [deg].

    Returns
    -------
    decision, accepted, naming, explained
        What is said, the structure it rests on, its names, and the share that they explain.
    """
    staged: tuple[Candidate, Explained] | None = None
    found = accepted_in_stages(search)
    if found is not None:
        staged = found, explained_share(search.baseline.fit, found.fit, search.seed)
        decision = decide_in_stages(search, staged[1].share or 0.0)
    else:
        decision = decide(search, beyond_baseline, tolerance_deg)
        if search.problem.count <= FEW_READINGS:
            decision = named_if_close(search, decision)
    accepted = search.baseline if decision.best is None else _named_part(search, decision.best)
    # What was accepted in stages has been given its freedom there.
    freer = with_freer_laws(search, accepted) if staged is None else accepted
    needed = without_unseen_friction(search, freer)
    decision, accepted = _with_structure(decision, accepted, needed), needed
    naming = names_that_hold(search, accepted, decision.best or accepted)
    if staged is not None and naming.withdrawn and _is_enough(search, naming.part):
        # What was withdrawn explains nothing that the others do not explain.
        decision = _with_structure(decision, accepted, naming.part)
        decision = replace(decision, verdict="IDENTIFIED", unexplained=False)
        accepted, naming = naming.part, naming.without_withdrawn()
    other = with_other_law(search, decision, accepted, naming)
    if other is not None:
        decision, naming = other
        accepted = naming.part
    if staged is not None and staged[0] is naming.part:
        explained = staged[1]
    else:
        explained = explained_share(search.baseline.fit, naming.part.fit, search.seed)
    decision = _with_names_that_hold(search, decision, naming, explained.share or 0.0)
    if decision.verdict == "INSUFFICIENT_DATA":
        accepted = search.baseline
    return decision, accepted, naming, explained


def _is_enough(search: Search, part: Candidate) -> bool:
    """Whether named effects alone leave nothing but noise, no model error allowed for.

    Parameters
    ----------
    search : Search
        Search of the recording.
    part : Candidate
        Structure of the named effects.

    Returns
    -------
    bool
    """
    return bool(
        part.fit.terms
        and part.fit.independent_share == 1.0
        and part.fit.noise.model_error_factor == 1.0
        and search.suffices(part)
    )


def _with_structure(decision: Decision, accepted: Candidate, other: Candidate) -> Decision:
    """Verdict with one of its structures replaced by another.

    Parameters
    ----------
    decision : Decision
    accepted, other : Candidate
        The structure, and the same with freer laws, or without those that it does not need.

    Returns
    -------
    Decision
    """
    best = other if decision.best is accepted else decision.best
    listed = [(other if each is accepted else each, p) for each, p in decision.explanations]
    return replace(decision, best=best, explanations=listed)


def with_other_law(
    search: Search, decision: Decision, accepted: Candidate, naming: Naming
) -> tuple[Decision, Naming] | None:
    """Put a law that stands for its class in the place of those that do not.

    Parameters
    ----------
    search : Search
        Search of the recording.
    decision : Decision
        Verdict and explanations.
    accepted : Candidate
        The structure that it rests on.
    naming : Naming
        Which of its effects may be named.

    Returns
    -------
    (Decision, Naming) or None
        None where no law holds, or something without a name remains beside the laws, or so few
        readings tell no laws apart.
    """
    fitted = accepted.fit
    if not naming.withdrawn or decision.best is not accepted or fitted.independent_share < 1.0:
        return None
    if search.problem.count <= FEW_READINGS:
        return None
    other = with_law_that_holds(search, accepted, naming)
    if other is None:
        return None
    # Where both were listed, the one that fits better stays possible.
    both = {accepted.names, other.part.names}
    shares = sorted((p for c, p in decision.explanations if c.names in both), reverse=True) or [1.0]
    listed = [each for each in decision.explanations if each[0].names not in both]
    listed += zip((other.part, accepted), shares, strict=False)
    listed.sort(key=lambda each: -each[1])
    enough = _is_enough(search, other.part)
    verdict = verdict_by_probability(shares[0]) if enough else "MOSTLY_EXPLAINED"
    return Decision(verdict, other.part, listed, not enough), other


def _with_names_that_hold(
    search: Search, decision: Decision, naming: Naming, share: float
) -> Decision:
    """Change a verdict that rests on laws which do not stand for their classes.

    Parameters
    ----------
    search : Search
        Search of the recording.
    decision : Decision
        The verdict by the evidence of whole structures.
    naming : Naming
        Which effects may be named.
    share : float
        Share of the mismatch that these explain.

    Returns
    -------
    Decision
    """
    few = search.problem.count <= FEW_READINGS
    best = max((p for _, p in decision.explanations), default=0.0)
    # Ambiguous is also what a shape without a name fits as well, which no probability counts.
    sure = best >= SURE_OF_FEW and decision.verdict != "AMBIGUOUS"
    told = not naming.withdrawn and (sure or not naming.names)
    if few and not told:
        return replace(decision, verdict="INSUFFICIENT_DATA", unexplained=False)
    nothing = decision.verdict in NAMING and not naming.names
    too_little = decision.verdict == "MOSTLY_EXPLAINED" and share < MOSTLY
    if not (naming.withdrawn or nothing or too_little):
        return decision
    verdict = verdict_by_share(share if naming.names else 0.0)
    return replace(decision, verdict=verdict, unexplained=True)


def _named_part(search: Search, candidate: Candidate) -> Candidate:
    """Return the structure without the terms that have no name.

    Where these carry the fit, the others alone may err more than no effect at all, and are then
    left out too; and so is a structure that model error made to fit worse than none.

    Parameters
    ----------
    search : Search
        Search of the recording.
    candidate : Candidate
        Structure, perhaps with unnamed shapes.

    Returns
    -------
    Candidate
    """
    found, worst = candidate, MOST_WORSE * search.baseline.fit.rmse_deg
    if not candidate.all_recognised:
        named = [t for t, own in zip(candidate.fit.terms, candidate.recognised, strict=True) if own]
        if not named:
            return search.baseline
        known = search.visited.get(frozenset(t.name for t in named))
        found = known or search.refit(tuple(named), candidate.fit)
        worst = search.baseline.fit.rmse_deg
    return found if found.fit.rmse_deg <= worst else search.baseline
