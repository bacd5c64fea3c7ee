"""What is said of a staircase: how high its steps are, whether they repeat, and their order."""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.repetition import Repetition, StepOrder
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.both_ways import direction_correlation, in_words
from cyclosweep.diagnosis.whole_loop.forecast import Forecast
from cyclosweep.result import Finding
from cyclosweep.result.words import readable
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.effects.order_names import from_recorded_position, travels

STEPS = (3.0, 40.0)
"""Fewest and most steps of a staircase over the range of the angle."""
CLEAR_PERIOD = 0.1
"""Share of the residual that a period has to explain to be given."""


STAIRCASE = "staircase"
"""Topic of what is said of steps."""
TIED, EQUAL = "tied to the position of mesh and motor", "They come at equal distances"
"""What is said of steps that repeat at the same positions, and of those that have an order."""


def are_tied_steps(finding: Finding) -> bool:
    """Whether a finding says that steps without a name repeat, or have an order."""
    return finding.topic == STAIRCASE and (TIED in finding.text or EQUAL in finding.text)


def angle_in_words(value_deg: float) -> str:
    """Angle in deg and arcmin."""
    return f"{value_deg:.3g} deg ({60 * value_deg:.3g} arcmin)"


def named_staircase(forecast: Forecast) -> Finding | None:
    """Orders of a staircase that is one of the effects; None where none is.

    One to three waves a turn of the mesh, counted from recorded positions, are no staircase.
    """
    for term, value in zip(forecast.terms, forecast.model.effects, strict=True):
        has_steps = travels(term.shape) and not from_recorded_position(term.shape)
        if term.effect is not None and has_steps:
            amplitudes = np.array(value.amplitudes)
            law = term.effect.found_law(forecast.history, term.shape, amplitudes)
            return Finding(topic=STAIRCASE, text=f"Named: {readable(term.name)}. {law}")
    return None


def staircase(problem: Problem, forecast: Forecast, repeats: Repetition) -> Finding:
    """Steps that repeat at the same positions.

    Parameters
    ----------
    problem : Problem
    forecast : Forecast
    repeats : Repetition
        How well the residual of one run predicts that of another.

    Returns
    -------
    Finding
    """
    rows = problem.whole_fitted
    left = (problem.angle_deg - forecast.angle_deg)[rows]
    size = float(np.quantile(np.abs(left), 0.9))
    period = None if repeats.order else step_period(problem.angle_deg[rows], left)
    spaced = (
        "" if period is None else f", spaced about {angle_in_words(period)} at the measured shaft"
    )
    return Finding(
        topic=STAIRCASE,
        text=f"Steps of about {angle_in_words(size)} remain that no effect explains{spaced}. "
        f"{_repeated(problem, repeats)}",
    )


def _repeated(problem: Problem, repeats: Repetition) -> str:
    """Say how far the steps repeat, by the same measure as the verdict.

    Parameters
    ----------
    problem : Problem
    repeats : Repetition
        How well the residual of one run predicts that of another.

    Returns
    -------
    str
    """
    order = repeats.order
    spaced = "" if order is None else f" {_ordered(order, problem.history.mesh_ratio)}"
    if repeats.is_physics:
        return (
            f"They repeat at the same positions {repeats.in_words}: they are {TIED}, not to noise."
            f"{spaced}{in_words(direction_correlation(problem))}"
        )
    if order is not None:
        return f"They repeat in part {repeats.in_words}.{spaced}"
    return (
        f"They repeat only in part {repeats.in_words}: too little to tie them to the position of "
        "the mesh."
    )


def _ordered(order: StepOrder, mesh_ratio: float) -> str:
    """Say at which order the steps come, where their crests are, and how sure that is.

    Parameters
    ----------
    order : StepOrder
    mesh_ratio : float
        Turns of the input a turn of the measured shaft.

    Returns
    -------
    str
    """
    apart = order.apart_share * order.of_input(mesh_ratio)
    signs = {1: "positive", -1: "negative"}
    crests = [
        f"at {order.crest_deg[side]:.2f} deg under {signs[side]} load"
        for side in (1, -1)
        if side in order.crest_deg
    ]
    where = f" One crest of the torque is {' and '.join(crests)}." if crests else ""
    return (
        f"{EQUAL}, {order.in_words(mesh_ratio)}, with multiples, as from the "
        f"poles of a motor or the teeth of a mesh; the travel tells orders apart that differ by "
        f"{apart:.2g}, and of random staircases {100 * order.chance:.2g} % show as clear an order."
        f"{where}"
    )


def step_period(angle_deg: Floats, residual_deg: Floats) -> float | None:
    """Return the period in the angle that explains most of a residual.

    Parameters
    ----------
    angle_deg, residual_deg : ndarray of float, shape (n,)
        Measured angle, and what the model leaves of it [deg].

    Returns
    -------
    float or None
        The period [deg]; None where none stands out.
    """
    clean = residual_deg - residual_deg.mean()
    total = float(clean @ clean)
    best, gain = None, 0.0
    for period in float(np.ptp(angle_deg)) / np.geomspace(*STEPS, 120):
        phase = 2 * np.pi * angle_deg / period
        wave = np.column_stack([np.ones_like(phase), np.cos(phase), np.sin(phase)])
        basis = np.linalg.qr(wave)[0]
        value = float(np.sum((basis.T @ clean) ** 2)) / max(total, 1e-300)
        if value > gain:
            best, gain = float(period), value
    return best if gain > CLEAR_PERIOD else None
