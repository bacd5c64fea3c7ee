"""Composition: the answer of a diagnosis from what its stages have found."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.effects_found import (
    classes_shown,
    explanations,
    found_effects,
    tried_effects,
)
from cyclosweep.diagnosis.finish import finished
from cyclosweep.diagnosis.identify.structures.alarm import probability
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import hidden_effects
from cyclosweep.diagnosis.model_error_table import SOMETHING_MISSING, learned_in_words
from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.prepare.torque_noise import smoothed_in_words
from cyclosweep.diagnosis.provenance import provenance_of
from cyclosweep.diagnosis.remainder import remainder
from cyclosweep.diagnosis.repair import RepairedModel
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.diagnosis.whole_loop.one_rate import remark_on_one_rate
from cyclosweep.diagnosis.whole_loop.rig_limits import RIPPLE, rig_limits
from cyclosweep.recording import Recording
from cyclosweep.recording.unbroken_runs import unbroken_runs
from cyclosweep.result import (
    Answer,
    Bound,
    CalibratedParameter,
    DriveChange,
    Finding,
    Mismatch,
    NoiseEstimate,
    Region,
    Repair,
    Sufficiency,
    Thinning,
    Untestable,
    Verdict,
)
from cyclosweep.result.part import finite

MODEL_FILE = "model.json"
EVEN_SPREAD = float(np.sqrt(12.0))
"""Range of an even spread over its standard deviation."""


def compose(
    drive: Drive,
    concluded: Conclusion,
    regions: tuple[Region, ...],
    repaired: RepairedModel,
    verified: Verification,
) -> Diagnosis:
    """Put together what the stages have found.

    Parameters
    ----------
    drive : Drive
        The drive that was diagnosed.
    concluded : Conclusion
        Verdict, accepted structure and bounds.
    regions : tuple of Region
        Where the calibrated model and the recording differ.
    repaired : RepairedModel
        The model before and after the repair.
    verified : Verification
        What data that were not used and synthetic twins say.

    Returns
    -------
    Diagnosis
    """
    search = concluded.search
    recording = search.problem.recording
    answer = _answer(concluded, regions, repaired, verified)
    answer = finished(answer, drive, concluded, verified)
    hidden = tuple(row.name for row in answer.not_testable)
    return Diagnosis(
        recording=recording,
        answer=answer,
        model=repaired.model,
        before_deg=repaired.before_deg,
        after_deg=repaired.after_deg,
        hypotheses=tried_effects(concluded, answer.effects, hidden),
        rated_torque_nm=_rated_torque(drive, recording),
        ratio=float(drive.ratio),
        provenance=provenance_of(recording, drive, search.seed),
    )


def _answer(
    concluded: Conclusion,
    regions: tuple[Region, ...],
    repaired: RepairedModel,
    verified: Verification,
) -> Answer:
    """Fill every part of the answer but the statement and the remarks.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    regions : tuple of Region
        Where the calibrated model fails.
    repaired : RepairedModel
        The model before and after the repair.
    verified : Verification
        What held-out data and synthetic twins say.

    Returns
    -------
    Answer
    """
    recording = concluded.search.problem.recording
    effects = found_effects(concluded, verified.held_out.e_value)
    answer = Answer(
        tolerance_deg=concluded.tolerance_deg,
        verdict=verified.decision.verdict,
        noise=_noise(concluded.search),
        thinning=_thinning(concluded.search.problem, repaired),
        baseline=replace(repaired.before, holdout_rmse_deg=finite(verified.held_out.before_deg)),
        mismatch=_mismatch(concluded.search, regions),
        explained=concluded.explained,
        effects=effects,
        classes=classes_shown(concluded),
        explanation_set=explanations(concluded),
        ruled_out=_bounds(concluded, excluded=True),
        undecided=_bounds(concluded, excluded=False),
        not_testable=_not_testable(concluded),
        sufficiency=_sufficiency(concluded),
        repaired=_repair(repaired, verified),
        self_check=verified.self_check,
        next_experiment=verified.next_experiment,
        model=MODEL_FILE,
        notes=(
            *repaired.model.notes,
            *recording.notes,
            *_ripple(recording, verified.decision.verdict),
            *remark_on_one_rate(recording, [each.name for each in effects]),
            *(() if concluded.search.problem.one_history else unbroken_runs(recording)),
            *(fault.reason for fault in recording.faults),
        ),
        unknown=remainder(concluded, verified, regions),
        stationary=verified.drift is None and verified.change is None,
        drift=verified.drift,
        change=verified.change,
        findings=_findings(concluded, repaired, verified),
    )
    if verified.change is not None:
        answer = _with_range(answer, verified.change)
    return answer


def _ripple(recording: Recording, verdict: Verdict) -> tuple[str, ...]:
    """Remark on what a torque from a current looks like, where something was found."""
    by_current = recording.torque_from == "motor-current"
    return (RIPPLE,) if by_current and verdict in SOMETHING_MISSING else ()


def _with_range(answer: Answer, change: DriveChange) -> Answer:
    """Widen the standard errors of the compliance by the range over which it moved.

    Parameters
    ----------
    answer : Answer
        With the calibrated parameters.
    change : DriveChange
        Compliance early and late.

    Returns
    -------
    Answer
    """
    early, late = change.compliance_early_deg_per_nm, change.compliance_late_deg_per_nm
    moved = 2.0 * abs(late - early) / (late + early) / EVEN_SPREAD

    def widened(parameters: Mapping[str, CalibratedParameter]) -> Mapping[str, CalibratedParameter]:
        found = dict(parameters)
        for name in ("compliance_scale", "compliance_deg_per_nm"):
            value = found[name]
            error = float(np.hypot(value.std_error or 0.0, moved * value.estimate))
            found[name] = replace(value, std_error=error)
        return found

    before, after = answer.baseline, answer.repaired
    return replace(
        answer,
        baseline=replace(before, parameters=widened(before.parameters)),
        repaired=replace(after, parameters=widened(after.parameters)),
    )


def _noise(search: Search) -> NoiseEstimate:
    """Noise of the recording, by the likeliest estimate of its autocorrelation."""
    noise = search.noise
    slow = 1.0 - noise.likely_white_share
    return NoiseEstimate(
        sigma_deg=noise.likely_spread_deg,
        autocorrelation=slow * noise.best_correlation,
        autocorrelation_upper=None if noise.structured else slow * noise.correlation,
        white_share=noise.likely_white_share or None,
        tail_degrees_of_freedom=finite(noise.tail),
        resolution_deg=search.problem.resolution_deg,
        torque_nm=search.problem.torque_noise_nm,
    )


def _thinning(problem: Problem, repaired: RepairedModel) -> Thinning | None:
    """How the recording was thinned; None where it was not.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    repaired : RepairedModel
        The model whose error at the samples shows their noise.

    Returns
    -------
    Thinning or None
    """
    rows, angle = problem.rows, problem.recording.angle_deg
    if not rows.thinned or angle is None:
        return None
    sigma, correlation = rows.scatter(angle - repaired.after_deg, problem.fitted)
    return Thinning(
        samples=len(rows.row),
        rows=len(rows),
        averaged=rows.averaged,
        every=rows.every,
        sample_sigma_deg=finite(sigma),
        sample_autocorrelation=finite(correlation),
    )


def _mismatch(search: Search, regions: tuple[Region, ...]) -> Mismatch:
    """Global test of the calibrated published model.

    Parameters
    ----------
    search : Search
        Search of the recording.
    regions : tuple of Region
        Where the calibrated model fails.

    Returns
    -------
    Mismatch
    """
    left = search.baseline.largest_excess
    return Mismatch(
        p_value=search.alarm.p_value(left),
        evidence=left,
        threshold=search.threshold,
        regions=regions,
    )


def _bounds(concluded: Conclusion, *, excluded: bool) -> tuple[Bound, ...]:
    """Upper bounds of the effects that are ruled out, or of those that are not.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    excluded : bool
        Bounds of the effects below the tolerance; else of those that may be above it.

    Returns
    -------
    tuple of Bound
    """
    return tuple(
        Bound(name=bound.name, upper95_deg=bound.upper95_deg)
        for bound in concluded.beyond_accepted
        if (bound.name in concluded.excluded) is excluded
    )


def _not_testable(concluded: Conclusion) -> tuple[Untestable, ...]:
    """What the recording cannot show, by calibration and by its rig."""
    rows = hidden_effects(concluded.search)
    if concluded.search.noise.structured or concluded.search.chosen is not None:
        rows += rig_limits(concluded.search.problem)
    if concluded.accepted.fit.torque_zero is not None:
        rows = [row for row in rows if row.name != "torque_offset"]
    found = set(concluded.accepted.fit.names)
    return tuple(row for row in rows if row.name not in found)


def _sufficiency(concluded: Conclusion) -> Sufficiency:
    """Whether the best structure leaves anything beyond noise, or anything that repeats."""
    repeats = concluded.repetition
    if repeats is not None:
        return Sufficiency(residual_repeats_between_runs=repeats.correlation, cells=repeats.cells)
    best = concluded.best
    return Sufficiency(p_value=probability(concluded.search.null(best), best.largest_excess))


def _repair(repaired: RepairedModel, verified: Verification) -> Repair:
    """Parameters and errors of the repaired model.

    Parameters
    ----------
    repaired : RepairedModel
        The model before and after the repair.
    verified : Verification
        What held-out data and synthetic twins say.

    Returns
    -------
    Repair
    """
    held = verified.held_out
    return Repair(
        parameters=repaired.after.parameters,
        rmse_deg=repaired.after.rmse_deg,
        holdout_rmse_deg=finite(held.after_deg),
        holdout=held.label,
        blocks=held.blocks,
        stand_ins=repaired.stand_ins,
        model_error=repaired.learned,
    )


def _findings(
    concluded: Conclusion, repaired: RepairedModel, verified: Verification
) -> tuple[Finding, ...]:
    """What the measured loops show.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    repaired : RepairedModel
        The model before and after the repair.
    verified : Verification
        What held-out data and synthetic twins say.

    Returns
    -------
    tuple of Finding
    """
    unsteady = verified.drift is not None
    found = list(concluded.accepted.fit.findings(concluded.repetition, unsteady=unsteady))
    problem = concluded.search.problem
    if problem.torque_noise_nm > 0.0:
        said = smoothed_in_words(problem.torque_noise_nm, problem.rows.averaged)
        found.append(Finding(topic="torque noise", text=said))
    if repaired.learned is not None:
        found.append(Finding(topic="model error", text=learned_in_words(repaired.learned)))
    return tuple(found)


def _rated_torque(drive: Drive, recording: Recording) -> float:
    """Rated torque at the measured shaft [N m].

    Parameters
    ----------
    drive : Drive
        The drive.
    recording : Recording
        Says at which shaft was measured.

    Returns
    -------
    float
        In N m.
    """
    at_input = recording.side == "input"
    return float(drive.nominal_torque_nm if at_input else drive.output_torque_nm)
