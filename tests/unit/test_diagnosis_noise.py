"""Noise: size, autocorrelation and tails from a flexible basis; the interval likelihood."""

import numpy as np
import pytest

from cyclosweep.diagnosis.prepare.noise import interval_score, orthonormal
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from tests.support.arrays import Floats


def material(n: int = 2000, seed: int = 1) -> tuple[np.random.Generator, Floats, Floats, Floats]:
    rng = np.random.default_rng(seed)
    x = np.linspace(-1, 1, n)
    basis = orthonormal(np.column_stack([x**k for k in range(8)]))
    gap = np.ones(n)
    gap[0] = 0
    return rng, x, basis, gap


def coloured(rng: np.random.Generator, n: int, rho: float) -> Floats:
    out = np.zeros(n)
    out[0] = rng.normal()
    for i in range(1, n):
        out[i] = rho * out[i - 1] + np.sqrt(1 - rho**2) * rng.normal()
    return out


@pytest.mark.parametrize("rho", [0.0, 0.3, 0.8])
def test_autocorrelation_is_found_and_estimated_from_above(rho: float) -> None:
    rng, x, basis, gap = material()
    upper, size = [], []
    for _ in range(10):
        noise = estimate_noise(
            30 * x + 0.2 * coloured(rng, len(x), rho), basis, gap, 0.0, np.ones(len(x))
        )
        upper.append(noise.correlation)
        size.append(noise.sigma_deg)
    assert np.mean(upper) == pytest.approx(rho, abs=0.06)
    assert np.mean(np.array(upper) >= rho - 0.01) > 0.6
    assert np.mean(size) == pytest.approx(0.2, rel=0.1)


def test_whitening_makes_white() -> None:
    rng, x, basis, gap = material()
    angle = 0.2 * coloured(rng, len(x), 0.7)
    noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(x)))
    white, _ = noise.residual(angle, np.zeros(len(x)))
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.07
    assert np.std(white) == pytest.approx(1.0, abs=0.06)


def test_heavy_tails_are_recognised() -> None:
    rng, x, basis, gap = material()
    angle = 0.1 * rng.standard_t(3, len(x))
    noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(x)))
    assert noise.tail < 7
    score, _ = noise.residual(angle, np.zeros(len(x)))
    assert np.max(np.abs(score)) < 6


def test_the_residual_has_unit_variance_where_outliers_follow_no_tail() -> None:
    # Normal readings with some far off: no Student's distribution has that score.
    rng, x, basis, gap = material(4000)
    squares = []
    for _ in range(12):
        far = np.where(rng.random(len(x)) < 0.03, 8.0, 1.0)
        angle = 0.1 * far * rng.normal(size=len(x))
        noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(x)))
        assert np.isfinite(noise.tail)
        white, _ = noise.residual(angle, np.zeros(len(x)))
        squares.append(np.mean(white**2))
    assert np.mean(squares) == pytest.approx(1.0, abs=0.015)


@pytest.mark.parametrize("sigma", [0.02, 0.05])
def test_noise_behind_a_coarse_dial(sigma: float) -> None:
    rng, x, basis, gap = material()
    angle = np.round((30 * x + sigma * rng.normal(size=len(x))) / 0.5) * 0.5
    noise = estimate_noise(angle, basis, gap, 0.5, np.ones(len(x)))
    assert noise.step_deg == 0.5
    assert noise.sigma_deg == pytest.approx(sigma, rel=0.35)


def test_a_coarse_dial_keeps_how_steps_are_counted() -> None:
    # The clock runs at uneven steps, but the noise correlates from row to row.
    rng, x, basis, gap = material(3000)
    white = 0.1 * rng.normal(size=len(x))
    noise = np.empty(len(x))
    noise[0] = white[0]
    for k in range(1, len(x)):
        noise[k] = 0.8 * noise[k - 1] + 0.6 * white[k]
    angle = np.round((30 * x + noise) / 0.5) * 0.5
    uneven = np.where(gap > 0, rng.choice([0.25, 1.0, 3.0], len(gap)), 0.0)
    found = estimate_noise(angle, basis, uneven, 0.5, np.ones(len(x)), gap)
    assert found.step_deg == 0.5
    assert found.by_rows
    np.testing.assert_array_equal(found.gap, gap)


def test_fine_dial_counts_as_noise() -> None:
    rng, x, basis, gap = material()
    angle = np.round((30 * x + 0.2 * rng.normal(size=len(x))) / 0.5) * 0.5
    noise = estimate_noise(angle, basis, gap, 0.5, np.ones(len(x)))
    assert noise.step_deg == 0
    assert noise.sigma_deg == pytest.approx(np.hypot(0.2, 0.5 / np.sqrt(12)), rel=0.08)


def test_interval_score_is_unbiased_with_its_information() -> None:
    rng = np.random.default_rng(2)
    mean = rng.uniform(0, 10, 40000)
    read = np.round((mean + 0.1 * rng.normal(size=len(mean))) / 0.5) * 0.5
    score, information = interval_score(read, mean, 0.1, 0.5)
    assert abs(np.mean(score)) < 4 * np.std(score) / np.sqrt(len(score))
    assert np.mean(score**2) == pytest.approx(np.mean(information), rel=0.05)
    assert np.all(information <= 1 / 0.1**2 + 1e-9)
