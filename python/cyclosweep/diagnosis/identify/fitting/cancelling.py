"""Effects that cancel each other: fits that have run away."""

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.line_basis import line_basis

MOST_TIMES = 5.0
"""Size of an effect over that of all there is to be explained, above which others cancel it."""


def cancel(fitted: FittedStructure, baseline: FittedStructure) -> bool:
    """Whether an effect is many times as large as all that there is to be explained.

    Two laws that nearly alias each other fit best where their amplitudes run away together.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    baseline : FittedStructure
        The calibrated model without effects.

    Returns
    -------
    bool
        False of a single effect; frictions are not asked, whatever cancels them is.
    """
    if len(fitted.terms) < 2:
        return False
    most = MOST_TIMES * float(np.linalg.norm(baseline.residual))
    for index, term in enumerate(fitted.terms):
        if term.slips:
            continue
        law = fitted.whitened_contribution(index, baseline.noise)
        if float(np.linalg.norm(law)) <= most:
            continue
        line = line_basis(fitted)
        if float(np.linalg.norm(law - line @ (line.T @ law))) > most:
            return True
    return False
