"""Parameters of a simulation that are fitted to whole loops: places, bounds and scales."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit_parameters import fit_parameters_of
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.simulation.effects.base import Parameter
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.effects.slip import on_shared_elements
from cyclosweep.simulation.model import EffectValue, Model


@dataclass(frozen=True, slots=True)
class ModelParameter:
    """One parameter of a simulation: where it stands, its bounds and its scale.

    Attributes
    ----------
    kind : str
        ``"datum"``, ``"compliance"``, ``"play"`` or ``"zero"`` (torque read without load) of the
        line; ``"growth"`` of the presliding distances, by which no law is judged; ``"nonlinear"``,
        another `FitParameter` of a term; ``"amplitude"``, a linear amplitude of a term.
    term : int
        Index of its term; -1 for the line.
    name : str
        Name within the term; for a linear amplitude its number.
    lower, upper, scale : float
        Bounds, and the size of a usual change, in the fit's own scale.
    quantity : Parameter
        Unit and meaning.
    logarithmic : bool
        Whether the fit's own scale is the logarithm of the value.
    """

    kind: str
    term: int
    name: str
    lower: float
    upper: float
    scale: float
    quantity: Parameter
    logarithmic: bool = False


def model_parameters_of(
    problem: Problem, terms: Sequence[Term], *, zero: bool
) -> tuple[ModelParameter, ...]:
    """Parameters of a simulation that are fitted.

    Parameters
    ----------
    problem : Problem
        The recording, by whose largest torque [N m] and twist [deg] bounds and scales go.
    terms : sequence of Term
        The effects of the simulation.
    zero : bool
        Whether the torque read without load is fitted.

    Returns
    -------
    tuple of ModelParameter
        Line, nonlinear parameters, linear amplitudes.
    """
    top, twist = problem.history.largest_torque_nm, problem.history.largest_twist_deg
    span = float(np.ptp(problem.angle_deg))
    nothing = Parameter("", "", "")
    parameters = [
        ModelParameter("datum", -1, "datum", -np.inf, np.inf, 0.2 * span, nothing),
        ModelParameter("compliance", -1, "compliance", -12.0, 12.0, 1.0, nothing, True),
    ]
    if not problem.one_sided:
        parameters.append(
            ModelParameter(
                "play", -1, "play", np.log(1e-4 * span), np.log(span), 1.0, nothing, True
            )
        )
    if zero:
        parameters.append(
            ModelParameter("zero", -1, "zero", -0.3 * top, 0.3 * top, 0.1 * top, nothing)
        )
    for nonlinear in fit_parameters_of(terms, problem):
        quantity = nonlinear.quantity
        lower, upper = nonlinear.to_scale(quantity.lower), nonlinear.to_scale(quantity.upper)
        if nonlinear.name == "amplitude":
            lower = max(lower, 0.0)
            size = 1.0 if upper <= 1.0 else 0.1 * top
        else:
            size = 1.0 if quantity.logarithmic else 0.5 * min(upper - lower, 2.0 * top)
        parameters.append(
            ModelParameter(
                "growth" if nonlinear.name == "growth" else "nonlinear", nonlinear.term,
                nonlinear.name, lower, upper, size, quantity, quantity.logarithmic,
            )
        )  # fmt: skip
    for index, term in enumerate(terms):
        if term.slips or term.effect is None:
            continue
        columns = term.columns(problem.history)
        for place, parameter in enumerate(term.effect.amplitudes(term.shape)):
            largest = float(np.abs(columns[:, place]).max(initial=0.0)) or 1.0
            parameters.append(
                ModelParameter(
                    "amplitude", index, str(place), parameter.lower, parameter.upper,
                    0.5 * twist / largest, parameter,
                )
            )  # fmt: skip
    return tuple(parameters)


def values_of(parameters: Sequence[ModelParameter], model: Model, terms: Sequence[Term]) -> Floats:
    """Values of the parameters in a simulation.

    Parameters
    ----------
    parameters : sequence of ModelParameter
    model : Model
        The simulation, its effects in the order of ``terms``.
    terms : sequence of Term

    Returns
    -------
    ndarray, shape (p,)
        In the fit's own scale.
    """
    base = {
        "datum": model.datum_deg,
        "compliance": model.compliance_deg_per_nm,
        "play": model.free_play_deg,
        "zero": model.torque_zero_nm,
    }
    out = []
    for parameter in parameters:
        if parameter.kind in base:
            value = base[parameter.kind]
        elif parameter.kind == "amplitude":
            value = model.effects[parameter.term].amplitudes[int(parameter.name)]
        elif parameter.name == "amplitude":
            value = model.effects[parameter.term].amplitudes[0]
        else:
            value = float(terms[parameter.term].shape[parameter.name])
        out.append(np.log(max(value, 1e-300)) if parameter.logarithmic else value)
    return np.array(out, dtype=np.float64)


def with_values(
    parameters: Sequence[ModelParameter], values: Floats, model: Model, terms: Sequence[Term]
) -> tuple[Model, tuple[Term, ...]]:
    """Simulation and terms with the parameters at other values.

    Parameters
    ----------
    parameters : sequence of ModelParameter
    values : ndarray, shape (p,)
        In the fit's own scale.
    model : Model
        The simulation, its effects in the order of ``terms``.
    terms : sequence of Term

    Returns
    -------
    Model, tuple of Term
    """
    base = {"datum": model.datum_deg, "compliance": model.compliance_deg_per_nm}
    base |= {"play": model.free_play_deg, "zero": model.torque_zero_nm}
    shapes = [dict(term.shape) for term in terms]
    amplitudes = [list(value.amplitudes) for value in model.effects]
    for parameter, inner in zip(parameters, values, strict=True):
        value = float(np.exp(inner)) if parameter.logarithmic else float(inner)
        if parameter.kind in base:
            base[parameter.kind] = value
        elif parameter.kind == "amplitude":
            amplitudes[parameter.term][int(parameter.name)] = value
        elif parameter.name == "amplitude":
            amplitudes[parameter.term][0] = value
        else:
            shapes[parameter.term][parameter.name] = value
    shapes = on_shared_elements([term.effect for term in terms], shapes)
    moved = tuple(
        replace(term, shape=shape, amplitude=amplitude[0] if term.slips else term.amplitude)
        for term, shape, amplitude in zip(terms, shapes, amplitudes, strict=True)
    )
    changed = replace(
        model,
        compliance_deg_per_nm=base["compliance"],
        free_play_deg=base["play"],
        datum_deg=base["datum"],
        torque_zero_nm=base["zero"],
        effects=tuple(
            EffectValue(t.name, shape, tuple(amplitude), t.in_series)
            for t, shape, amplitude in zip(terms, shapes, amplitudes, strict=True)
        ),
    )
    return changed, moved
