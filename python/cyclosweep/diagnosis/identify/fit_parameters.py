"""Parameters that enter a fit nonlinearly: which they are, and within what bounds they lie."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.base import Parameter
from cyclosweep.simulation.effects.creep import FEWEST_STEPS


@dataclass(frozen=True, slots=True)
class FitParameter:
    """One nonlinear parameter of a structure.

    Attributes
    ----------
    term : int
        Index of its term in the structure.
    name : str
        Name of the shape parameter, or ``"amplitude"`` for a friction limit.
    quantity : Parameter
        Unit, meaning and bounds.
    """

    term: int
    name: str
    quantity: Parameter

    def to_scale(self, value: float) -> float:
        """From the physical value to the fit's own scale, which may be logarithmic."""
        return float(np.log(max(value, 1e-300))) if self.quantity.logarithmic else value

    def to_physical(self, value: float) -> float:
        """From the fit's own scale to the physical value."""
        return float(np.exp(value)) if self.quantity.logarithmic else value


def fit_parameters_of(terms: Sequence[Term], problem: Problem) -> tuple[FitParameter, ...]:
    """Nonlinear parameters of a structure; all friction terms share one set of slip elements.

    Parameters
    ----------
    terms : sequence of Term
    problem : Problem
        The recording, by whose largest torque [N m], twist [deg] and time step [s] the bounds go.

    Returns
    -------
    tuple of FitParameter
        In the order of the terms; a friction limit before the shape of its slip elements.
    """
    found: list[FitParameter] = []
    sliding = False
    top = problem.history.largest_torque_nm
    for index, term in enumerate(terms):
        if term.effect is None:
            continue
        if term.slips:
            amplitude = term.effect.amplitudes(term.shape)[0]
            upper = min(amplitude.upper, 0.95 if "share" in amplitude.name else top)
            limits = replace(amplitude, upper=upper)
            found.append(FitParameter(index, "amplitude", limits))
            if sliding:
                continue
            sliding = True
        for parameter in term.effect.shape_parameters:
            if parameter.name not in term.shape:
                continue
            found.append(FitParameter(index, parameter.name, _within(parameter, problem)))
    return tuple(found)


def _within(parameter: Parameter, problem: Problem) -> Parameter:
    """Bounds of a shape parameter as narrow as the recording allows."""
    top = problem.history.largest_torque_nm
    twist = problem.history.largest_twist_deg
    if parameter.unit == "N m":
        lower, upper = 1e-3 * top, 3.0 * top
        if parameter.name == "onset_nm":
            lower, upper = 0.0, 0.92 * top
        if parameter.name == "first_nm":
            # A single kink further out is what a sensor at its limit shows.
            lower, upper = 0.0, 0.45 * top
        if parameter.name == "turn_nm":
            upper = 0.25 * top
        if parameter.name == "range_nm":
            upper = 0.9 * top
        return replace(parameter, lower=lower, upper=upper)
    step = problem.history.usual_step_s
    if parameter.unit == "s" and step > 0:
        upper = parameter.upper
        if parameter.name == "delay_s" and problem.history.time_s is not None:
            upper = max(0.1 * float(np.ptp(problem.history.time_s)), 4.0 * step)
        return replace(parameter, lower=FEWEST_STEPS * step, upper=upper)
    if parameter.name == "slip_deg":
        return replace(parameter, lower=5e-4 * twist, upper=0.6 * twist)
    return parameter
