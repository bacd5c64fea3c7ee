"""Whether a recording shows the loop of a friction that was fitted to it.

A friction whose presliding is as long as the range of the twist is a curve of the torque that no
loop goes with. It stands in for a stiffening that is on no list.
"""

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import smooth_columns
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.testability import size_of
from cyclosweep.diagnosis.prepare.problem import line_design
from cyclosweep.simulation.effects.history import Floats

VISIBLE = 30.0
"""Signal-to-noise ratio of a friction from which its loop has to show: below it the many directions
of a curve take up as much noise as the loop is large."""

LITTLE_LESS = 0.95
"""What a curve and the friction leave over what the curve leaves, from which the friction explains
nothing that is a loop."""


def is_without_loop(fitted: FittedStructure, index: int) -> bool:
    """Whether a curve of the torque leaves no more than a structure with friction.

    Nor may the friction explain much of what the curve leaves: beside an error of the model, such
    as a staircase, a curve may leave less for other reasons.

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
    size = float(np.linalg.norm(size_of(fitted, index)))
    if size < VISIBLE * fitted.noise.spread_deg:
        return False
    line = line_design(history, history.applied_nm, one_sided=problem.one_sided)
    load = np.clip(history.load_nm / history.largest_torque_nm, 0.0, 1.0)
    others = [fitted.contribution(k) for k, term in enumerate(fitted.terms) if not term.slips]
    friction = [fitted.contribution(k) for k, term in enumerate(fitted.terms) if term.slips]
    curve = np.column_stack([line, history.side[:, None] * smooth_columns(load), *others])[use]
    by_curve = _left(curve, problem.angle_deg[use])
    if by_curve > fitted.rmse_deg:
        return False
    by_both = _left(
        np.column_stack([curve, *(each[use] for each in friction)]), problem.angle_deg[use]
    )
    return by_both > LITTLE_LESS * by_curve


def _left(columns: Floats, angle_deg: Floats) -> float:
    """Root mean square of what columns leave of an angle [deg].

    Parameters
    ----------
    columns : ndarray, shape (n, k)
    angle_deg : ndarray, shape (n,)

    Returns
    -------
    float
    """
    left = angle_deg - columns @ np.linalg.lstsq(columns, angle_deg, rcond=None)[0]
    return float(np.sqrt(np.mean(left**2)))
