"""Slopes from which a joint fit starts, as far as the fit before it has measured them.

A structure with one more term has slopes by the others that hardly differ from those before. The
solver updates them from step to step and measures them anew where they do not serve, so that they
need not be exact.
"""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.joint_fit import JointFit
from cyclosweep.diagnosis.identify.fitting.linear_solve import solve
from cyclosweep.simulation.effects.history import Floats


def first_slopes(work: JointFit, before: FittedStructure | None, values: Floats) -> Floats | None:
    """Slopes of the residual by the nonlinear parameters that another fit has, too.

    Parameters
    ----------
    work : JointFit
        The fit that starts.
    before : FittedStructure or None
        The fit from whose path it starts.
    values : ndarray, shape (p,)
        Nonlinear parameters about which it is expanded, in the fit's own scale.

    Returns
    -------
    ndarray, shape (fitted, p), or None
        In the fit's own scale; not a number by parameters that the other fit has not. None where it
        has none of them, or has not measured slopes, or has seen the rows otherwise.
    """
    if before is None or before.problem is not work.problem:
        return None
    measured = before.linearisation.measured
    if measured is None or not before.noise.whitens_like(work.noise):
        return None
    known = {
        (before.terms[each.term].name, each.name): measured[:, len(before.beta) + k]
        for k, each in enumerate(before.fit_parameters)
    }
    of = work.fit_parameters
    shared = [k for k, each in enumerate(of) if (work.terms[each.term].name, each.name) in known]
    if not shared:
        return None
    slopes = np.full((len(work.target), len(values)), np.nan)
    _, white, _ = work.solution(values)
    for k in shared:
        by_parameter = known[work.terms[of[k].term].name, of[k].name]
        # The linear parameters follow.
        follow = solve(white, by_parameter, np.zeros(white.shape[1]))
        slopes[:, k] = white @ follow - by_parameter
    return slopes
