"""Recordings whose residual is error of the model rather than noise: a ladder of named effects.

Where the sensor is far better than any model, the residual is structured down to the last step,
and a test against noise rejects everything. Effects are then added one at a time, as long as each
lowers the error on stretches that were left out, and what remains is judged by whether it repeats
from run to run.
"""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.fit import Fit, Term, fit
from cyclosweep.diagnosis.noise import Noise
from cyclosweep.diagnosis.problem import Problem
from cyclosweep.diagnosis.search import Node, Search
from cyclosweep.diagnosis.split import restrict, stretches
from cyclosweep.effects.history import Floats

MOST_RUNGS = 6
FIRST = 0.15
"""Share of the error on left-out stretches that the first effect must take away."""
NEXT = 0.02
"""Share that each further effect must take away."""
STRETCHES = 4
"""Stretches left out at a time, so that no part of a loop is left to extrapolation."""
PIECES = 40.0
"""Rough number of independent pieces of such a residual, by which parameters are charged."""
REPEATS = 0.5
"""Correlation between runs above which a residual is a property of the drive."""


@dataclass(frozen=True)
class Repetition:
    """How well the residual of one run predicts that of another."""

    correlation: float
    cells: int

    @property
    def is_physics(self) -> bool:
        """Whether something remains that repeats."""
        return self.cells >= 12 and self.correlation > REPEATS


def climb(search: Search) -> Node:
    """Add named effects one at a time; return the last structure that paid for itself."""
    node = search.root
    for rung in range(MOST_RUNGS):
        problem, noise = search.problem, search.noise
        tried = []
        for terms, rank in _candidates(search, node):
            joint = _polish(problem, noise, terms, node.fit)
            if joint is not None:
                tried.append((np.log(joint.chi2) + 2.0 * rank / PIECES, joint))
        tried.sort(key=lambda pair: pair[0])
        before = left_out_error(problem, noise, node.fit)
        needed = FIRST if rung == 0 else NEXT
        for _, joint in tried[:3]:
            after = left_out_error(problem, noise, joint)
            if after < (1.0 - needed) * before:
                gain = PIECES * float(np.log(before / after))
                node = search.adopt(joint, node.gain + gain)
                break
        else:
            break
    return node if node is search.root else prune(search, node)


def prune(search: Search, node: Node) -> Node:
    """Leave out again what no longer lowers the error on left-out stretches."""
    problem, noise = search.problem, search.noise
    error = left_out_error(problem, noise, node.fit)
    for name in node.fit.names:
        kept = tuple(t for t in node.fit.terms if t.name != name)
        if not kept or len(kept) == len(node.fit.terms):
            continue
        joint = _polish(problem, noise, kept, node.fit)
        if joint is None:
            continue
        without = left_out_error(problem, noise, joint)
        if without < 1.005 * error and joint.chi2 < 1.02 * node.fit.chi2:
            search.nodes.pop(node.names, None)
            node = search.adopt(joint, node.gain)
            error = without
    return node


def left_out_error(problem: Problem, noise: Noise, model: Fit) -> float:
    """Root mean square on stretches that were left out in turn [deg]."""
    total, count = 0.0, 0
    for _, rows in stretches(problem, STRETCHES):
        train, train_noise = restrict(problem, noise, ~rows)
        part = fit(train, train_noise, model.terms, model, refine=False, rounds=4)
        left = (problem.angle_deg - part.mean_deg)[train.held_out]
        total += float(left @ left)
        count += len(left)
    return float(np.sqrt(total / max(count, 1)))


def _polish(problem: Problem, noise: Noise, terms: tuple[Term, ...], start: Fit) -> Fit | None:
    """Fit with patience, and only what is physical: positive compliance, signs as they must be."""
    joint = fit(problem, noise, terms, start, rounds=15)
    if not joint.valid or joint.beta[1] <= 0:
        return None
    return joint


def _candidates(search: Search, node: Node) -> list[tuple[tuple[Term, ...], float]]:
    """Structures one named effect larger, with the number of parameters added."""
    rest = node.rest
    out: list[tuple[tuple[Term, ...], float]] = []
    history = node.fit.history
    sliding = any(term.slips for term in node.fit.terms)
    named = {b.hypothesis: b.effect for b in rest.library.blocks if b.effect is not None}
    values = rest.by_hypothesis
    order = sorted((n for n in named if n in values), key=lambda n: -values[n])
    plain = [n for n in order if not getattr(named[n], "slips", False)][:4]
    for name in plain:
        if name in node.names:
            continue
        block = rest.library.blocks[rest.best_block(name)]
        extra = len(named[name].shape_parameters) if named[name] is not None else 0
        rank = block.stop - block.first + 0.5 * extra
        out.append(((*node.fit.terms, Term(block.effect, block.shape)), rank))
    for name, effect in named.items():
        if effect is None or not effect.slips or name in node.names:
            continue
        share_of_load = "share" in effect.amplitudes({})[0].name
        amplitude = 0.2 if share_of_load else 0.06 * _top(search)
        if sliding:
            shape = next(t.shape for t in node.fit.terms if t.slips)
            out.append(((*node.fit.terms, Term(effect, shape, None, 0.3 * amplitude)), 1.0))
            continue
        for share in (0.02, 0.1):
            shape = {"slip_deg": share * history.largest_twist_deg, "scatter": 1.0, "slack": 0.0}
            out.append(((*node.fit.terms, Term(effect, shape, None, amplitude)), 3.0))
    if not sliding:
        # Both kinds of friction share their elements, and one alone mimics the other badly.
        shape = {"slip_deg": 0.04 * history.largest_twist_deg, "scatter": 1.0, "slack": 0.0}
        pair = tuple(
            Term(
                effect,
                shape,
                None,
                0.15 if "share" in effect.amplitudes({})[0].name else 0.04 * _top(search),
            )
            for effect in named.values()
            if effect is not None and effect.slips
        )
        out.append(((*node.fit.terms, *pair), 4.0))
    return out


def _top(search: Search) -> float:
    return search.problem.history.largest_torque_nm


def repetition(problem: Problem, fitted: Fit) -> Repetition:
    """Compare the residuals of runs over the same torque, flank and direction."""
    history = fitted.history
    rows = problem.fitted | problem.held_out
    residual = problem.angle_deg - fitted.mean_deg
    band = np.floor(np.abs(history.applied_nm) / history.largest_torque_nm * 19.99)
    cell = band * 4 + (history.side > 0) * 2 + (history.sense > 0)
    runs = [
        r for r in np.unique(history.run[rows]) if np.count_nonzero(rows & (history.run == r)) > 40
    ]
    best = Repetition(0.0, 0)
    found: list[Repetition] = []
    for i, first in enumerate(runs):
        for second in runs[i + 1 :]:
            a, b = _means(residual, cell, rows, history.run == first, history.run == second)
            if len(a) >= 12 and np.std(a) > 0 and np.std(b) > 0:
                found.append(Repetition(float(np.corrcoef(a, b)[0, 1]), len(a)))
    if found:
        middle = sorted(found, key=lambda r: r.correlation)
        best = middle[len(middle) // 2]
    return best


def _means(
    residual: Floats, cell: Floats, rows: np.ndarray, first: np.ndarray, second: np.ndarray
) -> tuple[Floats, Floats]:
    a, b = [], []
    for value in np.unique(cell[rows]):
        here = rows & (cell == value)
        one, two = here & first, here & second
        if np.any(one) and np.any(two):
            a.append(float(residual[one].mean()))
            b.append(float(residual[two].mean()))
    return np.array(a), np.array(b)
