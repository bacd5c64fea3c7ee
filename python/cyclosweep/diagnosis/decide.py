"""Decision: the verdict that the visited structures allow, and the structure that it rests on."""

from dataclasses import dataclass

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.explained import explained_share
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.testability import Testability, testability
from cyclosweep.diagnosis.identify.verdict import (
    Decision,
    decide,
    decide_in_stages,
    no_more_than_fits,
)
from cyclosweep.diagnosis.refuse import check_compliance, check_positive
from cyclosweep.diagnosis.whole_loop.run_comparison import Repetition, repetition
from cyclosweep.result import Explained

DEFAULT_TOLERANCE = 0.01
"""Size below which an effect does not matter, as a share of the largest elastic twist."""


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
        Verdict and explanations.
    accepted : Candidate
        The named part of the best structure, for sizes, repair and prediction; the baseline where
        nothing was found.
    repetition : Repetition or None
        How far the residual repeats between runs, where it is error of the model.
    beyond_baseline, beyond_accepted : list of Testability
        Bounds of every effect that is not in the baseline, and not in the accepted structure.
    excluded : frozenset of str
        Effects that are ruled out.
    explained : Explained
        Share of the mismatch that the accepted structure explains.
    """

    search: Search
    tolerance_deg: float
    decision: Decision
    accepted: Candidate
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
    if search.baseline.fit.beta[1] <= 0.0:
        check_positive(search.problem.history.compliance_deg_per_nm)
    tolerance = DEFAULT_TOLERANCE * history.largest_twist_deg
    if tolerance_deg is not None:
        tolerance = tolerance_deg
    p_values = {n: search.alarm.p_value(value) for n, value in search.baseline.excesses.items()}
    beyond_baseline = testability(search, search.baseline, p_values)
    repeats = None
    if search.noise.structured:
        repeats = repetition(search.problem, (search.chosen or search.baseline).fit)
    staged: tuple[Candidate, Explained] | None = None
    if search.noise.structured or search.start is not search.baseline:
        found = search.chosen or search.start
        staged = found, explained_share(search.baseline.fit, found.fit, search.seed)
        decision = decide_in_stages(search, staged[1].share or 0.0)
    else:
        decision = decide(search, beyond_baseline, tolerance)
    accepted = search.baseline if decision.best is None else _named_part(search, decision.best)
    check_positive(float(accepted.fit.beta[1]))
    if staged is not None and staged[0] is accepted:
        explained = staged[1]
    else:
        explained = explained_share(search.baseline.fit, accepted.fit, search.seed)
    decision = no_more_than_fits(decision, accepted, search, explained.share or 0.0)
    beyond_accepted = beyond_baseline
    if accepted is not search.baseline:
        beyond_accepted = testability(search, accepted, p_values)
    possible = {term.name for each, _ in decision.explanations for term in each.fit.terms}
    below = {bound.name for bound in beyond_accepted if bound.upper95_deg < tolerance}
    return Conclusion(
        search=search,
        tolerance_deg=tolerance,
        decision=decision,
        accepted=accepted,
        repetition=repeats,
        beyond_baseline=beyond_baseline,
        beyond_accepted=beyond_accepted,
        excluded=frozenset(below - possible),
        explained=explained,
    )


def _named_part(search: Search, candidate: Candidate) -> Candidate:
    """Return the structure without the terms that have no name.

    Where these carry the fit, the others alone may err more than no effect at all, and are then
    left out too.

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
    if candidate.all_recognised:
        return candidate
    named = [t for t, own in zip(candidate.fit.terms, candidate.recognised, strict=True) if own]
    if not named:
        return search.baseline
    found = search.visited.get(frozenset(t.name for t in named)) or search.refit(tuple(named))
    better = found.fit.rmse_deg <= search.baseline.fit.rmse_deg
    return found if better else search.baseline
