"""Recordings whose residual is error of the model rather than noise: a ladder of named effects.

Where the sensor is far better than any model, the residual is structured down to the last step,
and a test against noise rejects everything. The simulation itself is then fitted to whole loops,
crossings of the dead zone included, and effects are added one at a time, as long as each pays for
its parameters; what remains is judged by whether it repeats from run to run.
"""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fit import Fit
from cyclosweep.diagnosis.identify.search import Node, Search
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.prepare.split import whole_stretches
from cyclosweep.diagnosis.whole_loop.forecast import (
    BLUR,
    PIECES,
    Forecast,
    fit_forecast,
    refit,
    rms,
    start,
)
from cyclosweep.diagnosis.whole_loop.known_flank import told_fit
from cyclosweep.diagnosis.whole_loop.usual_effects import STARTS, USUAL, first_amplitude
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.effects.history import Flags, Floats
from cyclosweep.simulation.simulate import EffectValue

MOST_MORE = 1
"""Effects added beyond those."""
FIRST = 0.15
"""Share of the error on left-out stretches that the first effect must take away."""
TRIED = 2
"""Effects that are fitted on a rung, those whose shape is most alike to what is left."""
PRICE = 2.0
"""What a parameter must gain: twice the log likelihood of independent pieces."""
FAR = 1.8
"""Error on another run over that on its own beyond which the two are not the same drive."""
FAR_OF_SPAN = 0.05
"""The same as a share of the whole range of the angle."""
SAME_RANGE = 0.2
"""Share of the range of torque within which the ends of two replicates agree."""
FEWEST = 40
"""Rows of a run from which it can be compared with another."""
MOST_RUNS = 6
"""Runs that are fitted alone to see whether they differ."""
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
    """Fit what such loops usually show, leave out what does not pay, add what does."""
    problem = search.problem
    base = fit_forecast(problem, start(problem), (), zero=False, most=10)
    usual = _usual(search, base)
    if usual is None or not _pays(usual, base):
        return search.root
    best = fit_forecast(problem, usual.model, usual.terms, zero=usual.has_zero, most=10, blur=BLUR)
    best = _extend(search, _prune(problem, best))
    gain = PIECES * float(np.log(base.error_deg / best.error_deg))
    return search.adopt(told_fit(best, base, search.noise), gain)


def _usual(search: Search, base: Forecast) -> Forecast | None:
    """Both kinds of friction, stiffening and asymmetry at once, from several starts.

    One at a time, friction takes the place of the stiffening and does not give it back; and the
    crossings of the dead zone leave many small minima.
    """
    problem = search.problem
    top, twist = problem.history.largest_torque_nm, problem.history.largest_twist_deg
    known = {b.hypothesis: b.effect for b in search.library.blocks if b.effect is not None}
    effects = [known[name] for name in USUAL if name in known]
    if not effects:
        return None
    zero = not problem.one_sided and _crosses_late(problem)
    found: Forecast | None = None
    for limit, slip in STARTS:
        sliding = {
            "slip_deg": slip * twist, "scatter": 1.0, "skew": 0.0, "slack": 0.0,
            "growth": 0.7, "reference_nm": 0.3 * top,
        }  # fmt: skip
        terms, values = [], []
        for effect in effects:
            shape = sliding if effect.slips else USUAL[effect.name](top)
            amplitude = first_amplitude(effect, shape, limit * top, twist / top)
            terms.append(Term(effect, shape, None, amplitude if effect.slips else 0.0))
            values.append(EffectValue(effect.name, shape, (amplitude,)))
        model = replace(base.model, effects=tuple(values))
        joint = fit_forecast(problem, model, terms, zero=zero, most=10)
        found = joint if found is None else _better(found, joint)
    return found


def _crosses_late(problem: Problem) -> bool:
    """Whether crossings of the dead zone were recorded where they tell the torque's zero."""
    history, rows = problem.history, problem.whole_fitted
    pulled = history.side * history.applied_nm < -1e-3 * history.largest_torque_nm
    return bool(np.any(rows & ~problem.fitted) or np.any(rows & pulled))


def _prune(problem: Problem, best: Forecast) -> Forecast:
    """Leave out what does not pay for its parameters."""
    for name in sorted(best.names):
        kept = [k for k, term in enumerate(best.terms) if term.name != name]
        if not kept:
            continue
        terms = tuple(best.terms[k] for k in kept)
        model = replace(best.model, effects=tuple(best.model.effects[k] for k in kept))
        without = fit_forecast(problem, model, terms, zero=best.has_zero, most=5)
        if _cost(without) < _cost(best):
            best = without
    return best


def _extend(search: Search, best: Forecast) -> Forecast:
    """Add effects that look like what is left, as long as they pay."""
    problem = search.problem
    known = {b.hypothesis: b.effect for b in search.library.blocks if b.effect is not None}
    for _ in range(MOST_MORE):
        tried = [
            _with(problem, best, known[name], shape) for name, shape in _alike(search, best)[:TRIED]
        ]
        if not tried:
            break
        joint = min(tried, key=_cost)
        if _cost(joint) >= _cost(best):
            break
        best = _better(
            joint,
            fit_forecast(problem, joint.model, joint.terms, zero=joint.has_zero, most=8, blur=BLUR),
        )
    return best


def _cost(model: Forecast) -> float:
    """Minus twice the log likelihood of a residual's pieces, and the price of the parameters."""
    return 2.0 * PIECES * float(np.log(model.error_deg)) + PRICE * len(model.parameters)


def _better(first: Forecast, second: Forecast) -> Forecast:
    return second if second.error_deg < first.error_deg else first


def _pays(model: Forecast, base: Forecast) -> bool:
    """Whether a model predicts stretches that were left out much better than the baseline."""
    return left_out_error(model) < (1.0 - FIRST) * left_out_error(base)


def left_out_error(model: Forecast) -> float:
    """Root mean square on stretches that were left out in turn [deg]."""
    problem = model.problem
    total, count = 0.0, 0
    for _, rows in whole_stretches(problem):
        part = refit(model, rows=problem.whole_fitted & ~rows, most=3)
        left = problem.whole_fitted & rows
        total += rms(problem, part.angle_deg, left) ** 2 * np.count_nonzero(left)
        count += int(np.count_nonzero(left))
    return float(np.sqrt(total / max(count, 1)))


def _with(problem: Problem, best: Forecast, effect: Effect, shape: dict[str, float]) -> Forecast:
    """Fit a model with one more effect, starting from next to none of it."""
    columns = effect.columns(best.history, shape)
    largest = np.abs(columns).max(axis=0, initial=1e-12)
    little = 0.01 * problem.history.largest_twist_deg / np.maximum(largest, 1e-12)
    model = replace(
        best.model,
        effects=(*best.model.effects, EffectValue(effect.name, shape, tuple(map(float, little)))),
    )
    terms = (*best.terms, Term(effect, shape))
    return fit_forecast(problem, model, terms, zero=best.has_zero, most=8)


def _alike(search: Search, best: Forecast) -> list[tuple[str, dict[str, float]]]:
    """Shapes of elastic effects that explain most of what is left, with physical signs.

    Others are left to recordings with more than one rate, position or temperature: along a single
    ramp each of them can take any shape.
    """
    problem = search.problem
    rows = problem.fitted
    history = best.history
    left = (problem.angle_deg - best.angle_deg)[rows]
    base = [np.ones(int(rows.sum())), history.elastic_nm[rows]]
    if not problem.one_sided:
        base.append(history.side[rows])
    basis = np.linalg.qr(np.column_stack(base))[0]
    left = left - basis @ (basis.T @ left)
    gains: dict[str, tuple[float, dict[str, float]]] = {}
    for block in search.library.blocks:
        effect = block.effect
        if effect is None or not effect.elastic or effect.name in best.names:
            continue
        columns = effect.columns(history, block.shape)[rows]
        if columns.shape[1] > 1 or not np.all(np.isfinite(columns)):
            continue
        column = columns[:, 0] - basis @ (basis.T @ columns[:, 0])
        size = float(column @ column)
        if size <= 1e-9 * float(columns[:, 0] @ columns[:, 0]):
            continue
        along = float(column @ left)
        if block.signs[0] > 0 and along < 0:
            continue
        gain = along**2 / size
        if gain > gains.get(effect.name, (0.0, {}))[0]:
            gains[effect.name] = (gain, {k: float(v) for k, v in block.shape.items()})
    order = sorted(gains, key=lambda name: -gains[name][0])
    return [(name, gains[name][1]) for name in order]


@dataclass(frozen=True)
class Steadiness:
    """How a model of one run fares on itself and on the replicate that it fits worst.

    Attributes
    ----------
    own_deg, other_deg : float
        Errors on the run it was fitted to, and on the other [deg].
    """

    own_deg: float
    other_deg: float

    def is_drift(self, span_deg: float) -> bool:
        """Whether the model fails on the other run by far more than on its own."""
        return self.other_deg > FAR * self.own_deg and self.other_deg > FAR_OF_SPAN * span_deg


def steadiness(known: Forecast) -> list[Steadiness]:
    """Fit runs alone and see how far each model errs on itself and on the run's replicates.

    Runs over another range of torque are left out: a model of small loops does not hold for large
    ones, nor the reverse, on the steadiest drive.
    """
    problem = known.problem
    torque = problem.history.applied_nm
    parts = _by_run(problem, problem.whole_fitted)
    found = []
    for rows in parts[:MOST_RUNS]:
        replicates = [p for p in parts if p is not rows and _same_range(torque[p], torque[rows])]
        if not replicates:
            continue
        alone = refit(known, rows=rows, most=4)
        own = rms(problem, alone.angle_deg, rows)
        found.append(Steadiness(own, max(rms(problem, alone.angle_deg, p) for p in replicates)))
    return found


def _by_run(problem: Problem, rows: Flags) -> list[Flags]:
    """Rows of each run that has enough of them to be compared."""
    run = problem.history.run
    parts = [rows & (run == r) for r in np.unique(run[rows])]
    return [part for part in parts if np.count_nonzero(part) > FEWEST]


def _same_range(first: Floats, second: Floats) -> bool:
    """Whether two runs load the drive from about as far to about as far."""
    room = SAME_RANGE * max(float(np.ptp(first)), float(np.ptp(second)))
    ends = (first.min() - second.min(), first.max() - second.max())
    return bool(np.max(np.abs(ends)) <= room)


def repetition(problem: Problem, fitted: Fit) -> Repetition:
    """Compare the residuals of runs over the same torque, flank and direction."""
    history = fitted.history
    rows = problem.fitted | problem.held_out
    residual = problem.angle_deg - fitted.mean_deg
    band = np.floor(np.abs(history.applied_nm) / history.largest_torque_nm * 19.99)
    cell = band * 4 + (history.side > 0) * 2 + (history.sense > 0)
    runs = _by_run(problem, rows)
    best = Repetition(0.0, 0)
    found: list[Repetition] = []
    for i, first in enumerate(runs):
        for second in runs[i + 1 :]:
            a, b = _means(residual, cell, first, second)
            if len(a) >= 12 and np.std(a) > 0 and np.std(b) > 0:
                found.append(Repetition(float(np.corrcoef(a, b)[0, 1]), len(a)))
    if found:
        middle = sorted(found, key=lambda r: r.correlation)
        best = middle[len(middle) // 2]
    return best


def _means(residual: Floats, cell: Floats, first: Flags, second: Flags) -> tuple[Floats, Floats]:
    """Mean residuals of two runs in every cell that both have visited."""
    a, b = [], []
    for value in np.unique(cell[first]):
        one, two = first & (cell == value), second & (cell == value)
        if np.any(one) and np.any(two):
            a.append(float(residual[one].mean()))
            b.append(float(residual[two].mean()))
    return np.array(a), np.array(b)
