"""Where elastic effects lie beside friction: where it holds the drive, or in series with that part.

Friction takes a part of the applied torque. A part that gives way where friction holds the drive
carries the rest of it; a part between friction and load, such as the flange of the output, carries
all of it. The two differ at every reversal.
"""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import orthonormal

IN_SERIES_PENALTY = float(np.log(2.0))
"""What an elastic effect is charged that lies in series with friction and not where it holds the
drive: half as likely beforehand [nat]."""


def better_placed(term: Term, parent: FittedStructure) -> tuple[Term, float]:
    """Place of a new term in which its columns explain more of what a structure leaves.

    Parameters
    ----------
    term : Term
        As it is where friction holds the drive.
    parent : FittedStructure
        The structure to which it is added.

    Returns
    -------
    Term
        The same in series with friction, where that explains more by more than the charge.
    float
        What is charged for the place [nat].
    """
    if term.effect is None or not term.elastic or not _tells_places(parent):
        return term, 0.0
    moved = replace(term, in_series=True)
    ahead = _explained(moved, parent) - _explained(term, parent)
    return (moved, IN_SERIES_PENALTY) if ahead > IN_SERIES_PENALTY else (term, 0.0)


def _tells_places(fitted: FittedStructure) -> bool:
    """Whether there is friction, and more than one run or loop to tell the two places apart.

    Of one loop, a line of the elastic torque and a curve of the applied one make any loop.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.

    Returns
    -------
    bool
    """
    problem = fitted.problem
    several = problem.run_count > 1 or problem.has_several_loops
    return several and any(term.slips for term in fitted.terms)


def _explained(term: Term, parent: FittedStructure) -> float:
    """Log likelihood that the columns of a term gain in the residual of a structure [nat].

    Parameters
    ----------
    term : Term
        Not one of its terms.
    parent : FittedStructure

    Returns
    -------
    float
    """
    columns = term.columns(parent.history)[parent.problem.fitted]
    white = parent.whitened(columns, parent.noise)
    basis = orthonormal(white - parent.tangent @ (parent.tangent.T @ white))
    return 0.5 * float(np.sum((basis.T @ parent.residual) ** 2))


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
    if not _tells_places(fitted):
        return fitted
    for index, term in enumerate(fitted.terms):
        if term.effect is None or not term.effect.elastic:
            continue
        moved = list(fitted.terms)
        moved[index] = replace(term, in_series=not term.in_series)
        other = with_right_signs(fit(fitted.problem, fitted.noise, moved, fitted))
        charge = IN_SERIES_PENALTY if moved[index].in_series else -IN_SERIES_PENALTY
        if other is not None and other.loss + 2.0 * charge < fitted.loss:
            fitted = other
    return fitted
