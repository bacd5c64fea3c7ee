"""Last stage where loops are far above the noise: the simulation itself is fitted to whole loops.

Effects are named on rows in contact, whose flank the recording shows. A forecast has to find the
flank itself, and its crossings of the dead zone tell friction, play and the torque's zero better
than anything else. Here the named structure is fitted once more, as a simulation, to all rows.
"""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.stages.friction_first import FEW_RUNS
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import strength_of
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.prepare.split import STRETCHES_OF_LOOPS, stretches
from cyclosweep.diagnosis.whole_loop.forecast import (
    BLUR,
    Forecast,
    fit_forecast,
    predicted_path,
    refit,
    starting_model,
)
from cyclosweep.diagnosis.whole_loop.known_flank import WholeLoopFit, noise_beside, whole_loop_fit
from cyclosweep.diagnosis.whole_loop.usual_loop import (
    DECIDED,
    better,
    forecast_cost,
    pruned,
    shows_torque_zero,
    usual_structure,
)
from cyclosweep.simulation.effects.history import Floats

LEAST_GAIN = 0.15
"""Share of the error on left-out stretches that a structure must take away."""
LEAST_STRENGTH = 2.0
"""Size of an effect over its standard error below which a simulation keeps it only where it gains
more by it than its parameters are charged."""
MOST_WORSE = 1.3
"""Error on the flanks over that of the structure fitted to them, up to which a simulation fitted to
all rows is taken instead; and error of that structure, simulated on all rows, over that of the
simulation fitted to them, from which the latter is taken whatever it does on the flanks."""
WORST = 0.02
"""Share of the rows without which it must not be far worse, either: a reading at which a flank is
reached too late is off by the whole play, and a few of them outweigh all the rest."""
MOST_LATE = 0.1
"""Share of the rows up to which those that are off by more than half the play, from flank to flank,
are crossings at another torque, and not the rule."""
FAR_WORSE = 1.5
"""Error on the other rows over that of the structure fitted to the flanks, from which it is. Where
the error on all rows falls by more than the square of this, its root is what it may be instead."""


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
    simulated = _simulated(search)
    fits = [_found(search, simulated)]
    if problem.run_count <= FEW_RUNS:
        fits.append(usual_structure(search, base))
    offered = [
        (each, whole_loop_fit(each, base, noise_beside(each, search.noise)))
        for each in fits
        if each is not None and each.terms
    ]
    offered = [_without_the_weak(search, base, *pair) for pair in offered]
    room = MOST_WORSE * search.start.fit.rmse_deg
    offered = [
        (each, fitted)
        for each, fitted in offered
        if fitted.rmse_deg <= room or _is_clearly_better(each, simulated)
    ]
    if not offered:
        return None
    # Stretches that were left out guard against a structure that explains nothing. Between two of
    # them they decide badly (one crossing of the dead zone that comes late outweighs all the rest),
    # so that they are asked only where the likelihood does not decide.
    least = min(forecast_cost(each) for each, _ in offered)
    close = [pair for pair in offered if forecast_cost(pair[0]) < least + DECIDED]
    errors = [left_out_error(each) for each, _ in close]
    first = int(np.argmin(errors))
    if errors[first] >= (1.0 - LEAST_GAIN) * left_out_error(base):
        return None
    best, fitted = close[first]
    gain = INDEPENDENT_PIECES * float(np.log(base.error_deg / best.error_deg))
    return search.add(fitted, gain)


def _without_the_weak(
    search: Search, base: Forecast, model: Forecast, fitted: WholeLoopFit
) -> tuple[Forecast, WholeLoopFit]:
    """Leave effects out of a simulation that are within their error and are not worth their charge.

    Parameters
    ----------
    search : Search
    base : Forecast
        That of the published model alone.
    model : Forecast
        The simulation.
    fitted : WholeLoopFit
        The same as a fit.

    Returns
    -------
    model, fitted : Forecast, WholeLoopFit
    """
    weak = [
        term.name
        for k, term in enumerate(fitted.terms)
        if not term.slips and strength_of(search, fitted, k) < LEAST_STRENGTH
    ]
    kept = pruned(search.problem, model, weak)
    if kept is model:
        return model, fitted
    return kept, whole_loop_fit(kept, base, noise_beside(kept, search.noise))


def _found(search: Search, simulated: Floats | None) -> Forecast | None:
    """Fit the structure that was found to all rows.

    Parameters
    ----------
    search : Search
    simulated : ndarray, shape (n,), or None
        Its twist on all rows before it is fitted to them, see `_simulated` [deg].

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
    first = fit_forecast(problem, model, terms, zero=shows_torque_zero(problem), most=10)
    if simulated is None or first.error_deg > problem.rms_error(simulated, problem.whole_fitted):
        # A staircase so steep that the shaft jumps has no settled path from which to fit further.
        return first
    return better(first, refit(first, most=10, blur=BLUR))


def _simulated(search: Search) -> Floats | None:
    """Twist of the structure fitted to the flanks, simulated on all rows.

    Parameters
    ----------
    search : Search

    Returns
    -------
    ndarray, shape (n,), or None
        In deg; None where the structure holds terms without a name, or is a line that falls, which
        cannot be simulated.
    """
    problem, fitted = search.problem, search.start.fit
    falls = not fitted.terms and fitted.line_compliance_deg_per_nm <= 0.0
    if falls or any(term.effect is None for term in fitted.terms):
        return None
    return predicted_path(problem, fitted.model("")).angle_deg


def _is_clearly_better(model: Forecast, simulated: Floats | None) -> bool:
    """Whether a simulation fitted to all rows is better than the structure fitted to the flanks.

    Parameters
    ----------
    model : Forecast
        The fitted simulation.
    simulated : ndarray, shape (n,), or None
        Twist of the other one, see `_simulated` [deg].

    Returns
    -------
    bool
    """
    if simulated is None:
        return False
    problem = model.problem
    gain = problem.rms_error(simulated, problem.whole_fitted) / model.error_deg
    loss = usual_error(problem, model.angle_deg) / usual_error(problem, simulated)
    return bool(gain > MOST_WORSE and loss <= max(FAR_WORSE, np.sqrt(gain)))


def usual_error(problem: Problem, angle_deg: Floats) -> float:
    """Root mean square error on all rows but the `WORST` share, and those on the wrong flank [deg].

    Parameters
    ----------
    problem : Problem
    angle_deg : ndarray, shape (n,)
        Simulated twist of all rows [deg].

    Returns
    -------
    float
    """
    error = np.abs(problem.angle_deg - angle_deg)
    most = float(np.quantile(error[problem.whole_fitted], 1.0 - WORST))
    beyond_play = problem.history.free_play_deg
    if np.mean(error[problem.whole_fitted] > beyond_play) <= MOST_LATE:
        most = min(most, beyond_play)
    return problem.rms_error(angle_deg, problem.whole_fitted & (error <= most))


def left_out_error(model: Forecast) -> float:
    """Root mean square on stretches that were left out in turn [deg]."""
    problem = model.problem
    total, count = 0.0, 0
    for _, rows in stretches(problem.whole_fitted, STRETCHES_OF_LOOPS):
        part = refit(model, rows=problem.whole_fitted & ~rows, most=3)
        left = problem.whole_fitted & rows
        total += problem.rms_error(part.angle_deg, left) ** 2 * np.count_nonzero(left)
        count += int(np.count_nonzero(left))
    return float(np.sqrt(total / max(count, 1)))
