"""Parameters that enter a fit nonlinearly: which they are, and within what bounds they lie."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.base import Parameter

BY_LOAD = frozenset({"growth", "load_power"})
"""Shape parameters of a friction that mean nothing where its limit does not grow with the load."""


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


def usual_change(parameter: FitParameter, value: float) -> float:
    """Size of a usual change of a nonlinear parameter, in the fit's own scale.

    Parameters
    ----------
    parameter : FitParameter
    value : float
        Its value in the fit's own scale.

    Returns
    -------
    float
        In the fit's own scale.
    """
    quantity = parameter.quantity
    if quantity.logarithmic:
        return 0.5
    room = quantity.upper - quantity.lower
    if parameter.name == "amplitude":
        return max(abs(value), 1e-3 * room, 1e-6)
    return max(0.2 * abs(value), 0.02 * min(room, 1e3))


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
    grows = any(_limit_grows(term) for term in terms)
    for index, term in enumerate(terms):
        if term.effect is None:
            continue
        if term.slips:
            amplitude = term.effect.amplitude_bounds(problem.history, term.shape)[0]
            found.append(FitParameter(index, "amplitude", amplitude))
            if sliding:
                continue
            sliding = True
        for parameter in term.effect.shape_parameters:
            by_load = term.slips and parameter.name in BY_LOAD
            if parameter.name not in term.shape or (by_load and not grows):
                continue
            bounded = term.effect.shape_bounds(parameter, problem.history)
            found.append(FitParameter(index, parameter.name, bounded))
    return tuple(found)


def _limit_grows(term: Term) -> bool:
    """Whether a term is friction whose limit grows with the load, and presliding with it."""
    if term.effect is None or not term.slips:
        return False
    return term.effect.friction_limits(term.shape)[1] > 0.0
