"""Whether a recording shows the loop of a friction that was fitted to it.

A friction whose presliding is as long as the range of the twist is a curve of the torque that no
loop goes with. It stands in for a stiffening that is on no list.
"""

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import smooth_columns
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.diagnosis.prepare.problem import line_design
from cyclosweep.simulation.effects.history import Floats

VISIBLE = 30.0
"""Signal-to-noise ratio of a friction from which its loop has to show: below it the many directions
of a curve take up as much noise as the loop is large."""

NOISE_ALONE = 1.1
"""What a curve leaves over the noise, up to which it is the noise."""

LEAST_LOOP = 0.1
"""Share of the mean square twist by friction that is a loop, below which it is a curve."""


def is_curve_of_torque(fitted: FittedStructure) -> bool:
    """Whether what the frictions of a structure add is a curve of the torque, and hardly a loop.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.

    Returns
    -------
    bool
        False where it has no friction.
    """
    problem = fitted.problem
    use, history = problem.fitted, problem.history
    parts = [fitted.contribution(k)[use] for k, term in enumerate(fitted.terms) if term.slips]
    if not parts:
        return False
    line = line_design(history, history.applied_nm, one_sided=problem.one_sided)[use]
    by_friction = _left(line, np.sum(parts, axis=0))
    curves = smooth_columns(np.abs(history.applied_nm[use]) / history.largest_torque_nm)
    both_flanks = np.column_stack(
        [line, curves, np.sign(history.applied_nm[use])[:, None] * curves]
    )
    loop = _left(both_flanks, by_friction)
    return bool(np.sum(loop**2) < LEAST_LOOP * np.sum(by_friction**2))


def _left(columns: Floats, values: Floats) -> Floats:
    """What columns leave of values by least squares.

    Parameters
    ----------
    columns : ndarray, shape (n, k)
    values : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (n,)
    """
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])


def is_without_loop(fitted: FittedStructure, index: int) -> bool:
    """Whether a curve of the torque, without a loop, leaves nothing but noise.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Which of its terms is the friction.

    Returns
    -------
    bool
        False where the friction is faint.
    """
    problem = fitted.problem
    use, history = problem.fitted, problem.history
    size = float(np.linalg.norm(recalibrated_twist(fitted, index)))
    if size < VISIBLE * fitted.noise.spread_deg:
        return False
    # The elastic torque is what friction leaves of the applied one: its curves hold the loop.
    applied = history.under_applied_torque
    line = line_design(applied, applied.applied_nm, one_sided=problem.one_sided)
    load = np.clip(applied.load_nm / applied.largest_torque_nm, 0.0, 1.0)
    others = [
        term.columns(applied) @ fitted.beta[fitted.column_range(k)]
        for k, term in enumerate(fitted.terms)
        if not term.slips
    ]
    columns = np.column_stack([line, applied.side[:, None] * smooth_columns(load), *others])[use]
    left = _left(columns, problem.angle_deg[use])
    return float(np.sqrt(np.mean(left**2))) <= NOISE_ALONE * fitted.noise.spread_deg
