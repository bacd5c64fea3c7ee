"""Noise: size, autocorrelation and tails from a flexible basis; the interval likelihood."""

import numpy as np
import pytest
from scipy.signal import lfilter

from cyclosweep.diagnosis.prepare.noise import Noise, orthonormal
from cyclosweep.diagnosis.prepare.noise_estimate import estimate_noise
from cyclosweep.diagnosis.prepare.row_score import interval_score
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


@pytest.mark.parametrize("sizes_off", [0.0, 80.0])
def test_two_readings_far_off_make_no_model_error_of_slow_noise(sizes_off: float) -> None:
    rng, x, basis, gap = material(3000)
    angle = 30 * x + 0.1 * lfilter([1.0], [1.0, -0.93], rng.normal(size=len(x)))
    angle[[1000, 2200]] += 0.1 * sizes_off
    noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(x)))
    assert not noise.structured
    assert noise.correlation > 0.9


def test_errors_that_gather_at_reversals_are_model_error() -> None:
    rng, x, basis, gap = material(3000)
    louder = np.where(np.abs(np.sin(6 * np.pi * x)) > 0.9, 12.0, 1.0)
    angle = 30 * x + lfilter([0.1], [1.0, -0.93], louder * rng.normal(size=len(x)))
    assert estimate_noise(angle, basis, gap, 0.0, np.ones(len(x))).structured


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


def test_rounding_does_not_hide_how_slow_the_noise_is() -> None:
    # A dial of 2.3 times the noise, passed by some steps from reading to reading: one reading
    # correlates with the next by 0.7 only.
    rng, x, _, gap = material(3000)
    clean = 300 * rng.permutation(x)
    basis = orthonormal(np.column_stack([np.ones_like(x), clean, clean**2, clean**3]))
    step, rho = 0.46, 0.97
    best, upper, beside = [], [], []
    for _ in range(4):
        angle = np.round((clean + 0.2 * coloured(rng, len(x), rho)) / step) * step
        noise = estimate_noise(angle, basis, gap, step, np.ones(len(x)))
        assert noise.step_deg == 0
        white, _ = noise.residual(angle, clean)
        later = [np.corrcoef(white[k:], white[:-k])[0, 1] for k in range(1, 12)]
        beside.append(np.sum(later))
        best.append(noise.best_correlation)
        upper.append(noise.correlation)
    assert np.mean(best) == pytest.approx(rho, abs=0.02)
    assert np.mean(np.array(upper) >= rho) >= 0.75
    # The slow part is gone: its correlations would add up to several.
    assert np.mean(beside) == pytest.approx(0.0, abs=0.15)


def test_quiet_readings_of_a_held_torque_on_a_dial_are_no_error_of_a_model() -> None:
    # While the torque is held, a dial of 2.5 times slow noise mostly stands still.
    rng, x, _, gap = material(3000)
    clean = 300 * rng.permutation(x)
    clean[1200:1350] = 100.0
    clean[2200:2350] = -100.0
    basis = orthonormal(np.column_stack([np.ones_like(x), clean, clean**2, clean**3]))
    for _ in range(3):
        angle = np.round((clean + 0.2 * coloured(rng, len(x), 0.97)) / 0.5) * 0.5
        noise = estimate_noise(angle, basis, gap, 0.5, np.ones(len(x)))
        assert not noise.structured
        assert noise.correlation >= 0.95


def test_loud_stretches_are_an_error_of_the_model_on_a_dial_too() -> None:
    rng, x, _, gap = material(3000)
    clean = 300 * rng.permutation(x)
    basis = orthonormal(np.column_stack([np.ones_like(x), clean, clean**2, clean**3]))
    size = np.where(np.abs(x) % 0.5 < 0.1, 6.0, 1.0)
    angle = np.round((clean + 0.4 * size * coloured(rng, len(x), 0.97)) / 0.5) * 0.5
    assert estimate_noise(angle, basis, gap, 0.5, np.ones(len(x))).structured


def test_rounding_of_white_noise_makes_none_of_it_slow() -> None:
    rng, x, basis, gap = material(3000)
    for _ in range(4):
        angle = np.round((30 * x + 0.2 * rng.normal(size=len(x))) / 0.4) * 0.4
        noise = estimate_noise(angle, basis, gap, 0.4, np.ones(len(x)))
        assert noise.white_share == 0.0
        assert noise.correlation < 0.1


def test_whitening_of_correlated_and_white_noise_is_that_of_its_covariance() -> None:
    rng = np.random.default_rng(5)
    gap = rng.choice([0.0, 0.5, 1.0, 3.0], 60)
    gap[0] = 0.0
    noise = Noise(1.0, 0.9, 0.9, np.inf, 0.0, 59.0, gap, white_share=0.3)
    pair = np.where(gap > 0, 0.9**gap, 0.0)
    covariance = np.eye(60)
    for row in range(60):
        for before in range(row):
            covariance[row, before] = 0.7 * np.prod(pair[before + 1 : row + 1])
            covariance[before, row] = covariance[row, before]
    filtered = noise.whiten(np.eye(60))
    np.testing.assert_allclose(filtered @ covariance @ filtered.T, np.eye(60), atol=1e-12)
    assert noise.log_determinant == pytest.approx(np.linalg.slogdet(covariance)[1], abs=1e-10)
    one = rng.normal(size=60)
    np.testing.assert_allclose(noise.whiten(one), filtered @ one, atol=1e-12)


@pytest.mark.parametrize("white_share", [0.0, 0.2])
@pytest.mark.parametrize("correlation", [0.0, 0.6])
@pytest.mark.parametrize("width", [1, 5])
def test_columns_are_whitened_together_as_each_alone(
    width: int, correlation: float, white_share: float
) -> None:
    rng = np.random.default_rng(3)
    gap = np.r_[0.0, rng.choice([0.0, 1.0, 2.5], 299)]
    noise = Noise(0.1, correlation, correlation, np.inf, 0.0, 290.0, gap, white_share=white_share)
    columns, weight = rng.normal(size=(width, 300)).T, rng.uniform(5.0, 9.0, 300)
    given = columns.copy()
    together = noise.design(columns, weight)
    assert together.shape == columns.shape
    np.testing.assert_array_equal(columns, given)
    for k in range(width):
        np.testing.assert_array_equal(together[:, k], noise.design(columns[:, k], weight))


def test_interval_score_is_unbiased_with_its_information() -> None:
    rng = np.random.default_rng(2)
    mean = rng.uniform(0, 10, 40000)
    read = np.round((mean + 0.1 * rng.normal(size=len(mean))) / 0.5) * 0.5
    score, information = interval_score(read, mean, 0.1, 0.5)
    assert abs(np.mean(score)) < 4 * np.std(score) / np.sqrt(len(score))
    assert np.mean(score**2) == pytest.approx(np.mean(information), rel=0.05)
    assert np.all(information <= 1 / 0.1**2 + 1e-9)


def _steps_and_noise(rho: float, jumps: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Angle over 3,000 rows with white noise on a zero that jumps, or with noise that is slow."""
    rng = np.random.default_rng(seed)
    count = 3000
    if jumps:
        level = np.repeat(rng.normal(0.0, jumps, count // 100), 100)
        return level + rng.normal(0.0, 0.05, count), np.r_[0.0, np.ones(count - 1)]
    slow = np.empty(count)
    slow[0] = rng.normal(0.0, 0.05)
    for k in range(1, count):
        slow[k] = rho * slow[k - 1] + np.sqrt(1 - rho**2) * rng.normal(0.0, 0.05)
    return slow, np.r_[0.0, np.ones(count - 1)]


@pytest.mark.parametrize("seed", range(3))
def test_a_zero_that_jumps_is_no_noise(seed: int) -> None:
    angle, gap = _steps_and_noise(0.0, 0.3, seed)
    basis = orthonormal(np.vander(np.linspace(-1, 1, len(angle)), 6))
    noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(angle)))
    assert noise.structured
    assert noise.sigma_deg == pytest.approx(0.05, rel=0.1)


@pytest.mark.parametrize("rho", [0.9, 0.97, 0.99])
def test_slow_noise_is_noise(rho: float) -> None:
    angle, gap = _steps_and_noise(rho, 0.0, 7)
    basis = orthonormal(np.vander(np.linspace(-1, 1, len(angle)), 6))
    noise = estimate_noise(angle, basis, gap, 0.0, np.ones(len(angle)))
    assert not noise.structured
    assert noise.correlation >= rho - 0.02


def test_columns_that_are_all_zero_span_nothing() -> None:
    assert orthonormal(np.zeros((5, 2))).shape == (5, 0)
    assert orthonormal(np.zeros((5, 0))).shape == (5, 0)
    some = orthonormal(np.column_stack([np.zeros(5), np.ones(5)]))
    np.testing.assert_allclose(np.abs(some), np.full((5, 1), 5**-0.5))
