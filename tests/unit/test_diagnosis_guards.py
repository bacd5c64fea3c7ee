"""What a diagnosis never says: nothing missing beside a misfit, or a stiffness below zero."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.explained import explained_share
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import Decision, decide, no_more_than_fits
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.refuse import NoDiagnosisError, check_positive
from cyclosweep.diagnosis.repair import calibration_of
from cyclosweep.simulation import effects

SIGMA = 0.02


@pytest.fixture(scope="module")
def bent() -> Search:
    """Three loops of a drive that softens above 5 N m, calibrated, with nothing searched."""
    ramp = np.linspace(-1.0, 1.0, 120)
    torque = 10.0 * np.tile(np.r_[ramp, ramp[::-1]], 3)
    torque = torque[np.abs(torque) > 0.2]
    over = np.maximum(np.abs(torque) - 5.0, 0.0)
    angle = np.sign(torque) * (28.0 + 0.1 * over**2) + 2.7 * torque
    angle += SIGMA * np.random.default_rng(3).standard_normal(len(torque))
    drive = cs.Drive.reference_87()
    recording = cs.Recording.from_arrays(torque, angle)
    problem = prepare(recording, drive.nominal_line("input"), int(drive.output_pin_count))
    effect = effects.find("overload_softening")
    return calibrate(problem, build_library(problem.history, problem.fitted, [effect]), seed=0)


def test_nothing_missing_is_not_said_beside_a_misfit(
    bent: Search, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert bent.baseline.fit.rmse_deg > 3 * bent.noise.spread_deg
    # As if no hypothesis could be told from chance.
    monkeypatch.setattr(Search, "threshold", np.inf)
    decision = decide(bent)
    assert decision.verdict == "UNKNOWN_PHYSICS"
    assert decision.unexplained
    # On a dial so coarse the same misfit is rounding.
    monkeypatch.setattr(bent, "noise", replace(bent.noise, step_deg=100.0))
    assert decide(bent).verdict == "INSUFFICIENT_DATA"


def test_share_is_nothing_for_the_baseline_and_all_for_the_right_law(bent: Search) -> None:
    base = bent.baseline.fit
    nothing = explained_share(base, base, seed=0)
    assert nothing.share == 0.0
    softening = Term(effects.find("overload_softening"), {"onset_nm": 5.0, "power": 2.0})
    repaired = fit(bent.problem, bent.noise, (softening,), base)
    found = explained_share(base, repaired, seed=0)
    assert found.share is not None
    assert found.ci95 is not None
    assert found.ci95[0] <= found.share <= found.ci95[1]
    # Noise is no mismatch: the share reaches one, not one less the noise's own part.
    ideal = 1.0 - (bent.noise.spread_deg / base.rmse_deg) ** 2
    assert found.share > 0.5 * (1.0 + ideal)


def test_what_errs_by_several_times_the_noise_is_not_all(bent: Search) -> None:
    # As if a fit had ended in a bad optimum whose residual shows none of the shapes tested.
    poor = bent.baseline
    claimed = Decision("IDENTIFIED", poor, [(poor, 1.0)], False)
    assert poor.fit.rmse_deg > 2 * bent.noise.spread_deg
    for share, verdict in ((0.95, "MOSTLY_EXPLAINED"), (0.5, "UNKNOWN_PHYSICS")):
        decision = no_more_than_fits(claimed, poor, bent, share)
        assert decision.verdict == verdict
        assert decision.unexplained
    softening = Term(effects.find("overload_softening"), {"onset_nm": 5.0, "power": 2.0})
    good = bent.refit((softening,), bent.baseline.fit)
    assert no_more_than_fits(claimed, good, bent, 0.95) is claimed


def test_a_line_that_falls_is_not_stated_as_the_calibration(bent: Search) -> None:
    fallen = replace(bent.baseline.fit, beta=bent.baseline.fit.beta * np.array([1.0, -1.0, 1.0]))
    stated = calibration_of(fallen, bent.problem)
    read = bent.problem.history
    assert stated["compliance_deg_per_nm"].estimate == read.compliance_deg_per_nm > 0.0
    assert stated["compliance_scale"].estimate > 0.0
    assert stated["compliance_deg_per_nm"].std_error is None
    fitted = calibration_of(bent.baseline.fit, bent.problem)
    assert fitted["compliance_deg_per_nm"].estimate == bent.baseline.fit.beta[1]


@pytest.mark.parametrize("compliance", [0.0, -0.06])
def test_a_stiffness_at_or_below_zero_is_refused_with_the_reason(compliance: float) -> None:
    with pytest.raises(NoDiagnosisError, match="which no drive has") as refusal:
        check_positive(compliance)
    assert refusal.value.verdict == "DATA_FAULT"


def test_a_compliance_above_zero_passes() -> None:
    check_positive(1e-12)
