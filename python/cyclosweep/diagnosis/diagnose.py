"""The diagnosis from beginning to end: prepare, calibrate, search, prove, say."""

from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis import refuse as fault
from cyclosweep.diagnosis import statement as words
from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.hypotheses.library import Library, build_library
from cyclosweep.diagnosis.identify.alarm import DRAWS, probability
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.testability import (
    Testability,
    hidden_effects,
    size_of,
    spread_of_size,
    testability,
)
from cyclosweep.diagnosis.identify.verdict import Decision, decide, decide_whole_loop
from cyclosweep.diagnosis.locate import Region, find_regions
from cyclosweep.diagnosis.prepare.noise import Noise, estimate_noise, orthonormal
from cyclosweep.diagnosis.prepare.problem import Problem, prepare
from cyclosweep.diagnosis.result import SCHEMA, Diagnosis
from cyclosweep.diagnosis.statement import statement
from cyclosweep.diagnosis.verify.experiment import next_experiment
from cyclosweep.diagnosis.verify.holdout import HeldOutResult, judge_left_out
from cyclosweep.diagnosis.verify.self_check import self_check
from cyclosweep.diagnosis.whole_loop import run_comparison, stepwise
from cyclosweep.diagnosis.whole_loop.findings import limits_of
from cyclosweep.errors import InputError
from cyclosweep.recording import Recording
from cyclosweep.report import HeldOut, Hypothesis
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.effects import effects as all_effects
from cyclosweep.simulation.effects.history import History

Progress = Callable[[str], None]

FEWEST_ROWS = 6
"""Fewer readings in contact than this cannot even calibrate the baseline."""
RESTARTS = 2
"""Times the search starts over because the noise turned out to be another."""


def diagnose(
    recording: Recording,
    drive: Drive | None = None,
    *,
    tolerance_deg: float | None = None,
    seed: int = 0,
    full: bool = True,
    without: Collection[str] = (),
    progress: Progress | None = None,
) -> Diagnosis:
    """Locate where recording and simulation differ, name what is missing, model and verify it.

    Parameters
    ----------
    recording : Recording
        Measured torque and twist.
    drive : Drive, optional
        The drive; default: the one named in the recording's metadata.
    tolerance_deg : float, optional
        Size below which an effect does not matter [deg]; default 1 % of the largest elastic twist.
    seed : int
        Seed of every random draw; equal seeds give equal results.
    full : bool
        False leaves out the held-out proof, the self-check and the next experiment.
    without : collection of str
        Effects that are not considered, as if nobody had listed them.
    progress : callable, optional
        Called with a few words before each long step.

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError
        The recording has no angle, no drive is known, or ``without`` names no effect.
    """
    say: Progress = progress if progress is not None else _silent
    if recording.angle_deg is None:
        raise InputError(
            f"{recording.path or recording.name}: column angle_deg: missing, "
            "expected in a recording"
        )
    drive = drive if drive is not None else _drive_of(recording)
    forced = recording.blocking_fault
    if forced is not None:
        return fault.refuse(recording, drive, str(forced.verdict), forced.reason, seed)
    say("preparing")
    line = drive.nominal_line(recording.side)
    problem = prepare(recording, line, int(drive.output_pin_count))
    refusal = fault.check(problem, drive, FEWEST_ROWS)
    if refusal is not None:
        return fault.refuse(recording, drive, *refusal, seed)
    library = build_library(problem.history, problem.fitted, _considered(without))
    search = _search(problem, library, seed, say)
    return _conclude(search, drive, tolerance_deg, full, say)


def _considered(without: Collection[str]) -> tuple[Effect, ...]:
    known = all_effects()
    names = {effect.name for effect in known}
    for name in without:
        if name not in names:
            raise InputError(f"without: found {name!r}, expected one of {', '.join(sorted(names))}")
    return tuple(effect for effect in known if effect.name not in without)


def _silent(text: str) -> None:
    """Say nothing."""


def _drive_of(recording: Recording) -> Drive:
    if recording.drive is None:
        raise InputError(f"{recording.name}: drive: missing, expected in the metadata or as option")
    beside = None if recording.path is None else Path(recording.path).parent
    return Drive.load(recording.drive, beside)


def _noise(problem: Problem, library: Library, best: Candidate | None) -> Noise:
    """Noise that a rich model leaves, with the accepted structure in it."""
    use = problem.fitted
    extra = None
    if best is not None:
        fitted = best.fit
        extra = np.column_stack(
            [fitted.history.elastic_nm[use]]
            + [term.columns(fitted.history)[use] for term in fitted.terms]
        )
    rich = flexible_basis(problem, library, extra)
    resolution = problem.resolution_deg
    return estimate_noise(
        problem.angle_deg[use], rich, problem.gap[use], resolution, problem.weight[use]
    )


def _search(problem: Problem, library: Library, seed: int, say: Progress) -> Search:
    """Search, and start over from nothing whenever the noise turns out to be another."""
    noise = _noise(problem, library, None)
    search = Search(problem, noise, library, seed)
    if noise.structured:
        say("adding effects one at a time")
        search.chosen = stepwise.choose_effects(search)
        return search
    for _ in range(RESTARTS):
        search.run(say)
        best = search.best()
        if best is None:
            return search
        again = _noise(problem, library, best)
        same = abs(again.correlation - noise.correlation) < 0.04
        same &= abs(np.log(again.sigma_deg / noise.sigma_deg)) < 0.04
        if same:
            return search
        say("starting over with better-known noise")
        noise = again
        search = Search(problem, noise, library, seed)
    search.run(say)
    return search


def _conclude(
    search: Search, drive: Drive, tolerance_deg: float | None, full: bool, say: Progress
) -> Diagnosis:
    """Turn the visited structures into verdict, tables and model."""
    problem, noise = search.problem, search.noise
    base = search.baseline.fit
    twist = base.history.largest_twist_deg
    tolerance = 0.01 * twist if tolerance_deg is None else tolerance_deg
    late = fault.check_compliance(problem, drive, base.history.compliance_deg_per_nm)
    if late is not None:
        return fault.refuse(problem.recording, drive, *late, search.seed)
    say("bounding what was not found")
    p_of = {name: search.alarm.p_value(value) for name, value in search.baseline.excesses.items()}
    bounds = testability(search, search.baseline, p_of)
    decision = decide(search, bounds, tolerance)
    repeats = None
    if noise.structured:
        top = search.chosen or search.baseline
        repeats = run_comparison.repetition(problem, top.fit)
        decision = decide_whole_loop(search.chosen, repeats=repeats.is_physics)
    candidate = decision.best if decision.best is not None else search.baseline
    accepted = _named_part(search, candidate)
    remaining = bounds if accepted is search.baseline else testability(search, accepted, p_of)
    possible = {t.name for n, _ in decision.explanations for t in n.fit.terms}
    excluded = {b.name for b in remaining if b.upper95_deg < tolerance} - possible
    regions = (
        find_regions(search, search.baseline)
        if search.baseline.largest_excess >= search.threshold
        else []
    )
    if decision.verdict == "UNKNOWN_PHYSICS" and accepted.fit.terms:
        regions = find_regions(search, accepted) or regions
    held = judge_left_out(accepted.fit) if full else HeldOutResult((), 0.0, 0.0, 1.0, "")
    drift = _drift(problem, accepted.fit, held) if noise.structured else None
    if drift is not None:
        decision = Decision("UNKNOWN_PHYSICS", decision.best, decision.explanations, True)
    effects = [_effect(search, accepted, k, held) for k in range(len(accepted.fit.terms))]
    sufficiency = probability(search.null(candidate), candidate.largest_excess)
    model = accepted.fit.model(drive.name)
    before = accepted.fit.baseline_prediction(base)
    after = accepted.fit.prediction
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "tolerance_deg": tolerance,
        "verdict": decision.verdict,
        "statement": "",
        "noise": {
            "sigma_deg": noise.spread_deg,
            "autocorrelation": noise.best_correlation,
            "autocorrelation_upper": noise.correlation,
            "tail_degrees_of_freedom": noise.tail,
            "resolution_deg": problem.resolution_deg,
        },
        "baseline": {
            "parameters": parameters_of(base, problem),
            "rmse_deg": before.error_deg,
            "holdout_rmse_deg": held.before_deg,
        },
        "mismatch": {
            "p_value": search.alarm.p_value(search.baseline.largest_excess),
            "evidence": search.baseline.largest_excess,
            "threshold": search.threshold,
            "regions": [region.as_dict() for region in regions],
        },
        "effects": effects,
        "explanation_set": [_explanation(n, p) for n, p in decision.explanations],
        "ruled_out": [
            {"name": b.name, "upper95_deg": b.upper95_deg} for b in remaining if b.name in excluded
        ],
        "undecided": [
            {"name": b.name, "upper95_deg": b.upper95_deg}
            for b in remaining
            if b.name not in excluded
        ],
        "not_testable": hidden_effects(search),
        "sufficiency": {"p_value": sufficiency},
        "repaired": {
            "parameters": parameters_of(accepted.fit, problem),
            "rmse_deg": after.error_deg,
            "holdout_rmse_deg": held.after_deg,
            "holdout": held.label,
            "blocks": [block.as_dict() for block in held.blocks],
        },
        "self_check": {},
        "next_experiment": {},
        "model": "model.json",
        "notes": [*problem.recording.notes, *[f.reason for f in problem.recording.faults]],
    }
    if repeats is not None:
        content["sufficiency"] = {
            "p_value": None,
            "residual_repeats_between_runs": repeats.correlation,
            "cells": repeats.cells,
        }
    if decision.unexplained and decision.best is not None:
        content["unknown"] = _unknown(search, decision, accepted, regions)
        if drift is not None:
            size = {"shape": "drift", "place": "from run to run", "size_deg": drift.other_deg}
            content["unknown"] |= size
        elif repeats is not None:
            content["unknown"] |= _staircase(accepted, repeats)
    if full:
        say("checking on synthetic twins")
        rivals = [n for n, _ in decision.explanations if n is not decision.best][:2]
        content["self_check"] = self_check(search, decision.best, rivals)
        say("choosing the next experiment")
        content["next_experiment"] = _experiment(search, decision, bounds, tolerance)
    content["stationary"] = drift is None
    content["statement"] = _statement(search, decision, content, regions, bounds, tolerance, drift)
    content["statement"] += words.forecast(content["repaired"]["blocks"])
    repeated = None if repeats is None else repeats.correlation
    content["findings"] = accepted.fit.findings(repeated, unsteady=drift is not None)
    if noise.structured:
        content["not_testable"] += limits_of(problem, drive)
        if accepted.fit.torque_zero is not None:
            content["not_testable"] = [
                row for row in content["not_testable"] if row["name"] != "torque_offset"
            ]
    return Diagnosis(
        recording=problem.recording,
        content=content,
        model=model,
        before_deg=_at_samples(problem, before.angle_deg, base.history),
        after_deg=_at_samples(problem, after.angle_deg, accepted.fit.history),
        hypotheses=_hypotheses(effects, remaining, content["not_testable"], excluded, bounds),
        held_out=tuple(
            HeldOut(
                block=b.label,
                samples=b.samples,
                rmse_before_deg=b.before_deg,
                rmse_after_deg=b.after_deg,
                **({"floor_deg": noise.spread_deg} | b.beside_forecast()),
            )
            for b in held.blocks
        ),
        rated_torque_nm=_rated(drive, problem.recording),
        ratio=float(drive.ratio),
        provenance=fault.provenance(problem.recording, drive, search.seed),
    )


def _drift(
    problem: Problem, fitted: FittedStructure, held: HeldOutResult
) -> run_comparison.Steadiness | None:
    """How far a model of some runs fails on others, where that is far more than on its own."""
    span = float(np.ptp(problem.angle_deg))
    pairs = [(fitted.prediction.error_deg, held.after_deg), *fitted.run_to_run_errors()]
    found = [run_comparison.Steadiness(own, other) for own, other in pairs]
    drifts = [each for each in found if each.is_drift(span)]
    return max(drifts, key=lambda each: each.other_deg / each.own_deg, default=None)


def _rated(drive: Drive, recording: Recording) -> float:
    at_input = recording.side == "input"
    return float(drive.nominal_torque_nm if at_input else drive.output_torque_nm)


def _named_part(search: Search, candidate: Candidate) -> Candidate:
    """Return the structure without its nameless terms, for sizes, repair and prediction."""
    if candidate.all_recognised:
        return candidate
    named = [t for t, own in zip(candidate.fit.terms, candidate.recognised, strict=True) if own]
    if not named:
        return search.baseline
    known = search.visited.get(frozenset(t.name for t in named))
    return known if known is not None else search.refit(tuple(named))


def _effect(
    search: Search, candidate: Candidate, index: int, held: HeldOutResult
) -> dict[str, Any]:
    """Entry of one accepted effect."""
    fitted = candidate.fit
    term = fitted.terms[index]
    effect = term.effect
    assert effect is not None
    shape = size_of(fitted, index)
    size = float(np.max(np.abs(shape), initial=0.0))
    strength = _strength(search, candidate, index)
    if fitted.follows_path(index):
        spread = size / max(strength, 1e-9)
    else:
        spread = spread_of_size(fitted, index)
    parent = search.visited.get(candidate.names - {term.name})
    if parent is None and len(candidate.fit.terms) == 1:
        parent = search.baseline
    p = 1.0 / (DRAWS + 1)
    if parent is not None:
        p = search.alarm.p_value(parent.excesses.get(term.name, 0.0))
    return {
        "name": term.name,
        "physics": effect.physics,
        "source": effect.source,
        "parameters": _parameters(fitted, index),
        "size_deg": {
            "estimate": size,
            "ci95": [max(size - 1.96 * spread, 0.0), size + 1.96 * spread],
        },
        "size_arcmin": 60.0 * size,
        "size_nm": size / fitted.history.compliance_deg_per_nm,
        "rms_deg": float(np.sqrt(np.mean(shape**2))),
        "p_value": p,
        "e_value": held.e_value,
        "detectability": strength,
    }


def _strength(search: Search, candidate: Candidate, index: int) -> float:
    """Projected signal-to-noise of a term, the other terms and the calibration taken out."""
    use = search.problem.fitted
    fitted = candidate.fit
    _, weight = search.noise.residual(search.problem.angle_deg[use], fitted.mean_deg[use])
    signal = search.noise.design(fitted.contribution(index)[use], weight)
    keep = list(range(search.problem.line_columns))
    for k, term in enumerate(fitted.terms):
        if k != index and not term.slips:
            keep += fitted.amplitude_places(k)
    for k, nonlinear in enumerate(fitted.fit_parameters):
        if nonlinear.term != index:
            keep.append(len(fitted.beta) + k)
    rest = orthonormal(fitted.sensitivity[:, keep], 1e-8)
    left = signal - rest @ (rest.T @ signal)
    return float(np.linalg.norm(left)) * float(np.sqrt(fitted.independent_share))


def _parameters(fitted: FittedStructure, index: int) -> dict[str, dict[str, Any]]:
    """Amplitudes and shape parameters of a term with standard errors."""
    term = fitted.terms[index]
    assert term.effect is not None
    spread = np.sqrt(np.maximum(np.diag(fitted.covariance), 0.0))
    out: dict[str, dict[str, Any]] = {}
    amplitudes = term.effect.amplitudes(term.shape)
    if not term.slips:
        for parameter, place in zip(amplitudes, fitted.amplitude_places(index), strict=False):
            out[parameter.name] = {
                "estimate": fitted.beta[place],
                "std_error": spread[place],
                "unit": parameter.unit,
                "meaning": parameter.meaning,
            }
    for k, nonlinear in enumerate(fitted.fit_parameters):
        if nonlinear.term != index:
            continue
        error = float(spread[len(fitted.beta) + k])
        name, value = nonlinear.name, term.amplitude
        if nonlinear.name == "amplitude":
            name = amplitudes[0].name
        else:
            value = float(term.shape[nonlinear.name])
        if nonlinear.quantity.logarithmic:
            error *= value
        out[name] = {
            "estimate": value,
            "std_error": error,
            "unit": nonlinear.quantity.unit,
            "meaning": nonlinear.quantity.meaning,
        }
    return out


def parameters_of(fitted: FittedStructure, problem: Problem) -> dict[str, dict[str, Any]]:
    """Baseline parameters of a fit against nominal."""
    spread = fitted.line_errors
    nominal = problem.nominal_compliance
    compliance = float(fitted.beta[1])
    out: dict[str, dict[str, Any]] = {
        "compliance_scale": {
            "nominal": 1.0,
            "estimate": compliance / nominal,
            "std_error": float(spread[1]) / nominal,
            "unit": "",
        },
        "compliance_deg_per_nm": {
            "nominal": nominal,
            "estimate": compliance,
            "std_error": float(spread[1]),
            "unit": "deg/(N m)",
        },
        "free_play_deg": {
            "nominal": problem.nominal_free_play,
            "estimate": fitted.history.free_play_deg,
            "std_error": None if problem.one_sided else float(spread[2]),
            "unit": "deg",
        },
        "datum_deg": {
            "nominal": 0.0,
            "estimate": fitted.history.datum_deg,
            "std_error": float(spread[0]),
            "unit": "deg",
        },
    }
    zero = fitted.torque_zero
    if zero is not None:
        out["torque_zero_nm"] = {
            "nominal": 0.0,
            "estimate": zero.value_nm,
            "std_error": zero.std_error_nm,
            "unit": "N m",
        }
    return out


def _explanation(candidate: Candidate, probability: float) -> dict[str, Any]:
    return {
        "effects": [
            t.name for t, own in zip(candidate.fit.terms, candidate.recognised, strict=True) if own
        ],
        "without_name": [
            t.name if t.effect is None else t.effect.family
            for t, own in zip(candidate.fit.terms, candidate.recognised, strict=True)
            if not own
        ],
        "probability": probability,
    }


def _unknown(
    search: Search, decision: Decision, accepted: Candidate, regions: list[Region]
) -> dict[str, Any]:
    """Shape, place and size of what has no name."""
    candidate = decision.best
    assert candidate is not None
    forms = [(k, t) for k, t in enumerate(candidate.fit.terms) if t.unnamed is not None]
    if forms:
        index, term = forms[0]
        assert term.unnamed is not None
        shape = size_of(candidate.fit, index)
        return {
            "shape": term.unnamed.family,
            "place": term.unnamed.place,
            "size_deg": float(np.max(np.abs(shape))),
        }
    lost = [k for k, own in enumerate(candidate.recognised) if not own]
    if lost:
        effect = candidate.fit.terms[lost[0]].effect
        assert effect is not None
        largest = float(np.max(np.abs(size_of(candidate.fit, lost[0]))))
        return {"shape": effect.family, "place": "all along", "size_deg": largest}
    values = candidate.excesses
    wave = candidate.sinusoid[1]
    name = max(values, key=lambda key: values[key])
    place = wave.place if wave is not None and wave.family == name else ""
    if name in candidate.scan.groups:
        found = candidate.scan.library.signatures[candidate.scan.best_signature(name)]
        place = found.unnamed.place if found.unnamed is not None else "all along"
    size = max((abs(r.mean_residual_deg) for r in regions), default=accepted.fit.rmse_deg)
    return {"shape": name, "place": place, "size_deg": size}


def _staircase(candidate: Candidate, repeats: run_comparison.Repetition) -> dict[str, Any]:
    """Describe a residual that repeats from run to run, as steps tied to the mesh do."""
    left = (candidate.fit.problem.angle_deg - candidate.fit.mean_deg)[candidate.fit.problem.fitted]
    wave = candidate.sinusoid[1]
    place = f"repeating from run to run (correlation {repeats.correlation:.2f})"
    if wave is not None and candidate.sinusoid[0] > 5.0:
        place += f", strongest {wave.place}"
    return {
        "shape": "staircase tied to the position of the mesh",
        "place": place,
        "size_deg": float(np.quantile(np.abs(left), 0.95)),
    }


def _experiment(
    search: Search, decision: Decision, bounds: list[Testability], tolerance: float
) -> dict[str, object]:
    rivals = [candidate for candidate, _ in decision.explanations]
    if decision.verdict not in ("AMBIGUOUS", "IDENTIFIED"):
        rivals = []
    weakest = None
    if decision.verdict == "INSUFFICIENT_DATA" and bounds:
        weakest = max(bounds, key=lambda b: b.upper95_deg).name
    elif decision.verdict == "UNKNOWN_PHYSICS":
        weakest = "friction_hysteresis"
    return next_experiment(search, rivals, weakest, tolerance)


def _statement(
    search: Search,
    decision: Decision,
    content: dict[str, Any],
    regions: list[Region],
    bounds: list[Testability],
    tolerance: float,
    drift: run_comparison.Steadiness | None,
) -> str:
    unknown = content.get("unknown")
    remains = ""
    if unknown:
        remains = f"a {unknown['shape']} of {unknown['size_deg']:.2g} deg, {unknown['place']}"
    repaired = content["repaired"]
    if drift is not None:
        remains = "a drift from run to run"
    numbers = {
        "drift": None if drift is None else (drift.own_deg, drift.other_deg),
        "sigma": search.noise.spread_deg,
        "tolerance": tolerance,
        "largest_bound": max((b.upper95_deg for b in bounds), default=0.0),
        "open": [
            b.name
            for b in sorted(bounds, key=lambda b: -b.upper95_deg)
            if b.upper95_deg >= tolerance
        ],
        "before": content["baseline"]["rmse_deg"],
        "after": repaired["rmse_deg"],
        "held_before": content["baseline"]["holdout_rmse_deg"],
        "held_after": repaired["holdout_rmse_deg"],
        "remains": remains,
    }
    return statement(
        decision.verdict,
        content["effects"],
        content["explanation_set"],
        regions,
        repaired["parameters"],
        numbers,
    )


def _at_samples(problem: Problem, angle_deg: np.ndarray, history: History) -> np.ndarray:
    """Twist given by rows, a value for every sample of the recording [deg]."""
    row = problem.rows
    # Within an averaged row the line's own slope carries the torque's deviation from its mean.
    torque = problem.recording.torque_nm - problem.history.applied_nm[row]
    return np.asarray(angle_deg[row] + history.compliance_deg_per_nm * torque)


def _hypotheses(
    effects: list[dict[str, Any]],
    remaining: list[Testability],
    hidden: list[dict[str, str]],
    excluded: Collection[str],
    bounds: list[Testability],
) -> tuple[Hypothesis, ...]:
    known = {b.name: b for b in bounds}
    rows = []
    for effect in effects:
        at_start = known.get(effect["name"])
        rows.append(
            Hypothesis(
                name=effect["name"],
                outcome="accepted",
                absorbed_share=None if at_start is None else at_start.absorbed_share,
                size_deg=effect["size_deg"]["estimate"],
                ci95_deg=tuple(effect["size_deg"]["ci95"]),
                p_value=effect["p_value"],
                e_value=effect["e_value"],
                smallest_detectable_deg=None
                if at_start is None
                else at_start.smallest_detectable_deg,
            )
        )
    for bound in remaining:
        rows.append(
            Hypothesis(
                name=bound.name,
                outcome="ruled out" if bound.name in excluded else "undecided",
                absorbed_share=bound.absorbed_share,
                size_deg=bound.estimate_deg,
                ci95_deg=(0.0, bound.upper95_deg),
                p_value=bound.p_value,
                smallest_detectable_deg=bound.smallest_detectable_deg,
            )
        )
    rows += [Hypothesis(name=entry["name"], outcome="not testable") for entry in hidden]
    return tuple(rows)
