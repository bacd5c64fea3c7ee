"""Repair: the published model with the accepted effects, its parameters and its predictions."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.elasticity import compliance_with_curve
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.prepare.problem import COMPLIANCE, DATUM, FREE_PLAY, Problem
from cyclosweep.recording.cleaning import REVERSED
from cyclosweep.recording.unbroken_runs import ONE_HISTORY
from cyclosweep.result import Baseline, CalibratedParameter, LearnedError
from cyclosweep.result.part import finite
from cyclosweep.result.words import readable
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import Model

TURNED_ROUND = (
    "The angle of the recording fell where its torque rose. Angles of this model have the other "
    "sign: they rise with the torque."
)
"""Note of a model on a recording whose angle was turned round when it was read."""
FALLING = (
    "A straight line with free play, fitted to all readings in contact, would fall with the "
    "torque, as no drive does; the calibrated stiffness is that of the line read off the flanks, "
    "and has no error to state."
)
"""Note beside a calibrated stiffness that is not the fitted one."""


@dataclass(frozen=True, eq=False)
class RepairedModel:
    """The published model before and after the repair.

    Attributes
    ----------
    model : Model
        Calibrated baseline and accepted effects, as a simulation.
    before, after : Baseline
        Calibrated parameters and error on the fitted data, without and with the effects.
    before_deg, after_deg : ndarray of float, shape (samples,)
        Twist of every sample of the recording by both [deg].
    stand_ins : tuple of str
        Effects of the model whose laws were not found to hold.
    learned : LearnedError or None
        What is said of the table of what the effects miss; None where the model has none.
    """

    model: Model
    before: Baseline
    after: Baseline
    before_deg: Floats
    after_deg: Floats
    stand_ins: tuple[str, ...] = ()
    learned: LearnedError | None = None


def stand_in(name: str, behaviour: str | None) -> str:
    """Say that an effect stands for its class only.

    Parameters
    ----------
    name : str
        The effect.
    behaviour : str or None
        Its class in words.

    Returns
    -------
    str

    Examples
    --------
    >>> stand_in("viscous_drag", "loop").partition(":")[0]
    'viscous drag is a stand-in for this class'
    """
    words = f"{readable(name)} is a stand-in for this class: {behaviour or 'without a name'}"
    return f"{words}; its law was not found to hold"


def repair(concluded: Conclusion, drive: Drive) -> RepairedModel:
    """Turn the accepted structure into a simulation that can be compared with the published one.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    drive : Drive
        The drive, whose name the model carries.

    Returns
    -------
    RepairedModel
    """
    problem = concluded.search.problem
    base, fitted = concluded.search.baseline.fit, concluded.accepted.fit
    before, after = fitted.baseline_prediction(base), fitted.prediction
    torque = problem.recording.torque_nm[problem.recording.counts]
    model = replace(
        fitted.model(drive.name),
        fitted_torque_nm=(float(torque.min()), float(torque.max())),
    )
    if fitted.torque_zero is not None:
        model = replace(model, torque_zero_nm=fitted.torque_zero.value_nm)
    if problem.torque_zero is not None and fitted.torque_zero is not None:
        model = replace(model, notes=(fitted.torque_zero.in_words, *model.notes))
    if model.one_history:
        model = replace(model, notes=(ONE_HISTORY, *model.notes))
    if base.line_compliance_deg_per_nm <= 0.0:
        model = replace(model, notes=(*model.notes, FALLING))
    if REVERSED in problem.recording.notes:
        model = replace(model, notes=(*model.notes, TURNED_ROUND))
    unnamed = [check for check in concluded.naming.withdrawn if check.name in fitted.names]
    notes = tuple(stand_in(check.name, check.behaviour) for check in unnamed)
    return RepairedModel(
        model=replace(model, notes=(*model.notes, *notes)),
        before=Baseline(
            parameters=calibration_of(base, problem),
            rmse_deg=finite(before.error_deg),
            counted=before.counted,
        ),
        after=Baseline(
            parameters=calibrated_parameters(fitted, problem),
            rmse_deg=finite(after.error_deg),
            counted=after.counted,
        ),
        before_deg=_at_samples(problem, before.angle_deg, base),
        after_deg=_at_samples(problem, after.angle_deg, fitted),
        stand_ins=tuple(check.name for check in unnamed),
    )


def calibrated_parameters(
    fitted: FittedStructure, problem: Problem
) -> Mapping[str, CalibratedParameter]:
    """Return stiffness, free play and datum of a fit against nominal.

    Parameters
    ----------
    fitted : FittedStructure
        Baseline or repaired model.
    problem : Problem
        The prepared recording, with the nominal values.

    Returns
    -------
    mapping of str to CalibratedParameter
        By name; with the torque read without load where that is fitted. The compliance scale
        compares the whole elasticity with the drive's: line, and effects that bend it.
    """
    errors = fitted.line_errors
    nominal = problem.nominal_compliance_deg_per_nm
    whole, whole_error = compliance_with_curve(fitted)
    found = {
        "compliance_scale": CalibratedParameter(
            nominal=1.0, estimate=whole / nominal, std_error=finite(whole_error / nominal)
        ),
        "compliance_deg_per_nm": CalibratedParameter(
            nominal=nominal,
            estimate=fitted.line_compliance_deg_per_nm,
            std_error=finite(errors[COMPLIANCE]),
            unit="deg/(N m)",
        ),
        "free_play_deg": CalibratedParameter(
            nominal=problem.nominal_free_play_deg,
            estimate=fitted.history.free_play_deg,
            std_error=None if problem.one_sided else finite(errors[FREE_PLAY]),
            unit="deg",
        ),
        "datum_deg": CalibratedParameter(
            nominal=0.0,
            estimate=fitted.history.datum_deg,
            std_error=finite(errors[DATUM]),
            unit="deg",
        ),
    }
    zero = fitted.torque_zero
    if zero is not None:
        found["torque_zero_nm"] = CalibratedParameter(
            nominal=0.0, estimate=zero.value_nm, std_error=finite(zero.std_error_nm), unit="N m"
        )
    return found


def calibration_of(base: FittedStructure, problem: Problem) -> Mapping[str, CalibratedParameter]:
    """Return the calibration without effects; never one that falls with the torque.

    Parameters
    ----------
    base : FittedStructure
        The calibrated published model.
    problem : Problem
        The prepared recording.

    Returns
    -------
    mapping of str to CalibratedParameter
        Where the fitted line falls, that read off the flanks, without standard errors.
    """
    fitted = calibrated_parameters(base, problem)
    if base.line_compliance_deg_per_nm > 0.0:
        return fitted
    read = problem.history
    values = {
        "compliance_scale": read.compliance_deg_per_nm / problem.nominal_compliance_deg_per_nm,
        "compliance_deg_per_nm": read.compliance_deg_per_nm,
        "free_play_deg": read.free_play_deg,
        "datum_deg": read.datum_deg,
    }
    return {
        name: replace(each, estimate=values[name], std_error=None) if name in values else each
        for name, each in fitted.items()
    }


def _at_samples(problem: Problem, angle_deg: Floats, fitted: FittedStructure) -> Floats:
    """Twist given by rows, a value for every sample of the recording [deg].

    Parameters
    ----------
    problem : Problem
        The recording prepared for fitting.
    angle_deg : ndarray, shape (n,)
        Twist of the prepared rows [deg].
    fitted : FittedStructure
        Structure fitted jointly with the calibration.

    Returns
    -------
    ndarray, shape (samples,)
        In deg.
    """
    rows, history = problem.rows, fitted.history
    if not rows.thinned:
        return angle_deg
    # Between rows the line's own slope carries the torque, and what is left is interpolated.
    beside = rows.at_samples(angle_deg - history.compliance_deg_per_nm * history.applied_nm)
    zero_nm = 0.0 if fitted.torque_zero is None else fitted.torque_zero.value_nm
    return beside + history.compliance_deg_per_nm * (problem.recording.torque_nm - zero_nm)
