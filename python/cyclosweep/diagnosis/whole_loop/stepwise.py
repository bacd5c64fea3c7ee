"""Last stage where loops are far above the noise: the simulation itself is fitted to whole loops.

Effects are named on rows in contact, whose flank the recording shows. A forecast has to find the
flank itself, and its crossings of the dead zone tell friction, play and the torque's zero better
than anything else. Here the named structure is fitted once more, as a simulation, to all rows.
"""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.enrichment import freer_friction
from cyclosweep.diagnosis.identify.friction_first import (
    PARAMETER_CHARGE,
    STARTS,
    usual_effects,
)
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.diagnosis.prepare.problem import Problem, line_design
from cyclosweep.diagnosis.prepare.split import whole_stretches
from cyclosweep.diagnosis.whole_loop.forecast import (
    BLUR,
    Forecast,
    fit_forecast,
    predicted_path,
    refit,
    starting_model,
)
from cyclosweep.diagnosis.whole_loop.known_flank import whole_loop_fit
from cyclosweep.simulation.effects import Effect
from cyclosweep.simulation.model import EffectValue

LEAST_GAIN = 0.15
"""Share of the error on left-out stretches that a structure must take away."""
FEW_RUNS = 4
"""Fitted runs up to which the flanks alone may not tell effects apart."""
MOST_WORSE = 1.3
"""Error on the flanks over that of the structure fitted to them, up to which a simulation fitted to
all rows is taken instead; and error of that structure, simulated on all rows, over that of the
simulation fitted to them, from which the latter is taken whatever it does on the flanks."""
DECIDED = 6.0
"""Difference of two costs from which the evidence is strong (Kass and Raftery, J. Am. Stat.
Assoc. 90, 1995: twice the logarithm of a ratio of 20)."""
MOST_ADDED = 1
"""Effects added beyond the usual ones."""
TRIED = 2
"""Effects that are fitted in a step, those whose shape is most like what is left."""


def whole_loop_structure(search: Search) -> Candidate | None:
    """Fit the structure that was found, as a simulation, to all rows.

    Where there is hardly more than one loop, effects take each other's place on its flanks, and
    what loops usually show is fitted to the whole loop as well; the better one is taken.

    Parameters
    ----------
    search : Search
        Of the last stage; its ``start`` is the structure that was found.

    Returns
    -------
    Candidate or None
        None where a structure does not predict left-out stretches much better than the published
        model, or fits the flanks worse than before.
    """
    problem = search.problem
    base = fit_forecast(problem, starting_model(problem), (), zero=False, most=10)
    fits = [_found(search)]
    if len(np.unique(problem.history.run[problem.fitted])) <= FEW_RUNS:
        fits.append(_usual_structure(search, base))
    offered = [
        (each, whole_loop_fit(each, base, search.noise))
        for each in fits
        if each is not None and each.terms
    ]
    room = MOST_WORSE * search.start.fit.rmse_deg
    clear = _simulation_error(search) / MOST_WORSE
    offered = [
        (each, fitted)
        for each, fitted in offered
        if fitted.rmse_deg <= room or each.error_deg < clear
    ]
    if not offered:
        return None
    # Stretches that were left out guard against a structure that explains nothing. Between two of
    # them they decide badly (one crossing of the dead zone that comes late outweighs all the rest),
    # so that they are asked only where the likelihood does not decide.
    least = min(_cost(each) for each, _ in offered)
    close = [pair for pair in offered if _cost(pair[0]) < least + DECIDED]
    errors = [left_out_error(each) for each, _ in close]
    first = int(np.argmin(errors))
    if errors[first] >= (1.0 - LEAST_GAIN) * left_out_error(base):
        return None
    best, fitted = close[first]
    gain = INDEPENDENT_PIECES * float(np.log(base.error_deg / best.error_deg))
    return search.add(fitted, gain)


def _found(search: Search) -> Forecast | None:
    """Fit the structure that was found to all rows.

    Parameters
    ----------
    search : Search

    Returns
    -------
    Forecast or None
        None where the structure has no terms, or some without a name.
    """
    problem, fitted = search.problem, search.start.fit
    if not fitted.terms or any(term.effect is None for term in fitted.terms):
        return None
    model = fitted.model("")
    terms = [
        replace(term, shape=value.shape, amplitude=value.amplitudes[0] if term.slips else 0.0)
        for term, value in zip(fitted.terms, model.effects, strict=True)
    ]
    zero = not problem.one_sided and _crosses_late(problem)
    first = fit_forecast(problem, model, terms, zero=zero, most=10)
    if first.error_deg > _simulation_error(search):
        # A staircase so steep that the shaft jumps has no settled path from which to fit further.
        return first
    return _better(
        first, fit_forecast(problem, first.model, first.terms, zero=zero, most=10, blur=BLUR)
    )


def _simulation_error(search: Search) -> float:
    """Root mean square error of the structure fitted to the flanks, simulated on all rows [deg].

    Parameters
    ----------
    search : Search

    Returns
    -------
    float
        Zero where the structure holds terms without a name, which cannot be simulated.
    """
    problem, fitted = search.problem, search.start.fit
    if any(term.effect is None for term in fitted.terms):
        return 0.0
    path = predicted_path(problem, fitted.model(""))
    return problem.rms_error(path.angle_deg, problem.whole_fitted)


def _crosses_late(problem: Problem) -> bool:
    """Whether crossings of the dead zone were recorded that show the torque's zero."""
    history, rows = problem.history, problem.whole_fitted
    pulled = history.side * history.applied_nm < -1e-3 * history.largest_torque_nm
    return bool(np.any(rows & ~problem.fitted) or np.any(rows & pulled))


def _better(first: Forecast, second: Forecast) -> Forecast:
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


def left_out_error(model: Forecast) -> float:
    """Root mean square on stretches that were left out in turn [deg]."""
    problem = model.problem
    total, count = 0.0, 0
    for _, rows in whole_stretches(problem):
        part = refit(model, rows=problem.whole_fitted & ~rows, most=3)
        left = problem.whole_fitted & rows
        total += problem.rms_error(part.angle_deg, left) ** 2 * np.count_nonzero(left)
        count += int(np.count_nonzero(left))
    return float(np.sqrt(total / max(count, 1)))


def _usual_structure(search: Search, base: Forecast) -> Forecast | None:
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
    best = fit_forecast(problem, usual.model, usual.terms, zero=usual.has_zero, most=10, blur=BLUR)
    return freer_where_it_pays(problem, _extend(search, _prune(problem, best)))


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
    zero = not problem.one_sided and _crosses_late(problem)
    found: Forecast | None = None
    for limit, slip in STARTS:
        begun = usual_effects(search, limit, slip)
        if not begun:
            return None
        terms = [term for term, _ in begun]
        values = [EffectValue(term.name, term.shape, (size,)) for term, size in begun]
        model = replace(base.model, effects=tuple(values))
        joint = fit_forecast(problem, model, terms, zero=zero, most=10)
        found = joint if found is None else _better(found, joint)
    return found


def _prune(problem: Problem, best: Forecast) -> Forecast:
    """Leave out what gains less than its parameters are charged.

    Parameters
    ----------
    problem : Problem
    best : Forecast
        The best simulation so far.

    Returns
    -------
    Forecast
    """
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
    problem = search.problem
    known = {b.hypothesis: b.effect for b in search.library.signatures if b.effect is not None}
    for _ in range(MOST_ADDED):
        tried = [
            _with(problem, best, known[name], shape)
            for name, shape in _most_similar(search, best)[:TRIED]
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
    freed = _better(
        fit_forecast(problem, model, terms, zero=zero, most=10),
        fit_forecast(problem, model, terms, zero=zero, most=15, blur=BLUR),
    )
    return freed if _cost(freed) < _cost(best) - DECIDED else best


def _cost(model: Forecast) -> float:
    """Minus twice the log likelihood of a residual's pieces, and the charge for the parameters."""
    charge = PARAMETER_CHARGE * len(model.parameters)
    return 2.0 * INDEPENDENT_PIECES * float(np.log(model.error_deg)) + charge


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


def _most_similar(search: Search, best: Forecast) -> list[tuple[str, dict[str, float]]]:
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
    list of (str, dict of str to float)
        Name and shape, the one that explains most first.
    """
    problem = search.problem
    rows = problem.fitted
    history = best.history
    left = (problem.angle_deg - best.angle_deg)[rows]
    line = line_design(history, history.elastic_nm, one_sided=problem.one_sided)
    basis = np.linalg.qr(line[rows])[0]
    left = left - basis @ (basis.T @ left)
    gains: dict[str, tuple[float, dict[str, float]]] = {}
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
        if gain > gains.get(effect.name, (0.0, {}))[0]:
            gains[effect.name] = (gain, {k: float(v) for k, v in signature.shape.items()})
    order = sorted(gains, key=lambda name: -gains[name][0])
    return [(name, gains[name][1]) for name in order]
