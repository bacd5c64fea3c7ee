"""Noise of a white part and a slow one, as a sensor has whose zero wanders."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats
from tests.support.long_recording import long_programme

DRIVE = cs.Drive.reference_87()
MODEL = cs.Model(compliance_deg_per_nm=2.8, free_play_deg=28.0)
ROWS = 1500


def slow(rng: np.random.Generator, count: int, correlation: float) -> Floats:
    """First-order autoregression of unit variance."""
    fresh = np.sqrt(1.0 - correlation**2) * rng.normal(size=count)
    out = np.empty(count)
    out[0] = rng.normal()
    for k in range(1, count):
        out[k] = correlation * out[k - 1] + fresh[k]
    return out


def both(rng: np.random.Generator, count: int, share: float, correlation: float) -> Floats:
    """Noise of unit variance with a white share."""
    white = rng.normal(size=count)
    return np.asarray(np.sqrt(share) * white + np.sqrt(1.0 - share) * slow(rng, count, correlation))


@pytest.mark.parametrize(
    ("share", "correlation"), [(0.75, 0.97), (0.4, 0.95), (0.9, 0.97), (0.3, 0.8)]
)
def test_both_parts_are_found(share: float, correlation: float) -> None:
    rng = np.random.default_rng(7)
    x = np.linspace(-1.0, 1.0, 3000)
    basis = orthonormal(np.column_stack([x**k for k in range(8)]))
    gap = np.r_[0.0, np.ones(len(x) - 1)]
    found = [
        estimate_noise(both(rng, len(x), share, correlation), basis, gap, 0.0, np.ones(len(x)))
        for _ in range(6)
    ]
    white = [each.white_share * each.sigma_deg**2 for each in found]
    assert np.mean(white) == pytest.approx(share, abs=0.05)
    assert np.median([each.best_correlation for each in found]) == pytest.approx(
        correlation, abs=0.05
    )
    assert np.mean([each.correlation >= correlation - 0.01 for each in found]) > 0.6


@pytest.mark.parametrize("correlation", [0.0, 0.5, 0.9])
def test_noise_of_one_part_has_no_other(correlation: float) -> None:
    rng = np.random.default_rng(8)
    x = np.linspace(-1.0, 1.0, 2000)
    basis = orthonormal(np.column_stack([x**k for k in range(8)]))
    gap = np.r_[0.0, np.ones(len(x) - 1)]
    found = [
        estimate_noise(slow(rng, len(x), correlation), basis, gap, 0.0, np.ones(len(x)))
        for _ in range(6)
    ]
    assert sum(each.white_share > 0.0 for each in found) <= 1


@pytest.mark.parametrize("share", [0.75, 0.4])
def test_a_zero_that_wanders_is_no_missing_physics(share: float) -> None:
    """Of such recordings nearly all were said to miss something."""
    programme = long_programme(ROWS)
    angle = cs.simulate(MODEL, programme).angle_deg
    assert angle is not None
    alarms = 0
    for seed in range(6):
        rng = np.random.default_rng([seed, int(100 * share)])
        noise = 0.05 * both(rng, len(angle), share, 0.95)
        found = cs.diagnose(programme.with_angle(angle + noise), DRIVE, full=False)
        assert found.effects == []
        alarms += found.verdict not in {"NOTHING_MISSING", "INSUFFICIENT_DATA"}
    assert alarms <= 1


def test_a_cause_is_found_beside_a_zero_that_wanders(tmp_path: Path) -> None:
    programme = long_programme(ROWS)
    effect = EffectValue("contact_stiffening", {"turn_nm": 2.0}, (0.15,))
    angle = cs.simulate(cs.Model(2.8, 28.0, effects=(effect,)), programme).angle_deg
    assert angle is not None
    rng = np.random.default_rng(5)
    noise = 0.05 * both(rng, len(angle), 0.6, 0.95)
    found = cs.diagnose(programme.with_angle(angle + noise), DRIVE, full=False)
    assert found.verdict == "IDENTIFIED"
    assert [each["name"] for each in found.effects] == ["contact_stiffening"]
    noise = found.content["noise"]
    assert noise["white_share"] == pytest.approx(0.6, abs=0.2)
    assert noise["autocorrelation"] == pytest.approx(0.4 * 0.95, abs=0.2)
    page = found.report(tmp_path / "report.html").read_text("utf-8")
    assert "new in every reading, and a slow part of" in page
