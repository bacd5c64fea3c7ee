"""Loads that are scattered as widely as they may be: then any smooth curve has been fitted."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.law_in_class import LawCheck, withdrawn_where

SCATTER = "spread"
"""Shape parameter: scale of the loads about their mean, over that mean."""
AT_THE_BOUND = 1e-3
"""Distance from the widest scatter that a law allows, as its logarithm, up to which it is that."""
KNOWN = 0.15
"""Standard error of its logarithm up to which the recording asks for no less."""


def without_widest_scatter(
    fitted: FittedStructure, checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw laws of which the recording asks for a scatter at its upper bound or beyond.

    Clearances that close, or joints that part, at loads so scattered begin to do so without load:
    that is a contact that stiffens, or another smooth law.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    errors = fitted.standard_errors[len(fitted.beta) :]
    widest = set[str]()
    for parameter, error in zip(fitted.fit_parameters, errors, strict=True):
        if parameter.name != SCATTER:
            continue
        term = fitted.terms[parameter.term]
        room = np.log(parameter.quantity.upper / term.shape[SCATTER])
        # Without an error the recording does not determine it.
        if room <= AT_THE_BOUND and 0.0 < error <= KNOWN:
            widest.add(term.name)
    return withdrawn_where(widest.__contains__, checks)
