"""Proof on data not used: errors on left-out blocks, and a cross-fit e-value."""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fit import Fit, fit
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.problem import Problem, gaps
from cyclosweep.diagnosis.prepare.split import folds, restrict, whole_stretches
from cyclosweep.diagnosis.whole_loop.forecast import PIECES, refit, rms
from cyclosweep.diagnosis.whole_loop.known_flank import ForecastFit, told_path
from cyclosweep.simulation.effects.history import Flags, Floats

ALIKE = 0.98
"""Correlation of torque from which two runs count as replicates."""


@dataclass(frozen=True, slots=True)
class Block:
    """Errors on one left-out block [deg].

    Attributes
    ----------
    label : str
    samples : int
    before_deg, after_deg : float
        Of the baseline and of the repaired model. For a forecast over all samples, otherwise told
        the flank.
    told_before_deg, told_after_deg : float or None
        Beside a forecast: the same models told the flank, over the samples in contact.
    near_before_deg, near_after_deg : float or None
        Beside a forecast: distance to the measured curve, which a late crossing does not spoil.
    floor_deg : float or None
        What another run, taken as the prediction, leaves.
    """

    label: str
    samples: int
    before_deg: float
    after_deg: float
    told_before_deg: float | None = None
    told_after_deg: float | None = None
    near_before_deg: float | None = None
    near_after_deg: float | None = None
    floor_deg: float | None = None

    def as_dict(self) -> dict[str, str | float]:
        """Entry of ``diagnosis.json``."""
        own: dict[str, str | float] = {
            "block": self.label, "before_deg": self.before_deg, "after_deg": self.after_deg,
        }  # fmt: skip
        return own | {k: v for k, v in self.beside_forecast().items() if v is not None}

    def beside_forecast(self) -> dict[str, float | None]:
        """What stands beside a forecast; empty where the model was told the flank anyway."""
        if self.told_after_deg is None:
            return {}
        return {
            "told_before_deg": self.told_before_deg,
            "told_after_deg": self.told_after_deg,
            "near_before_deg": self.near_before_deg,
            "near_after_deg": self.near_after_deg,
            "floor_deg": self.floor_deg,
        }


@dataclass(frozen=True, slots=True)
class HeldOutResult:
    """Errors of baseline and repaired model on data not used, and the evidence they give.

    Attributes
    ----------
    blocks : tuple of Block
    before_deg, after_deg : float
        Root mean square over all blocks [deg].
    e_value : float
        Average over the blocks of the likelihood ratio between the repaired model, fitted to the
        rest, and the baseline fitted to the block itself: at least so many times likelier, valid
        whatever was searched (universal inference, Wasserman, Ramdas, Balakrishnan, PNAS 2020).
    label : str
        What was held out.
    """

    blocks: tuple[Block, ...]
    before_deg: float
    after_deg: float
    e_value: float
    label: str


def judge(problem: Problem, noise: Noise, model: Fit) -> HeldOutResult:
    """Fit baseline and model without each block, and judge them on it."""
    if isinstance(model, ForecastFit):
        return judge_forecast(problem, model)
    parts = folds(problem)
    declared = bool(np.any(problem.held_out))
    if declared:
        parts = [("the runs kept for it", problem.held_out)]
    blocks: list[Block] = []
    evidence: list[float] = []
    for label, rows in parts:
        if declared:
            train, train_noise = problem, noise
        else:
            train, train_noise = restrict(problem, noise, ~rows)
        if train.count < 6 or not np.any(train.held_out):
            continue
        base = fit(train, train_noise, ())
        repaired = base
        if model.terms:
            repaired = fit(train, train_noise, model.terms, model, rounds=4)
        held = train.held_out
        blocks.append(
            Block(
                label,
                int(problem.weight[held].sum()),
                _error(problem, base.mean_deg, held),
                _error(problem, repaired.mean_deg, held),
            )
        )
        evidence.append(_log_ratio(problem, noise, repaired.mean_deg, held))
    if not blocks:
        return HeldOutResult((), np.nan, np.nan, 1.0, "nothing: too few samples")
    weight = np.array([b.samples for b in blocks], dtype=np.float64)
    before = float(np.sqrt(np.average([b.before_deg**2 for b in blocks], weights=weight)))
    after = float(np.sqrt(np.average([b.after_deg**2 for b in blocks], weights=weight)))
    value = float(np.mean(np.exp(np.minimum(evidence, 200.0)))) if model.terms else 1.0
    label = "; ".join(b.label for b in blocks)
    return HeldOutResult(tuple(blocks), before, after, value, label)


def judge_forecast(problem: Problem, model: ForecastFit) -> HeldOutResult:
    """Judge the forecasts of baseline and model on runs kept for it, or on stretches left out."""
    declared = bool(np.any(problem.whole_held_out))
    parts = whole_stretches(problem)
    if declared:
        parts = [("the runs kept for it", problem.whole_held_out)]
    blocks: list[Block] = []
    for label, rows in parts:
        pair = (model.before, model.forecast)
        if not declared:
            kept = problem.whole_fitted & ~rows
            pair = (
                refit(model.before, rows=kept, most=6),
                refit(model.forecast, rows=kept, most=6),
            )
        contact = rows & (problem.held_out if declared else problem.fitted)
        told = [rms(problem, told_path(problem, f.model).angle_deg, contact) for f in pair]
        near = [distance_to_curve(problem, f.angle_deg, rows) for f in pair]
        free = [rms(problem, f.angle_deg, rows) for f in pair]
        samples = int(problem.weight[rows].sum())
        floor = replicate_floor(problem, rows) if declared else None
        blocks.append(
            Block(
                label=label,
                samples=samples,
                before_deg=free[0],
                after_deg=free[1],
                told_before_deg=told[0],
                told_after_deg=told[1],
                near_before_deg=near[0],
                near_after_deg=near[1],
                floor_deg=floor,
            )
        )
    if not blocks:
        return HeldOutResult((), np.nan, np.nan, 1.0, "nothing: too few samples")
    weight = np.array([b.samples for b in blocks], dtype=np.float64)
    before = float(np.sqrt(np.average([b.before_deg**2 for b in blocks], weights=weight)))
    after = float(np.sqrt(np.average([b.after_deg**2 for b in blocks], weights=weight)))
    # Such a residual has few independent pieces, and its ratio of errors weighs no more than they.
    evidence = PIECES * float(np.log(before / max(after, 1e-12)))
    label = "; ".join(b.label for b in blocks)
    return HeldOutResult(tuple(blocks), before, after, float(np.exp(min(evidence, 200.0))), label)


def distance_to_curve(problem: Problem, angle_deg: Floats, rows: Flags) -> float:
    """Root mean square distance of readings to the predicted curve [deg].

    Torque counts by the chord of the loop, so that a crossing a little too early or too late is a
    small distance.
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

    Only where the programmes agree: then the runs are replicates of each other.
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
            if np.corrcoef(np.interp(place, at, torque[theirs]), torque[mine])[0, 1] < ALIKE:
                continue
            told = np.interp(place, at, problem.angle_deg[theirs])
            errors.append((float(np.mean((problem.angle_deg[mine] - told) ** 2)), len(mine)))
            break
    if not errors:
        return None
    value, count = np.array(errors).T
    return float(np.sqrt(np.average(value, weights=count)))


def _error(problem: Problem, mean: Floats, rows: Flags) -> float:
    difference = (problem.angle_deg - mean)[rows]
    return float(np.sqrt(np.average(difference**2, weights=problem.weight[rows])))


def _log_ratio(problem: Problem, noise: Noise, mean: Floats, held: Flags) -> float:
    """Log likelihood of a block under the trained model over that of its own best baseline."""
    gap = gaps(held, problem.history.run, problem.history.time_s)
    block = replace(problem, fitted=held, held_out=~held, gap=gap)
    local = replace(noise, gap=gap[held])
    null = fit(block, local, ())
    trained, _ = local.residual(problem.angle_deg[held], mean[held])
    return 0.5 * (null.chi2 - float(trained @ trained))
