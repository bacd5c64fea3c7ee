"""How runs that were kept for the verdict differ from those that were fitted."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.prediction import LeftOutPrediction
from cyclosweep.result.words import degrees
from cyclosweep.simulation.effects.history import Floats

BEYOND_NOISE = 2.0
"""Error on kept runs, over noise and error of the fit, from which they are said to differ."""
EXPLAINED = 0.6
"""What another calibration leaves of that error, over the error, up to which it is the reason."""


class _Calibrated(NamedTuple):
    """Change of one calibrated value, and the root mean square error that it leaves [deg]."""

    size: float
    left_deg: float


def _calibrated(error: Floats, column: Floats) -> _Calibrated:
    """Fit one calibrated value to an error.

    Parameters
    ----------
    error : ndarray, shape (n,)
        Measured less modelled twist [deg].
    column : ndarray, shape (n,)
        Twist by a unit of the value [deg].

    Returns
    -------
    _Calibrated
    """
    size = float(column @ error) / float(column @ column)
    return _Calibrated(size, float(np.sqrt(np.mean((error - size * column) ** 2))))


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
    needed = [_calibrated(error, np.ones(len(error)))]
    words = [f"their zero is another one, by {needed[0].size:.2g} deg"]
    needed.append(_calibrated(error, torque))
    words.append(f"their compliance is another one, by {100 * needed[1].size / compliance:+.2g} %")
    if np.any(side > 0) and np.any(side < 0):
        needed.append(_calibrated(error, side))
        wider = "wider" if needed[2].size > 0 else "narrower"
        words.append(f"their free play is {wider} by {abs(needed[2].size):.2g} deg each side")
    best = min(range(len(needed)), key=lambda k: needed[k].left_deg)
    reason = words[best]
    if needed[best].left_deg > EXPLAINED * missed:
        reason = "the drive, or the rig, was not the same in them"
    return (
        f"The runs that were kept are missed by {degrees(missed)}, {missed / usual:.2g} times what "
        f"the fitted ones leave: {reason}."
    )
