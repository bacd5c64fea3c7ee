"""Proof on data not used: errors on left-out blocks, and a cross-fit e-value."""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.fit import Fit, fit
from cyclosweep.diagnosis.noise import Noise
from cyclosweep.diagnosis.problem import Problem, gaps
from cyclosweep.diagnosis.split import folds, restrict
from cyclosweep.effects.history import Flags, Floats


@dataclass(frozen=True, slots=True)
class Block:
    """Errors on one left-out block [deg]."""

    label: str
    samples: int
    before_deg: float
    after_deg: float


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
