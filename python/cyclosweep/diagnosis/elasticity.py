"""The drive's elasticity in a fitted structure: the line, and the effects that bend it."""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.prepare.problem import COMPLIANCE
from cyclosweep.simulation.effects.history import Floats, History

HALF = 0.5
"""Share of the largest elastic torque from which a bent elasticity is compared with a line."""

STEP = 0.1
"""Step of a parameter for a derivative, in its standard errors."""


def bending_terms(fitted: FittedStructure) -> list[int]:
    """Which terms of a structure are part of the drive's elastic law."""
    effects = [term.effect for term in fitted.terms]
    return [k for k, effect in enumerate(effects) if effect is not None and effect.elastic]


def compliance_with_curve(fitted: FittedStructure) -> tuple[float, float]:
    """Compliance of a structure and its standard error, what bends its line included.

    The line of a bent elasticity is only what the curve leaves to it, and may be anything between
    nothing and all of the compliance. What a straight line through the whole would have for a slope
    between half and full torque is what compares with the drive file.

    Parameters
    ----------
    fitted : FittedStructure
        Baseline or repaired model.

    Returns
    -------
    compliance, std_error : float
        In deg/(N m); those of the line where nothing bends it, or where the loads above half the
        largest one are too few for a slope.
    """
    line = fitted.line_compliance_deg_per_nm
    error = float(fitted.line_errors[COMPLIANCE])
    bending, problem = bending_terms(fitted), fitted.problem
    torque = fitted.history.elastic_nm
    rows = problem.fitted & (np.abs(torque) >= HALF * np.abs(torque[problem.fitted]).max())
    through = np.column_stack([np.ones(len(torque)), torque, fitted.history.side])[rows]
    through = through[:, : 2 if problem.one_sided else 3]
    if not bending or np.linalg.matrix_rank(through) < through.shape[1]:
        return line, error
    weights = np.linalg.pinv(through)[COMPLIANCE]

    def slope(at: FittedStructure) -> float:
        twist = at.line_compliance_deg_per_nm * torque
        for k in bending:
            twist = twist + at.contribution(k)
        return float(weights @ twist[rows])

    here, covariance = slope(fitted), fitted.covariance
    places = [COMPLIANCE]
    for k in bending:
        places += [*fitted.amplitude_places(k), *fitted.nonlinear_places(k)]
    by_parameter = np.zeros(len(places))
    for j, place in enumerate(places):
        step = STEP * float(np.sqrt(max(covariance[place, place], 0.0)))
        if step > 0.0 and np.isfinite(step):
            by_parameter[j] = (slope(fitted.moved(place, step)) - here) / step
    variance = float(by_parameter @ covariance[np.ix_(places, places)] @ by_parameter)
    # Where what is left is error of the model, standard errors are larger by one factor.
    usual = float(np.sqrt(max(covariance[COMPLIANCE, COMPLIANCE], 1e-300)))
    return here, float(np.sqrt(max(variance, 0.0))) * error / usual


def added_twist(fitted: FittedStructure, index: int) -> Floats:
    """Twist that a term adds on all rows, friction along the bent elasticity.

    Friction takes its torque from what twists the drive. How much twist that is, the whole elastic
    law says, as far as the elastic parts were loaded: beyond, where the drive would be without
    friction, a bent law is not known, and adds no more than at the largest torque reached.

    Parameters
    ----------
    fitted : FittedStructure
    index : int
        Index of the term.

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    by_the_line = fitted.contribution(index)
    bending = bending_terms(fitted)
    if not fitted.terms[index].slips or not bending:
        return by_the_line
    history = fitted.history
    friction_nm = -by_the_line / history.compliance_deg_per_nm
    reached = history.elastic_nm[fitted.problem.fitted]
    low, high = float(np.min(reached)), float(np.max(reached))
    history = history.with_state(elastic_nm=np.clip(history.elastic_nm, low, high))
    unheld_nm = history.elastic_nm + friction_nm
    without = history.with_state(elastic_nm=np.clip(unheld_nm, low, high))

    def bent(at: History) -> Floats:
        parts = [fitted.terms[k].columns(at) @ fitted.beta[fitted.column_range(k)] for k in bending]
        return np.asarray(np.sum(parts, axis=0))

    return by_the_line + bent(history) - bent(without)
