"""Recordings that cannot be diagnosed: too little, or numbers that contradict the drive."""

import numpy as np

from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.identify.fitting.fit import FEWEST_FITTED
from cyclosweep.diagnosis.left_out import in_words, left_out_by_settings
from cyclosweep.diagnosis.mistakes import likely_mistakes, with_others
from cyclosweep.diagnosis.outcome import Diagnosis
from cyclosweep.diagnosis.plausibility import FAR_COMPLIANCE, compliance_beside_sliding
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.provenance import provenance_of
from cyclosweep.recording import Recording
from cyclosweep.recording.exchanged_columns import EXCHANGED, are_exchanged
from cyclosweep.report.straight_lines import straight_lines
from cyclosweep.result import Answer, NextExperiment, NoiseEstimate, Repair, SelfCheck, Verdict

LEAST_CHANGE = 0.02
"""Share of the largest torque by which the torque has to change for a compliance to be read."""
PLAUSIBLE = (0.1, 10.0)
"""Compliance, as a multiple of its nominal value, outside which units or sides are mistaken."""


RECORD_AGAIN = "mend the fault and repeat the recording"
RECORD_MORE = "repeat the recording with {}"
ANEW = "and diagnose the same file again; nothing has to be recorded anew"
SETTINGS = f"correct {{}} in the settings (the TOML file) or the drive file {ANEW}"
SETTINGS_ALONE = f"correct {{}} in the settings (the TOML file) {ANEW}"
SETTINGS_OR_RIG = (
    "look first at {} in the settings (the TOML file) and diagnose the same file again; only where "
    "they are right, {} and repeat the recording"
)
MEND = {
    "absurd_value": SETTINGS.format("the unit or the column"),
    "unrelated": SETTINGS_OR_RIG.format(
        "the columns of torque and angle", "mend the sensor that does not follow"
    ),
    "missing_values": SETTINGS_OR_RIG.format(
        "the columns of torque and angle", "mend what loses the readings"
    ),
    "run_split": SETTINGS_OR_RIG.format(
        "the column of the run and the order of the rows", "number the runs as they are recorded"
    ),
    "time_backwards": SETTINGS_OR_RIG.format(
        "the column and unit of the time and the column of the run", "mend the clock"
    ),
    "too_few_selected": SETTINGS_ALONE.format("[select]"),
    "too_few_samples": RECORD_MORE.format("more readings: loading, unloading, both directions"),
    "constant_torque": RECORD_MORE.format("a load that rises and falls in both directions"),
    "constant_angle": SETTINGS_OR_RIG.format("the column of the angle", "mend the angle sensor"),
    "saturation": RECORD_MORE.format("a range of the sensor that holds the whole load"),
}
"""What to do about a fault that was found on reading, by its kind."""


class NoDiagnosisError(Exception):
    """A stage found that the recording cannot be diagnosed; `diagnose` turns it into an answer."""

    def __init__(self, verdict: Verdict, reason: str, mend: str = RECORD_AGAIN) -> None:
        super().__init__(reason)
        self.verdict: Verdict = verdict
        self.reason = reason
        self.mend = mend


def check_recording(recording: Recording) -> None:
    """Raise `NoDiagnosisError` where reading the recording found a fault that forbids it.

    Parameters
    ----------
    recording : Recording
        What was measured.

    Raises
    ------
    NoDiagnosisError
        The first fault with a verdict, or settings that leave hardly a reading under load.
    """
    fault = recording.blocking_fault
    if fault is not None and fault.verdict is not None:
        raise NoDiagnosisError(fault.verdict, fault.reason, MEND.get(fault.kind, RECORD_AGAIN))
    loaded = np.count_nonzero(recording.torque_nm)
    held = recording.in_runs(recording.holdout_runs)
    fitted = np.count_nonzero(recording.torque_nm[recording.counts & ~held])
    left_out = left_out_by_settings(recording)
    if left_out and fitted < FEWEST_FITTED <= loaded:
        raise NoDiagnosisError(
            "INSUFFICIENT_DATA",
            f"{fitted or 'none'} of the {loaded} readings under load are to be fitted, and at "
            f"least {FEWEST_FITTED} are needed: {in_words(left_out)}",
            SETTINGS_ALONE.format(" and ".join(left_out)),
        )


def check_prepared(problem: Problem, drive: Drive) -> None:
    """Raise `NoDiagnosisError` where the prepared recording cannot carry a diagnosis.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    drive : Drive
        The drive it was taken on.

    Raises
    ------
    NoDiagnosisError
        Too few readings, a torque that hardly changes, or an impossible compliance.
    """
    if problem.count < FEWEST_FITTED:
        raise _too_little(
            problem,
            f"only {problem.count} readings are in contact and to be fitted; at least "
            f"{FEWEST_FITTED} are needed to calibrate stiffness, free play and datum",
            "more readings under load, loading and unloading",
        )
    torque = problem.history.applied_nm[problem.fitted]
    if float(np.ptp(np.abs(torque))) < LEAST_CHANGE * float(np.abs(torque).max()):
        both = torque.min() < 0.0 < torque.max()
        what = "under load the torque has one size only" if both else "the torque hardly changes"
        raise _too_little(
            problem,
            f"{what}, so no compliance can be read",
            "a load that rises and falls in both directions",
        )
    check_compliance(problem, drive, problem.history.compliance_deg_per_nm)


def _too_little(problem: Problem, reason: str, more: str) -> NoDiagnosisError:
    """Return the error for a recording of which too little is fitted.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    reason : str
        What is too little.
    more : str
        What a better recording would have.

    Returns
    -------
    NoDiagnosisError
        It asks for the settings first where they leave out readings under load.
    """
    left_out = left_out_by_settings(problem.recording)
    if not left_out:
        return NoDiagnosisError("INSUFFICIENT_DATA", reason, RECORD_MORE.format(more))
    loaded = np.count_nonzero(problem.recording.torque_nm)
    return NoDiagnosisError(
        "INSUFFICIENT_DATA",
        f"{reason}; of {loaded} readings under load, {in_words(left_out)}",
        SETTINGS_OR_RIG.format(" and ".join(left_out), f"load what is fitted with {more}"),
    )


def check_compliance(problem: Problem, drive: Drive, compliance: float) -> None:
    """Raise `NoDiagnosisError` where the compliance is outside a tenth to ten times its nominal.

    Where the loop is so wide that sliding friction may be taken for compliance, the slopes after
    reversals decide.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    drive : Drive
        The drive it was taken on.
    compliance : float
        Compliance as read or fitted at the measured shaft [deg/(N m)].

    Raises
    ------
    NoDiagnosisError
        With the factor named where it is near one that a unit or a side explains.
    """
    lower, upper = PLAUSIBLE
    ratio = compliance / problem.nominal_compliance_deg_per_nm
    if lower <= ratio <= upper:
        return
    _refuse_exchanged(problem, compliance)
    torque, angle = problem.history.applied_nm, problem.angle_deg
    if ratio < 0 and torque @ (angle - angle.mean()) > 0:
        return
    if -upper <= ratio < 0:
        raise NoDiagnosisError(
            "DATA_FAULT",
            f"the angle falls as the torque rises ({compliance:.4g} deg/(N m)): the sign of angle "
            "or torque is reversed, or the drive turned under the load",
            SETTINGS_OR_RIG.format("the sign of angle and torque", "hold the locked shaft"),
        )
    where = f"at the {problem.recording.side} shaft"
    nominal = problem.nominal_compliance_deg_per_nm
    likely = _likely(problem, ratio, float(drive.ratio)) if ratio > 0 else ()
    turned = compliance_beside_sliding(problem.recording)
    if turned is not None and turned * FAR_COMPLIANCE >= nominal:
        if lower <= turned / nominal <= upper:
            return
        likely = likely_mistakes(turned / nominal, None, float(drive.ratio)) or likely
        compliance, ratio = turned, turned / nominal
        where += " right after reversals, before friction slips again,"
    elif turned is not None and turned > 0 and ratio < lower:
        likely = with_others(likely_mistakes(turned / nominal, None, float(drive.ratio)), likely)
    hint = "; check units, side and drive file"
    if likely:
        hint = f", as where {' or '.join(likely)}"
    raise NoDiagnosisError(
        "DATA_FAULT",
        f"the compliance {where} is {compliance:.4g} deg/(N m), "
        f"{ratio:.4g} times the nominal {nominal:.4g}{hint}",
        SETTINGS.format("unit, side or drive"),
    )


def _refuse_exchanged(problem: Problem, compliance: float) -> None:
    """Raise `NoDiagnosisError` where torque and angle look exchanged.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    compliance : float
        Compliance as read or fitted, which no drive of this file has [deg/(N m)].

    Raises
    ------
    NoDiagnosisError
        It asks for the columns.
    """
    recording, nominal = problem.recording, problem.nominal_compliance_deg_per_nm
    angle = recording.angle_deg
    if angle is None or nominal <= 0 or not are_exchanged(recording.torque_nm, angle, nominal):
        return
    raise NoDiagnosisError(
        "DATA_FAULT",
        f"the compliance at the {recording.side} shaft is {compliance:.4g} deg/(N m), where the "
        f"drive file says {nominal:.4g}, as where {EXCHANGED}",
        SETTINGS_ALONE.format("the columns of torque and angle"),
    )


def _likely(problem: Problem, factor: float, ratio: float) -> tuple[str, ...]:
    """Mistakes that explain an impossible compliance; those that the play contradicts come last.

    Parameters
    ----------
    problem : Problem
        The prepared recording.
    factor : float
        Compliance over its nominal value.
    ratio : float
        Ratio of the drive.

    Returns
    -------
    tuple of str
        In words, empty where none fits.
    """
    play = None
    if not problem.one_sided and problem.nominal_free_play_deg > 0:
        play = problem.history.free_play_deg / problem.nominal_free_play_deg
    lines = [line.compliance_deg_per_nm for line in straight_lines(problem.recording)]
    if lines and (middle := float(np.mean(lines)) / problem.nominal_compliance_deg_per_nm) > 0:
        # Friction that holds stiffens the fitted line, and cancels in the middle of the loop.
        likely = likely_mistakes(middle, play, ratio) or likely_mistakes(middle, None, ratio)
        if likely:
            return likely
    return likely_mistakes(factor, play, ratio) or likely_mistakes(factor, None, ratio)


def check_positive(compliance: float) -> None:
    """Raise `NoDiagnosisError` where a fitted compliance [deg/(N m)] is not above zero.

    Parameters
    ----------
    compliance : float
        Compliance of the calibrated or repaired model at the measured shaft [deg/(N m)].

    Raises
    ------
    NoDiagnosisError
        A stiffness at or below zero means that the torque does not fix the twist.
    """
    if compliance > 0:
        return
    raise NoDiagnosisError(
        "DATA_FAULT",
        f"the best fit has a compliance of {compliance:.4g} deg/(N m), which no drive has: the "
        "angle changes where the torque does not, as while parts slide on each other or where the "
        "motion is driven instead of the torque; no stiffness can be read from it",
        RECORD_MORE.format("the torque controlled, below the friction limit of the drive"),
    )


def refused(recording: Recording, drive: Drive, refusal: NoDiagnosisError, seed: int) -> Diagnosis:
    """Return the result that says why there is no diagnosis.

    Parameters
    ----------
    recording : Recording
        What was to be diagnosed.
    drive : Drive
        The drive it was taken on.
    refusal : NoDiagnosisError
        Verdict and reason.
    seed : int
        Seed of the diagnosis, for the record.

    Returns
    -------
    Diagnosis
    """
    reason = refusal.reason if refusal.reason.endswith(("?", ".")) else f"{refusal.reason}."
    answer = Answer(
        verdict=refusal.verdict,
        statement=f"{recording.name}: {reason}",
        summary=f"{reason[:1].upper()}{reason[1:]}",
        do_now=f"{refusal.mend[:1].upper()}{refusal.mend[1:]}.",
        noise=NoiseEstimate(resolution_deg=recording.angle_resolution_deg),
        repaired=Repair(holdout="nothing"),
        self_check=SelfCheck(),
        next_experiment=NextExperiment(program=refusal.mend),
        notes=(*recording.notes, *(fault.reason for fault in recording.faults)),
    )
    return Diagnosis(
        recording=recording,
        answer=answer,
        ratio=float(drive.ratio),
        provenance=provenance_of(recording, drive, seed),
    )
