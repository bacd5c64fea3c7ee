"""What a diagnosis never says: nothing missing beside a misfit, or a stiffness below zero."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.explained import explained_share
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.verdict import decide
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.refuse import NoDiagnosisError, check_positive
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
    monkeypatch.setattr(bent, "threshold", np.inf)
    decision = decide(bent, [], 0.0)
    assert decision.verdict == "UNKNOWN_PHYSICS"
    assert decision.unexplained
    # On a dial so coarse the same misfit is rounding.
    monkeypatch.setattr(bent, "problem", replace(bent.problem, resolution_deg=100.0))
    assert decide(bent, [], 0.0).verdict == "INSUFFICIENT_DATA"


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


@pytest.mark.parametrize("compliance", [0.0, -0.06])
def test_a_stiffness_at_or_below_zero_is_refused_with_the_reason(compliance: float) -> None:
    with pytest.raises(NoDiagnosisError, match="which no drive has") as refusal:
        check_positive(compliance)
    assert refusal.value.verdict == "DATA_FAULT"


def test_a_compliance_above_zero_passes() -> None:
    check_positive(1e-12)
