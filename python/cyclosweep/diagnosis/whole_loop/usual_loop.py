"""What loops usually show, fitted as a simulation to all rows.

From several starts, then pruned, extended and freed, each as far as it gains more than its
parameters are charged.
"""

from collections.abc import Collection
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import (
    PARAMETER_CHARGE,
    STARTS,
    usual_effects,
)
from cyclosweep.diagnosis.identify.structures.enrichment import freer_friction
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.diagnosis.prepare.problem import Problem, line_design
from cyclosweep.diagnosis.whole_loop.forecast import BLUR, Forecast, fit_forecast, refit
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.model import EffectValue

DECIDED = 6.0
"""Difference of two costs from which the evidence is strong (Kass and Raftery, J. Am. Stat.
Assoc. 90, 1995: twice the logarithm of a ratio of 20)."""
MOST_ADDED = 1
"""Effects added beyond the usual ones."""
TRIED = 2
"""Effects that are fitted in a step, those whose shape is most like what is left."""


def usual_structure(search: Search, base: Forecast) -> Forecast | None:
    """Usual effects less those that are not worth their parameters, with what is worth its own.

    Parameters
    ----------
    search : Search
    base : Forecast
        That of the published model alone.

    Returns
    -------
    Forecast or None
    """
    problem = search.problem
    usual = _usual(search, base)
    if usual is None:
        return None
    best = pruned(problem, refit(usual, most=10, blur=BLUR))
    return freer_where_it_pays(problem, _extend(search, best))


def _usual(search: Search, base: Forecast) -> Forecast | None:
    """Effects that such loops usually show, all at once, from several starts.

    One at a time, friction takes the place of the stiffening and does not give it back; and the
    crossings of the dead zone leave many small minima.

    Parameters
    ----------
    search : Search
    base : Forecast
        That of the published model alone.

    Returns
    -------
    Forecast or None
    """
    problem = search.problem
    zero = shows_torque_zero(problem)
    found: Forecast | None = None
    for limit, slip in STARTS:
        begun = usual_effects(search, limit, slip)
        if not begun:
            return None
        terms = [term for term, _ in begun]
        values = [EffectValue(term.name, term.shape, (size,)) for term, size in begun]
        model = replace(base.model, effects=tuple(values))
        joint = fit_forecast(problem, model, terms, zero=zero, most=10)
        found = joint if found is None else better(found, joint)
    return found


def pruned(problem: Problem, best: Forecast, names: Collection[str] | None = None) -> Forecast:
    """Leave out what gains less than its parameters are charged.

    Parameters
    ----------
    problem : Problem
    best : Forecast
        The best simulation so far.
    names : collection of str, optional
        Effects that are asked; default: all.

    Returns
    -------
    Forecast
    """
    for name in sorted(best.names if names is None else names):
        kept = [k for k, term in enumerate(best.terms) if term.name != name]
        if not kept:
            continue
        terms = tuple(best.terms[k] for k in kept)
        model = replace(best.model, effects=tuple(best.model.effects[k] for k in kept))
        without = fit_forecast(problem, model, terms, zero=best.has_zero, most=5)
        if forecast_cost(without) < forecast_cost(best):
            best = without
    return best


def _extend(search: Search, best: Forecast) -> Forecast:
    """Add effects that look like what is left, as long as they gain more than they are charged.

    Parameters
    ----------
    search : Search
    best : Forecast
        The best simulation so far.

    Returns
    -------
    Forecast
    """
    for _ in range(MOST_ADDED):
        tried = [
            _with(search.problem, best, effect, shape)
            for effect, shape in _most_similar(search, best)[:TRIED]
        ]
        if not tried:
            break
        joint = min(tried, key=forecast_cost)
        if forecast_cost(joint) >= forecast_cost(best):
            break
        best = better(joint, refit(joint, most=8, blur=BLUR))
    return best


def freer_where_it_pays(problem: Problem, best: Forecast) -> Forecast:
    """Let friction forget its turning points where the evidence for it is strong.

    Only from a fit without that freedom: begun with it, fits end in bad optima.

    Parameters
    ----------
    problem : Problem
    best : Forecast
        The best simulation so far.

    Returns
    -------
    Forecast
    """
    terms = [freer_friction(term) or term for term in best.terms]
    if terms == list(best.terms):
        return best
    values = zip(best.model.effects, terms, strict=True)
    effects = tuple(replace(value, shape=term.shape) for value, term in values)
    model, zero = replace(best.model, effects=effects), best.has_zero
    freed = better(
        fit_forecast(problem, model, terms, zero=zero, most=10),
        fit_forecast(problem, model, terms, zero=zero, most=15, blur=BLUR),
    )
    return freed if forecast_cost(freed) < forecast_cost(best) - DECIDED else best


def forecast_cost(forecast: Forecast) -> float:
    """Minus twice the log likelihood of a residual's pieces, and the charge for the parameters."""
    charge = PARAMETER_CHARGE * len(forecast.parameters)
    return 2.0 * INDEPENDENT_PIECES * float(np.log(forecast.error_deg)) + charge


def _with(problem: Problem, best: Forecast, effect: Effect, shape: dict[str, float]) -> Forecast:
    """Fit a simulation with one more effect, starting from a small amplitude of it.

    Parameters
    ----------
    problem : Problem
    best : Forecast
        The best simulation so far.
    effect : Effect
    shape : dict of str to float
        Shape parameters.

    Returns
    -------
    Forecast
    """
    columns = effect.columns(best.history, shape)
    largest = np.abs(columns).max(axis=0, initial=1e-12)
    little = 0.01 * problem.history.largest_twist_deg / np.maximum(largest, 1e-12)
    model = replace(
        best.model,
        effects=(*best.model.effects, EffectValue(effect.name, shape, tuple(map(float, little)))),
    )
    terms = (*best.terms, Term(effect, shape))
    return fit_forecast(problem, model, terms, zero=best.has_zero, most=8)


def _most_similar(search: Search, best: Forecast) -> list[tuple[Effect, dict[str, float]]]:
    """Shapes of elastic effects that explain most of what is left, with physical signs.

    Others are left to recordings with more than one rate, position or temperature: along a single
    ramp each of them can take any shape.

    Parameters
    ----------
    search : Search
    best : Forecast
        The best simulation so far.

    Returns
    -------
    list of (Effect, dict of str to float)
        Effect and shape, the one that explains most first.
    """
    problem = search.problem
    rows = problem.fitted
    history = best.history
    left = (problem.angle_deg - best.angle_deg)[rows]
    line = line_design(history, history.elastic_nm, one_sided=problem.one_sided)
    basis = np.linalg.qr(line[rows])[0]
    left = left - basis @ (basis.T @ left)
    found: dict[str, tuple[float, Effect, dict[str, float]]] = {}
    for signature in search.library.signatures:
        effect = signature.effect
        if effect is None or not effect.elastic or effect.name in best.names:
            continue
        columns = effect.columns(history, signature.shape)[rows]
        if columns.shape[1] > 1 or not np.all(np.isfinite(columns)):
            continue
        column = columns[:, 0] - basis @ (basis.T @ columns[:, 0])
        size = float(column @ column)
        if size <= 1e-9 * float(columns[:, 0] @ columns[:, 0]):
            continue
        along = float(column @ left)
        if signature.signs[0] > 0 and along < 0:
            continue
        gain = along**2 / size
        if gain > (found[effect.name][0] if effect.name in found else 0.0):
            shape = {name: float(value) for name, value in signature.shape.items()}
            found[effect.name] = (gain, effect, shape)
    order = sorted(found.values(), key=lambda each: -each[0])
    return [(effect, shape) for _, effect, shape in order]


def shows_torque_zero(problem: Problem) -> bool:
    """Whether crossings of the dead zone were recorded that show the torque's zero."""
    if problem.one_sided:
        return False
    history, rows = problem.history, problem.whole_fitted
    pulled = history.side * history.applied_nm < -1e-3 * history.largest_torque_nm
    return bool(np.any(rows & ~problem.fitted) or np.any(rows & pulled))


def better(first: Forecast, second: Forecast) -> Forecast:
    """Forecast with the smaller error; the first where they are equal.

    Parameters
    ----------
    first : Forecast
    second : Forecast

    Returns
    -------
    Forecast
    """
    return second if second.error_deg < first.error_deg else first
