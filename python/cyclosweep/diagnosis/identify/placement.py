"""Where elastic effects lie beside friction: where it holds the drive, or in series with that part.

Friction takes a part of the applied torque. A part that gives way where friction holds the drive
carries the rest of it; a part between friction and load, such as the flange of the output, carries
all of it. The two differ at every reversal.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.signs import with_right_signs
from cyclosweep.diagnosis.identify.terms import Term

IN_SERIES_PENALTY = float(np.log(2.0))
"""What an elastic effect is charged that lies in series with friction and not where it holds the
drive: the two are as likely beforehand [nat]."""


def in_series(term: Term, others: Sequence[Term]) -> Term | None:
    """Term of an elastic effect in series with the friction of a structure.

    Parameters
    ----------
    term : Term
    others : sequence of Term
        The other terms of the structure.

    Returns
    -------
    Term or None
        None for what is not elastic, and where nothing slips.
    """
    slips = any(each.slips for each in others)
    if term.effect is None or not term.elastic or not slips:
        return None
    return replace(term, in_series=True)


def best_placed(fitted: FittedStructure) -> FittedStructure:
    """Move each elastic effect to the other place where the recording is likelier so.

    Parameters
    ----------
    fitted : FittedStructure
        A structure that was fitted to rows in contact.

    Returns
    -------
    FittedStructure
        The same structure where no effect moves.
    """
    if not any(term.slips for term in fitted.terms):
        return fitted
    for index, term in enumerate(fitted.terms):
        if term.effect is None or not term.effect.elastic:
            continue
        moved = list(fitted.terms)
        moved[index] = replace(term, in_series=not term.in_series)
        other = with_right_signs(fit(fitted.problem, fitted.noise, moved, fitted))
        charge = IN_SERIES_PENALTY if moved[index].in_series else -IN_SERIES_PENALTY
        if other is not None and other.chi2 + 2.0 * charge < fitted.chi2:
            fitted = other
    return fitted
