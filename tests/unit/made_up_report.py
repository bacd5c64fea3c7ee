"""A made-up diagnosis with everything in it, to build and test the report against."""

import numpy as np

import cyclosweep as cs
from cyclosweep.report import HeldOut, ReportData
from cyclosweep.result import Answer, Hypothesis, answer_of
from cyclosweep.result.effects import Outcome

C = 2.73  # compliance at the input [deg/(N m)]
GAP = 28.0  # free play on each side [deg]
RATED = 7.2575
SIGMA = 0.2


def load_history(runs: int = 6, samples: int = 400) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Torque, run and time of alternating loops of growing amplitude."""
    phase = np.linspace(0, 2 * np.pi, samples)
    torque, run = [], []
    for k in range(runs):
        torque.append((2.0 + 0.5 * k) * RATED * np.sin(phase))
        run.append(np.full(samples, k + 1))
    joined = np.concatenate(torque)
    keep = np.abs(joined) > 0.25
    return joined[keep], np.concatenate(run)[keep], np.arange(len(joined), dtype=float)[keep] * 2.0


def make(runs: int = 6, samples: int = 400) -> ReportData:
    """Friction hysteresis and softening over a calibrated straight line."""
    torque, run, time = load_history(runs, samples)
    rng = np.random.default_rng(7)
    line = GAP * np.sign(torque) + C * torque
    loading = torque * np.gradient(torque) > 0
    friction = np.where(loading, -0.55, 0.55) * np.sign(torque)
    softening = 0.0075 * np.sign(torque) * np.maximum(np.abs(torque) - 2.5 * RATED, 0) ** 2
    after = line + friction + softening
    angle = after + rng.normal(scale=SIGMA, size=len(torque))
    recording = cs.Recording.from_arrays(
        torque,
        angle,
        time_s=time,
        run=run,
        crank_deg=37.0 * run % 360.0,
        temperature_c=21.0 + 0.001 * time,
        name="rig-3-monday",
        drive="reference-87",
        notes=("Dial wraps at 360 deg: 12 wraps undone.",),
        holdout_runs=(runs,),
    )
    before = line + 0.02 * torque
    return ReportData(
        recording=recording,
        result=result(before, after, angle),
        before_deg=before,
        after_deg=after,
        rated_torque_nm=RATED,
        ratio=87.0,
        hypotheses=(
            hypothesis("friction_hysteresis", "accepted", 0.55, 0.0005, 1.2e6, 0.02),
            hypothesis("overload_softening", "accepted", 0.9, 0.0005, 310.0, 0.41),
            hypothesis("contact_stiffening", "ruled out", 0.02, 0.61, 0.4, 0.91),
            hypothesis("load_dependent_friction", "undecided", 0.06, 0.08, 2.1, 0.35),
            hypothesis("creep", "ruled out", 0.01, 0.8, 0.2, 0.62),
            Hypothesis(name="thermal_drift", outcome="not testable"),
        ),
        held_out=(
            HeldOut(block="run 6 (largest amplitude)", samples=390, rmse_before_deg=1.31,
                    rmse_after_deg=0.21, floor_deg=0.2),
            HeldOut(block="run 3", samples=392, rmse_before_deg=0.62, rmse_after_deg=0.2,
                    floor_deg=0.2),
        ),
        provenance={"cyclosweep": "0.1.0", "seed": "1", "drive": "reference-87"},
    )  # fmt: skip


def hypothesis(
    name: str, outcome: Outcome, size: float, p: float, e: float, absorbed: float
) -> Hypothesis:
    """Row of the hypothesis table with an interval around its size."""
    return Hypothesis(
        name=name,
        outcome=outcome,
        absorbed_share=absorbed,
        size_deg=size,
        ci95_deg=(size - 0.04, size + 0.04),
        p_value=p,
        e_value=e,
        smallest_detectable_deg=0.05,
    )


def result(before: np.ndarray, after: np.ndarray, angle: np.ndarray) -> Answer:
    """Answer of the made-up diagnosis."""

    def rms(values: np.ndarray) -> float:
        return float(np.sqrt(np.mean(values**2)))

    return answer_of({
        "schema": "cyclosweep.diagnosis/1",
        "tolerance_deg": 0.6,
        "verdict": "IDENTIFIED",
        "statement": "Two effects are missing from the model: Coulomb friction that opens the loop "
        "by 1.1 deg at every torque, and a compliance that grows above 18 N m, worth 0.9 deg at "
        "the largest load. With both, the error on run 6, which was not used, falls from 1.31 to "
        "0.21 deg, the noise floor. Stiffness is 4 % below nominal, which is calibration.",
        "noise": {"sigma_deg": SIGMA, "autocorrelation": 0.05, "resolution_deg": 0.0},
        "baseline": {
            "parameters": {
                "compliance_scale": {"nominal": 1, "estimate": 1.04, "std_error": 0.001,
                                     "unit": ""},
                "free_play": {"nominal": 28, "estimate": 27.6, "std_error": 0.02, "unit": "deg"},
                "datum": {"nominal": 0, "estimate": -0.31, "std_error": 0.01, "unit": "deg"},
            },
            "rmse_deg": rms(angle - before),
            "holdout_rmse_deg": 1.31,
        },
        "mismatch": {
            "p_value": 0.0005,
            "regions": [
                {"torque_nm": [21.5, 32.6], "direction": "loading", "run": [4, 6], "time_s": None,
                 "crank_deg": None, "temperature_c": None, "mean_residual_deg": 0.8,
                 "share_of_excess": 0.6, "p_value": 0.0005},
                {"torque_nm": [-32.6, -24.0], "direction": "both", "run": [1, 6], "time_s": None,
                 "crank_deg": None, "temperature_c": None, "mean_residual_deg": -0.6,
                 "share_of_excess": 0.3, "p_value": 0.001},
            ],
        },
        "effects": [
            {"name": "friction_hysteresis",
             "physics": "Coulomb friction in mesh, bushes and bearings holds the twist back on the "
             "way up and keeps it on the way down. Slip sets in over a presliding distance.",
             "parameters": {"friction_torque": {"estimate": 0.2, "std_error": 0.004,
                                                "unit": "N m"}},
             "size_deg": {"estimate": 0.55, "ci95": [0.51, 0.59]}, "size_nm": 0.31,
             "p_value": 0.0005, "e_value": 1.2e6, "detectability": 71.0},
            {"name": "overload_softening",
             "physics": "Compliance grows above a load, as contacts at the edge of their seats do.",
             "parameters": {"onset": {"estimate": 18.1, "std_error": 0.4, "unit": "N m"}},
             "size_deg": {"estimate": 0.9, "ci95": [0.86, 0.94]},
             "p_value": 0.0005, "e_value": 310.0, "detectability": 14.2},
        ],
        "explanation_set": [
            {"effects": ["friction_hysteresis", "overload_softening"], "probability": 0.97},
            {"effects": ["friction_hysteresis", "clearance_takeup"], "probability": 0.03},
        ],
        "ruled_out": [
            {"name": "creep", "upper95_deg": 0.05},
            {"name": "contact_stiffening", "upper95_deg": 0.07},
        ],
        "not_testable": [
            {"name": "rig_compliance", "reason": "it is in series with the drive and has the same "
             "shape as its compliance", "needs": "a rigid blank in place of the drive"},
            {"name": "thermal_drift", "reason": "temperature and time rise together",
             "needs": "a warm soak without load"},
        ],
        "sufficiency": {"p_value": 0.42},
        "repaired": {
            "parameters": {
                "compliance_scale": {"estimate": 1.031, "std_error": 0.001, "unit": ""},
                "free_play": {"estimate": 28.05, "std_error": 0.03, "unit": "deg"},
                "datum": {"estimate": -0.31, "std_error": 0.01, "unit": "deg"},
                "friction_torque": {"estimate": 0.2, "std_error": 0.004, "unit": "N m"},
            },
            "rmse_deg": rms(angle - after),
            "holdout_rmse_deg": 0.21,
            "holdout": "run 6",
        },
        "self_check": {
            "false_alarm": 0.01,
            "power": 0.97,
            "confusion": {"friction_hysteresis": {"friction_hysteresis": 0.97, "creep": 0.02}},
        },
        "next_experiment": {
            "program": "Nested loops at 15 and 30 N m, each at three speeds, with a hold of 5 min",
            "separates": ["overload_softening", "clearance_takeup"],
            "detectability": 9.0,
            "minutes": 40,
        },
        "model": "model.json",
    })  # fmt: skip
