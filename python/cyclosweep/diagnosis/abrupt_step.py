"""A single step of the zero during a recording: a clamp that slipped, a sensor that was knocked."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.testability import calibration_basis
from cyclosweep.simulation.effects.history import Floats

MOST = 0.9
"""Share of the mean square residual from which one step is what it consists of. A steady drift is
a step to three quarters, half a wave to eight tenths."""
EACH_SIDE = 8
"""Fewest rows before and after a step: an outlier is none."""


@dataclass(frozen=True)
class AbruptStep:
    """Step of the measured angle at one row.

    Attributes
    ----------
    row : int
        First row after it, among all rows.
    size_deg : float
        Height of the step, positive where the angle becomes larger [deg].
    """

    row: int
    size_deg: float


def abrupt_step(fitted: FittedStructure) -> AbruptStep | None:
    """Find the step of the zero that is nearly all of what a structure leaves.

    Datum, compliance and play are fitted with the step, for without it they have taken up what
    they could of it.

    Parameters
    ----------
    fitted : FittedStructure
        The structure of the named effects.

    Returns
    -------
    AbruptStep or None
        None where the residual is something else.
    """
    rows, basis = np.flatnonzero(fitted.problem.fitted), calibration_basis(fitted)
    residual = fitted.residual_deg - basis @ (basis.T @ fitted.residual_deg)
    if len(rows) < 2 * EACH_SIDE:
        return None
    whole = float(residual @ residual)
    # What a step from each row on has in common with the residual, and with the line.
    common, shadow = _from_row_on(residual), _from_row_on(basis)
    alone = np.arange(len(rows), 0, -1.0) - np.sum(shadow**2, axis=1)
    inside = slice(EACH_SIDE, len(rows) - EACH_SIDE + 1)
    gain = np.zeros(len(rows))
    gain[inside] = common[inside] ** 2 / np.maximum(alone[inside], 1e-6)
    first = int(np.argmax(gain))
    if not whole > 0.0 or gain[first] < MOST * whole:
        return None
    return AbruptStep(int(rows[first]), float(common[first] / alone[first]))


def _from_row_on(values: Floats) -> Floats:
    """Sum of the values of each row and of all after it."""
    return np.asarray(np.cumsum(values[::-1], axis=0)[::-1])
