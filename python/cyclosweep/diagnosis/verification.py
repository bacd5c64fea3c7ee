"""Verification: data that were not used, synthetic twins, and what to record next."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.change import find_change
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.hypotheses.behaviour_classes import RUN_COMPLIANCE, RUN_PLAY
from cyclosweep.diagnosis.identify.laws.class_check import candidates_of
from cyclosweep.diagnosis.identify.structures.verdict import Decision, verdict_by_share
from cyclosweep.diagnosis.verify.experiment import next_experiment
from cyclosweep.diagnosis.verify.holdout import HeldOutResult, judge_left_out
from cyclosweep.diagnosis.verify.self_check import self_check
from cyclosweep.diagnosis.whole_loop.run_comparison import Steadiness
from cyclosweep.recording.robust import rounding_sigma
from cyclosweep.result import DriveChange, NextExperiment, RunToRunDrift, SelfCheck

NOTHING_HELD_OUT = HeldOutResult((), np.nan, np.nan, np.nan, "")
MOST_RIVALS = 2
"""Other explanations of which synthetic twins are made."""
ONCE_MORE = (
    "the same programme once more, unchanged: what remains belongs to no listed effect, and "
    "whether it repeats at the same torques and positions decides whether it is the drive's"
)
"""Next experiment where no effect of the vocabulary is left to be shown or ruled out."""
SETTLE = (
    "the same programme once more after the drive has settled: repeat loops until two in a row "
    "agree, then record"
)
"""Next experiment where the drive changed while it was tested."""
READ_FINER = (
    "the same programme once more, the angle read in steps finer than {step:.3g} deg: what remains "
    "is about as large as rounding to these steps, which repeats whenever the programme does"
)
"""Next experiment where the rounding of the angle may be all that is left."""
OF_ROUNDING = 1.25
"""Largest error, over that of readings rounded to even steps, that is about as large as it."""
CHANGED_BY_RUN = frozenset({RUN_COMPLIANCE, RUN_PLAY})
"""Classes of behaviour by which the drive is another one in each run."""


@dataclass(frozen=True, eq=False)
class Verification:
    """Whether the accepted structure holds.

    Attributes
    ----------
    decision : Decision
        The verdict that is reported: that of the fit, changed where the drive was not the same in
        all runs.
    held_out : HeldOutResult
        Errors on data that were not fitted.
    drift : RunToRunDrift or None
        How far a model of some runs fails on others, where the drive changed between them.
    change : DriveChange or None
        How far the compliance moved over the recording, where it did.
    self_check : SelfCheck or None
        Rates on synthetic twins; None where they were not asked for.
    next_experiment : NextExperiment or None
        What to record next; None where it was not asked for.
    """

    decision: Decision
    held_out: HeldOutResult
    drift: RunToRunDrift | None
    change: DriveChange | None
    self_check: SelfCheck | None
    next_experiment: NextExperiment | None


def verify(concluded: Conclusion, *, full: bool, say: Callable[[str], None]) -> Verification:
    """Try the accepted structure on data that were not used, and on synthetic twins.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    full : bool
        False looks for a drift between the runs alone.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Verification
    """
    held = judge_left_out(concluded.accepted.fit) if full else NOTHING_HELD_OUT
    drift = None
    if concluded.search.noise.structured:
        # The verdict rests on it, so that runs held out are forecast for it in any case.
        forecast = full or not concluded.search.problem.held_out.any()
        drift = _drift(concluded, held if forecast else judge_left_out(concluded.accepted.fit))
    decision = concluded.decision
    change = find_change(concluded)
    if drift is not None:
        decision = replace(decision, verdict="UNKNOWN_PHYSICS", unexplained=True)
    elif change is not None:
        decision = _of_changed_drive(concluded)
    if not full:
        return Verification(decision, held, drift, change, None, None)
    say("checking on synthetic twins")
    checked = _self_check(concluded)
    say("choosing the next experiment")
    by_run = any(each.behaviour in CHANGED_BY_RUN for each in concluded.naming.shown)
    if drift is not None or change is not None or (by_run and decision.unexplained):
        following = NextExperiment(program=SETTLE)
    else:
        following = _next_experiment(concluded, decision)
    return Verification(decision, held, drift, change, checked, following)


def _of_changed_drive(concluded: Conclusion) -> Decision:
    """Verdict where the drive changed: named effects explain most of it at best."""
    share = (concluded.explained.share or 0.0) if concluded.naming.names else 0.0
    return replace(concluded.decision, verdict=verdict_by_share(share), unexplained=True)


def _drift(concluded: Conclusion, held: HeldOutResult) -> RunToRunDrift | None:
    """Find the pair of runs on which a model of one fails most on the other.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    held : HeldOutResult
        Errors on held-out data.

    Returns
    -------
    RunToRunDrift or None
        None where the runs agree.
    """
    fitted = concluded.accepted.fit
    span = float(np.ptp(concluded.search.problem.angle_deg))
    pairs = [(fitted.prediction.error_deg, held.after_deg), *fitted.run_to_run_errors()]
    compared = [Steadiness(own, other) for own, other in pairs]
    drifts = [each for each in compared if each.is_drift(span)]
    worst = max(drifts, key=lambda each: each.other_deg / each.own_deg, default=None)
    return (
        None if worst is None else RunToRunDrift(own_deg=worst.own_deg, other_deg=worst.other_deg)
    )


def _self_check(concluded: Conclusion) -> SelfCheck:
    """Rates on twins with nothing, with the best structure, and with its rivals."""
    decision = concluded.decision
    rivals = [each for each, _ in decision.explanations if each is not decision.best]
    return self_check(concluded.search, decision.best, rivals[:MOST_RIVALS])


def _next_experiment(concluded: Conclusion, decision: Decision) -> NextExperiment:
    """Programme that separates the explanations, or shows the effect that is least bounded.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    decision : Decision
        Verdict and the explanations it rests on.

    Returns
    -------
    NextExperiment
    """
    rivals = [each for each, _ in decision.explanations]
    if decision.verdict not in ("AMBIGUOUS", "IDENTIFIED"):
        rivals = []
    weakest = None
    bounds = concluded.beyond_baseline
    if decision.verdict == "INSUFFICIENT_DATA" and bounds:
        weakest = max(bounds, key=lambda bound: bound.upper95_deg).name
    elif decision.verdict in ("UNKNOWN_PHYSICS", "MOSTLY_EXPLAINED"):
        step = concluded.search.problem.recording.angle_resolution_deg
        if concluded.accepted.fit.rmse_deg <= OF_ROUNDING * rounding_sigma(step):
            return NextExperiment(program=READ_FINER.format(step=step))
        weakest = _least_known(concluded)
        if weakest is None:
            return NextExperiment(program=ONCE_MORE)
    return next_experiment(concluded.search, rivals, weakest, concluded.tolerance_deg)


def _least_known(concluded: Conclusion) -> str | None:
    """Effect to show or rule out where something has no name; none of those that are named.

    Those of a class of behaviour that the recording shows come first, then the one that may be
    largest.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.

    Returns
    -------
    str or None
        None where every effect is named or ruled out.
    """
    naming = concluded.naming
    open_bounds = {
        bound.name: bound.upper95_deg
        for bound in concluded.beyond_accepted
        if bound.name not in concluded.excluded and bound.name not in naming.names
    }
    alike = {
        name
        for each in naming.shown
        for name in candidates_of(each.behaviour, concluded.search.library)
    }
    first = {name: bound for name, bound in open_bounds.items() if name in alike} or open_bounds
    return max(first, key=lambda name: first[name], default=None)
