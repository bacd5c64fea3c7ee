"""What a test engineer sees in a measured loop, in figures."""

from collections.abc import Mapping

import numpy as np
from scipy import stats

from cyclosweep.diagnosis.identify.fitting.friction_reached import friction_reached_nm
from cyclosweep.diagnosis.identify.fitting.repetition import LEAST_REPEAT, Repetition
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.forecast import Forecast
from cyclosweep.diagnosis.whole_loop.loop_width import widest_nm
from cyclosweep.diagnosis.whole_loop.staircase_found import (
    angle_in_words,
    named_staircase,
    staircase,
)
from cyclosweep.result import Finding
from cyclosweep.result.calibration_words import HIDDEN
from cyclosweep.result.effects import is_reached
from cyclosweep.result.part import NORMAL_95
from cyclosweep.result.words import telling_digits
from cyclosweep.simulation.effects.history import Flags, Floats
from cyclosweep.simulation.elastic_law import elastic_law

LEAST_MOVEMENT = 0.6
"""Share of the nominal dead zone below which friction has held the shaft inside its play."""
MOST_FRICTION = 0.35
"""Share of the largest torque from which Coulomb friction decides what the loop looks like."""
COULOMB = "friction_hysteresis"
"""Friction that does not depend on the load."""


def findings(
    forecast: Forecast,
    repeats: Repetition | None,
    limit_errors: Mapping[str, float],
    *,
    unsteady: bool,
) -> tuple[Finding, ...]:
    """Topics and sentences, in the order in which a loop is read.

    Parameters
    ----------
    forecast : Forecast
        The simulation fitted to the loops.
    repeats : Repetition or None
        How well the residual of one run predicts that of another.
    limit_errors : mapping of str to float
        Standard error of the limit of each friction, by its name, in the limit's unit.
    unsteady : bool
        Whether the loops drift from run to run.

    Returns
    -------
    tuple of Finding
    """
    problem = forecast.problem
    known = forecast.names
    hidden = hidden_by_friction(problem, forecast)
    found = [_play(problem, forecast, hidden)]
    if COULOMB in known:
        found.append(_friction(problem, forecast, limit_errors[COULOMB]))
    if "load_dependent_friction" in known:
        found.append(_load_friction(forecast, limit_errors["load_dependent_friction"]))
    if hidden is None:
        if known & {"contact_stiffening", "clearance_takeup"}:
            found.append(_stiffening(problem, forecast))
        found.append(_stiffness(problem, unsteady=unsteady))
    else:
        found.append(
            Finding(topic="stiffness", text="Not reported, for the same reason as the play.")
        )
    named = named_staircase(forecast)
    if named is not None:
        found.append(named)
    elif repeats is not None and repeats.correlation > LEAST_REPEAT and not unsteady:
        found.append(staircase(problem, forecast, repeats))
    return tuple(found)


def hidden_by_friction(problem: Problem, forecast: Forecast) -> str | None:
    """Return why play and stiffness cannot be read: friction hardly let the shaft go.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    forecast : Forecast
        The simulation fitted to it.

    Returns
    -------
    str or None
        The reason; None where they can be read.
    """
    rows = problem.whole_fitted | problem.whole_held_out
    moved = float(np.ptp(problem.angle_deg[rows]))
    nominal = 2.0 * problem.nominal_free_play_deg
    largest = problem.largest_torque_nm
    taken = friction_reached_nm(forecast.terms, forecast.history, COULOMB, rows)
    if taken > MOST_FRICTION * largest:
        sign = f"Coulomb friction takes up to {taken:.3g} N m, {100 * taken / largest:.0f} % of"
    elif moved < LEAST_MOVEMENT * nominal:
        sign = f"the shaft moved {moved:.3g} deg only, its play is nominally {nominal:.3g}, under"
    else:
        return None
    return (
        f"{sign} the largest torque of {largest:.3g} N m. Friction that does not break away fully "
        "looks like a smaller play and a stiffer drive; larger ramps are needed"
    )


def _half_width_of_play(forecast: Forecast) -> float:
    """Half width of the 95 % interval of the play each side [deg]; NaN where it is not fitted.

    Parameters
    ----------
    forecast : Forecast

    Returns
    -------
    float
    """
    for k, parameter in enumerate(forecast.parameters):
        if parameter.kind == "play":
            error = float(np.sqrt(max(forecast.covariance[k, k], 0.0)))
            value = float(np.exp(forecast.values[k])) if parameter.logarithmic else 1.0
            return NORMAL_95 * error * value
    return float("nan")


def play_interval(play_deg: float, half_deg: float) -> str:
    """Write the 95 % interval of a play, which begins at zero.

    Parameters
    ----------
    play_deg, half_deg : float
        Play from flank to flank, and half the width of its interval [deg].

    Returns
    -------
    str

    Examples
    --------
    >>> play_interval(0.3, 0.05), play_interval(0.0021, 1.6)
    ('± 0.05 deg (95 %)', '(95 %: 0 to 1.6 deg)')
    """
    if half_deg > play_deg:
        return f"(95 %: 0 to {play_deg + half_deg:.2g} deg)"
    return f"± {half_deg:.2g} deg (95 %)"


def _play(problem: Problem, forecast: Forecast, hidden: str | None) -> Finding:
    """Dead zone of the simulation, and how it differs from the free play of the drive.

    Parameters
    ----------
    problem : Problem
    forecast : Forecast
    hidden : str or None
        Reason why it cannot be read.

    Returns
    -------
    Finding
    """
    if hidden is not None:
        return Finding(topic="play", text=f"Not reported, {HIDDEN}: {hidden}.")
    if problem.one_sided:
        return Finding(topic="play", text="Not reported: only one flank was loaded.")
    dead = 2.0 * forecast.model.free_play_deg
    half = 2 * _half_width_of_play(forecast)
    text = (
        f"Dead zone of the fitted simulation: {angle_in_words(dead)} {play_interval(dead, half)} "
        f"from flank to flank at the {problem.recording.side} shaft, a parameter of that model."
    )
    law = elastic_law(forecast.model, problem.history.largest_torque_nm)
    if law is not None:
        text += (
            " It leaves out the soft start of the contacts, which the free play by straight lines "
            "contains."
        )
    return Finding(topic="play", text=text)


def _friction(problem: Problem, forecast: Forecast, error_nm: float) -> Finding:
    """Coulomb friction as far as it was reached, and the width of the loop.

    Parameters
    ----------
    problem : Problem
    forecast : Forecast
    error_nm : float
        Standard error of the limit of that friction [N m].

    Returns
    -------
    Finding
    """
    rows = problem.whole_fitted | problem.whole_held_out
    limit = next(t.amplitude for t in forecast.terms if t.name == COULOMB)
    taken = friction_reached_nm(forecast.terms, forecast.history, COULOMB, rows)
    of_law = f"{limit:.3g} ± {NORMAL_95 * error_nm:.2g} N m (95 %)"
    if is_reached(taken, limit):
        text = f"Coulomb friction of {of_law} at the measured shaft"
    else:
        text = (
            f"Coulomb friction takes up to {taken:.3g} N m at the measured shaft; the limit of its "
            f"law, {of_law}, was not reached"
        )
    width = widest_nm(forecast.history, rows)
    if width is not None:
        text += f". The simulated loop is up to {width:.3g} N m wide at equal angle"
    return Finding(topic="friction hysteresis", text=f"{text}.")


def _load_friction(forecast: Forecast, error: float) -> Finding:
    """Friction in proportion to the transmitted torque.

    Parameters
    ----------
    forecast : Forecast
    error : float
        Standard error of its share of that torque.

    Returns
    -------
    Finding
    """
    share = next(t.amplitude for t in forecast.terms if t.name == "load_dependent_friction")
    half = NORMAL_95 * error
    return Finding(
        topic="friction that grows with load",
        text=f"{100 * share:.0f} ± {100 * half:.0f} % (95 %) of the transmitted torque on top of "
        "it: the loop opens with load, and the shaft stands still where unloading starts.",
    )


def _stiffening(problem: Problem, forecast: Forecast) -> Finding:
    """Slope of the elastic line at small and at large torque.

    Parameters
    ----------
    problem : Problem
    forecast : Forecast

    Returns
    -------
    Finding
    """
    top = float(np.abs(problem.history.applied_nm[problem.fitted]).max())
    law = elastic_law(forecast.model, top)
    assert law is not None

    def slope(low: float, high: float) -> float:
        """Mean slope of the elastic line on both flanks.

        Parameters
        ----------
        low, high : float
            Loads between which it is taken [N m].

        Returns
        -------
        float
            In deg/(N m).
        """
        ends = [
            float(np.interp(s * t, law.torque_nm, law.twist_deg))
            for s in (1, -1)
            for t in (high, low)
        ]
        return 0.5 * ((ends[0] - ends[1]) + (ends[3] - ends[2])) / (high - low)

    soft, stiff = slope(0.0, 0.1 * top), slope(0.5 * top, top)
    return Finding(
        topic="stiffening",
        text=f"The elastic line at the {problem.recording.side} shaft is "
        f"{soft / max(stiff, 1e-12):.2g} times steeper up to {0.1 * top:.2g} N m "
        f"({soft:.3g} deg/(N m)) than from {0.5 * top:.3g} to {top:.3g} N m "
        f"({stiff:.3g} deg/(N m)).",
    )


def secant_stiffnesses(problem: Problem) -> Floats:
    """Secant stiffness between half and full torque, by run and flank, loading [N m/arcmin]."""
    history = problem.history
    rows = (problem.fitted | problem.held_out) & (history.sense * history.side > 0)
    load = np.abs(history.applied_nm)
    top = float(load[problem.fitted].max(initial=0.0))
    values = []
    for run in np.unique(history.run[rows]):
        for side in (1.0, -1.0):
            here: Flags = rows & (history.run == run) & (history.side == side)
            here &= (load > 0.5 * top) & (load <= top)
            if np.count_nonzero(here) < 5 or np.ptp(history.applied_nm[here]) < 0.2 * top:
                continue
            slope = np.polyfit(history.applied_nm[here], problem.angle_deg[here], 1)[0]
            if slope > 0:
                values.append(1.0 / (60.0 * slope))
    return np.array(values)


def _stiffness(problem: Problem, *, unsteady: bool) -> Finding:
    """Mean secant stiffness with its interval over runs and flanks.

    Parameters
    ----------
    problem : Problem
    unsteady : bool
        Whether the loops drift from run to run.

    Returns
    -------
    Finding
    """
    if unsteady:
        return Finding(
            topic="stiffness",
            text="Not reported: the loops drift from run to run, so a slope mixes stiffness with "
            "creep, warming or wear. Let the drive settle and repeat.",
        )
    values = secant_stiffnesses(problem)
    if len(values) < 2:
        text = "Not reported: too few loading branches reach half of the torque."
        return Finding(topic="stiffness", text=text)
    top = float(np.abs(problem.history.applied_nm[problem.fitted]).max(initial=0.0))
    mean = float(values.mean())
    half = float(stats.t.ppf(0.975, len(values) - 1) * stats.sem(values))
    low, high = max(mean - half, 0.0), mean + half
    digits = telling_digits(mean, (low, high), 2)
    return Finding(
        topic="stiffness",
        text=f"Loading branches alone, from {0.5 * top:.3g} to {top:.3g} N m: {mean:.{digits}g} N "
        f"m/arcmin at the {problem.recording.side} shaft, 95 % interval {low:.{digits}g} to "
        f"{high:.{digits}g} ({60 * 180 / np.pi * mean:.3g} N m/rad); single "
        f"branches from {values.min():.{digits}g} to {values.max():.{digits}g}. Unlike the "
        "stiffness by straight lines it contains what friction takes of the torque on the way up.",
    )
