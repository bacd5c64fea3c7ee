"""Recordings that cannot be diagnosed: too little, or numbers that contradict the drive."""

from typing import Any

import numpy as np

import cyclosweep._core as _core
from cyclosweep.design.drive import Drive
from cyclosweep.diagnosis.identify.verdict import unit_slip
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.result import SCHEMA, Diagnosis
from cyclosweep.recording import Recording


def check(problem: Problem, drive: Drive, fewest: int) -> tuple[str, str] | None:
    """Verdict and reason where the prepared recording cannot carry a diagnosis."""
    if problem.count < fewest:
        return (
            "INSUFFICIENT_DATA",
            f"only {problem.count} readings are in contact and to be fitted; at least {fewest} "
            "are needed to calibrate stiffness, free play and datum",
        )
    torque = problem.history.applied_nm[problem.fitted]
    if float(np.ptp(np.abs(torque))) < 0.02 * float(np.abs(torque).max()):
        return "INSUFFICIENT_DATA", "the torque hardly changes, so no compliance can be read"
    return check_compliance(problem, drive, problem.history.compliance_deg_per_nm)


def check_compliance(problem: Problem, drive: Drive, compliance: float) -> tuple[str, str] | None:
    """DATA_FAULT where the compliance is outside a tenth to ten times its nominal value."""
    ratio = compliance / problem.nominal_compliance
    if 0.1 <= ratio <= 10.0:
        return None
    torque, angle = problem.history.applied_nm, problem.angle_deg
    if ratio < 0 and torque @ (angle - angle.mean()) > 0:
        return None
    if -10.0 <= ratio < 0:
        return (
            "DATA_FAULT",
            f"the angle falls as the torque rises ({compliance:.4g} deg/(N m)): the sign of angle "
            "or torque is reversed, or the drive turned under the load",
        )
    likely = unit_slip(ratio, float(drive.ratio)) if ratio > 0 else None
    hint = f"; a factor near {likely}" if likely else "; check units, side and drive file"
    side = problem.recording.side
    return (
        "DATA_FAULT",
        f"the compliance at the {side} shaft is {compliance:.4g} deg/(N m), {ratio:.4g} times the "
        f"nominal {problem.nominal_compliance:.4g}{hint}",
    )


def provenance(recording: Recording, drive: Drive, seed: int) -> dict[str, str]:
    """Where the result comes from."""
    known = {
        "cyclosweep": _core.__version__,
        "numpy": np.__version__,
        "recording": str(recording.path or recording.name),
        "drive": drive.name,
        "seed": str(seed),
    }
    if recording.sha256:
        known["sha256"] = recording.sha256
    return known


def refuse(recording: Recording, drive: Drive, verdict: str, reason: str, seed: int) -> Diagnosis:
    """Return a result that says why there is no diagnosis."""
    content: dict[str, Any] = {
        "schema": SCHEMA,
        "tolerance_deg": None,
        "verdict": verdict,
        "statement": f"{recording.name}: {reason.rstrip('.')}.",
        "noise": {
            "sigma_deg": None,
            "autocorrelation": None,
            "resolution_deg": recording.angle_resolution_deg,
        },
        "baseline": {"parameters": {}, "rmse_deg": None, "holdout_rmse_deg": None},
        "mismatch": {"p_value": None, "regions": []},
        "effects": [],
        "explanation_set": [],
        "ruled_out": [],
        "not_testable": [],
        "sufficiency": {"p_value": None},
        "repaired": {
            "parameters": {}, "rmse_deg": None, "holdout_rmse_deg": None, "holdout": "nothing",
        },
        "self_check": {"false_alarm": None, "power": None, "confusion": {}},
        "next_experiment": {
            "program": "repeat the recording once the fault is mended",
            "separates": [], "detectability": None, "minutes": None,
        },
        "model": None,
        "notes": [*recording.notes, *[f.reason for f in recording.faults]],
    }  # fmt: skip
    return Diagnosis(
        recording=recording,
        content=content,
        ratio=float(drive.ratio),
        provenance=provenance(recording, drive, seed),
    )
