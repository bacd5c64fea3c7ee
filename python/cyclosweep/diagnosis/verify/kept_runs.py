"""How runs that were kept for the verdict differ from those that were fitted."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure, LeftOutPrediction
from cyclosweep.result.words import degrees

BEYOND_NOISE = 2.0
"""Error on kept runs, over noise and error of the fit, from which they are said to differ."""
EXPLAINED = 0.6
"""What another calibration leaves of that error, over the error, up to which it is the reason."""


def kept_runs_in_words(structure: FittedStructure, predictions: Sequence[LeftOutPrediction]) -> str:
    """Say how far kept runs are missed, and which calibration of their own they would need.

    Parameters
    ----------
    structure : FittedStructure
        Fitted without them.
    predictions : sequence of LeftOutPrediction
        Of parts of the recording that were left out.

    Returns
    -------
    str
        Empty where no run was kept, where its flanks are forecast, and where it is not missed.
    """
    kept = [each for each in predictions if each.kept_runs and each.known_flank is None]
    if not kept or structure.noise.structured:
        return ""
    rows, mean = kept[0].rows, kept[0].structure_deg
    problem, history = structure.problem, structure.history
    missed = problem.rms_error(mean, rows)
    usual = max(structure.noise.spread_deg, structure.rmse_deg)
    if missed <= BEYOND_NOISE * usual:
        return ""
    error = (problem.angle_deg - mean)[rows]
    torque, side = history.applied_nm[rows], history.side[rows]
    compliance = history.compliance_deg_per_nm
    reasons = []
    for column, text in (
        (np.ones(len(error)), "their zero is another one, by {:.2g} deg"),
        (side, "their free play is wider by {:.2g} deg each side"),
        (torque, "their compliance is another one, by {:+.2g} %"),
    ):
        size = float(column @ error) / float(column @ column)
        shown = 100.0 * size / compliance if column is torque else size
        left = float(np.sqrt(np.mean((error - size * column) ** 2)))
        reasons.append((left, text.format(shown)))
    left, reason = min(reasons)
    if left > EXPLAINED * missed:
        reason = "the drive, or the rig, was not the same in them"
    return (
        f"The runs that were kept are missed by {degrees(missed)}, {missed / usual:.2g} times what "
        f"the fitted ones leave: {reason}."
    )
