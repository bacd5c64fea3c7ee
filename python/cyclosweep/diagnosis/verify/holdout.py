"""Errors of baseline and repaired model on data that were not fitted, and their evidence."""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.prediction import LeftOutPrediction
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.verify.kept_runs import kept_runs_in_words
from cyclosweep.result import HeldOutBlock
from cyclosweep.simulation.effects.history import Flags, Floats

REPLICATE = 0.98
"""Correlation of torque from which two runs count as replicates."""


@dataclass(frozen=True, slots=True)
class HeldOutResult:
    """Errors of baseline and repaired model on data not used, and the evidence they give.

    Attributes
    ----------
    blocks : tuple of HeldOutBlock
    before_deg, after_deg : float
        Root mean square over all blocks [deg].
    e_value : float
        At least so many times is the repaired model likelier than the baseline, whatever was
        searched (see `FittedStructure.left_out_evidence`); NaN where nothing was held out.
    label : str
        What was held out.
    missed : str
        Sentence on how kept runs differ from those that were fitted; empty where they do not.
    """

    blocks: tuple[HeldOutBlock, ...]
    before_deg: float
    after_deg: float
    e_value: float
    label: str
    missed: str = ""


def judge_left_out(structure: FittedStructure) -> HeldOutResult:
    """Errors of baseline and structure on rows that were left out of their fits."""
    predictions = structure.predict_left_out()
    if not predictions:
        return HeldOutResult((), np.nan, np.nan, np.nan, "nothing: too few samples")
    blocks = tuple(_block(structure.problem, each) for each in predictions)
    weight = np.array([b.samples for b in blocks], dtype=np.float64)
    before = float(np.sqrt(np.average([b.before_deg**2 for b in blocks], weights=weight)))
    after = float(np.sqrt(np.average([b.after_deg**2 for b in blocks], weights=weight)))
    evidence = structure.left_out_evidence(predictions, before, after)
    label = "; ".join(b.block for b in blocks)
    missed = kept_runs_in_words(structure, predictions)
    return HeldOutResult(blocks, before, after, evidence, label, missed)


def _block(problem: Problem, prediction: LeftOutPrediction) -> HeldOutBlock:
    """Errors on one block, and where the flank is predicted what stands beside them.

    Parameters
    ----------
    problem : Problem
    prediction : LeftOutPrediction

    Returns
    -------
    HeldOutBlock
    """
    rows = prediction.rows
    plain = HeldOutBlock(
        block=prediction.label,
        samples=int(problem.weight[rows].sum()),
        before_deg=problem.rms_error(prediction.baseline_deg, rows),
        after_deg=problem.rms_error(prediction.structure_deg, rows),
    )
    known = prediction.known_flank
    if known is None:
        return plain
    return replace(
        plain,
        told_before_deg=problem.rms_error(known.baseline_deg, known.rows),
        told_after_deg=problem.rms_error(known.structure_deg, known.rows),
        near_before_deg=distance_to_curve(problem, prediction.baseline_deg, rows),
        near_after_deg=distance_to_curve(problem, prediction.structure_deg, rows),
        floor_deg=replicate_floor(problem, rows) if prediction.kept_runs else None,
    )


def distance_to_curve(problem: Problem, angle_deg: Floats, rows: Flags) -> float:
    """Root mean square distance of readings to the predicted curve [deg].

    Torque counts by the chord of the loop, so that a crossing a little too early or too late is a
    small distance.

    Parameters
    ----------
    problem : Problem
    angle_deg : ndarray, shape (n,)
        Predicted twist of all rows [deg].
    rows : ndarray of bool, shape (n,)
        Readings that count.

    Returns
    -------
    float
        In deg.
    """
    torque, measured = problem.history.applied_nm, problem.angle_deg
    chord = float(np.ptp(measured[rows])) / max(float(np.ptp(torque[rows])), 1e-12)
    total, weight = 0.0, 0.0
    run = problem.history.run
    for number in np.unique(run[rows]):
        here = np.flatnonzero(rows & (run == number))
        path = np.flatnonzero(run == number)
        x, y = chord * torque[path], angle_deg[path]
        dx, dy = np.diff(x), np.diff(y)
        size = np.maximum(dx**2 + dy**2, 1e-300)
        for k in here:
            px, py = chord * torque[k], measured[k]
            share = np.clip(((px - x[:-1]) * dx + (py - y[:-1]) * dy) / size, 0.0, 1.0)
            gap = (px - x[:-1] - share * dx) ** 2 + (py - y[:-1] - share * dy) ** 2
            total += float(problem.weight[k]) * float(gap.min(initial=(py - y[0]) ** 2))
            weight += float(problem.weight[k])
    return float(np.sqrt(total / max(weight, 1e-12)))


def replicate_floor(problem: Problem, rows: Flags) -> float | None:
    """Error that the latest fitted run leaves as a prediction of the held-out ones [deg].

    Parameters
    ----------
    problem : Problem
    rows : ndarray of bool, shape (n,)
        Held-out rows.

    Returns
    -------
    float or None
        None where no fitted run followed the same programme.
    """
    run, torque = problem.history.run, problem.history.applied_nm
    known = np.unique(run[problem.whole_fitted])[::-1]
    errors = []
    for number in np.unique(run[rows]):
        mine = np.flatnonzero(rows & (run == number))
        for other in known:
            theirs = np.flatnonzero(problem.whole_fitted & (run == other))
            if len(mine) < 8 or len(theirs) < 8:
                continue
            place = np.linspace(0.0, len(theirs) - 1.0, len(mine))
            at = np.arange(len(theirs))
            if np.corrcoef(np.interp(place, at, torque[theirs]), torque[mine])[0, 1] < REPLICATE:
                continue
            predicted = np.interp(place, at, problem.angle_deg[theirs])
            errors.append((float(np.mean((problem.angle_deg[mine] - predicted) ** 2)), len(mine)))
            break
    if not errors:
        return None
    value, count = np.array(errors).T
    return float(np.sqrt(np.average(value, weights=count)))
