"""Misfit of a mean: what it lacks in log likelihood, whatever the tails of the noise."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from cyclosweep.diagnosis.prepare.noise import Noise
from tests.support.searches import search_of


@pytest.fixture(scope="module")
def noise() -> Noise:
    """White Gaussian noise of a recording."""
    return replace(search_of().noise.plain, correlation=0.0, white_share=0.0)


def test_misfit_is_twice_the_log_likelihood_that_is_lost(noise: Noise) -> None:
    left = np.linspace(-40.0, 40.0, len(noise.gap)) * noise.sigma_deg
    mean = np.zeros_like(left)
    assert noise.misfit(left, mean) == pytest.approx(np.sum((left / noise.sigma_deg) ** 2))
    tail = 5.0
    scale = noise.sigma_deg * np.sqrt((tail - 2.0) / tail)
    lost = stats.t.logpdf(0.0, tail, scale=scale) - stats.t.logpdf(left, tail, scale=scale)
    heavy = replace(noise, tail=tail)
    assert heavy.misfit(left, mean) == pytest.approx(2.0 * np.sum(lost))


def test_misfit_grows_with_the_distance_where_the_sum_of_squares_forgets_it(noise: Noise) -> None:
    heavy = replace(noise, tail=3.0)
    some = np.arange(len(noise.gap)) % 40 == 0
    near, far = (np.where(some, size * noise.sigma_deg, 0.0) for size in (3.0, 300.0))
    mean = np.zeros_like(near)
    squares = [float(np.sum(heavy.residual(each, mean)[0] ** 2)) for each in (near, far)]
    assert squares[1] < squares[0]
    assert heavy.misfit(far, mean) > heavy.misfit(near, mean)
    rounded = replace(noise, step_deg=10.0 * noise.sigma_deg)
    assert rounded.misfit(far, mean) < noise.misfit(far, mean)


def test_rows_that_are_far_off_are_forgotten_only_where_they_are_few(noise: Noise) -> None:
    heavy = replace(noise, tail=3.0)
    rows = np.arange(len(noise.gap))
    left = {
        every: np.where(rows % every == 0, 30.0 * noise.sigma_deg, 0.1 * noise.sigma_deg)
        for every in (20, 7)
    }
    mean = np.zeros(len(rows))
    largest = {
        every: float(np.abs(heavy.residual(each, mean)[0]).max()) for every, each in left.items()
    }
    assert largest[20] < 1.0
    assert largest[7] > 3.0


def test_the_noise_that_is_said_is_the_likeliest_and_holds_the_rounding(noise: Noise) -> None:
    rng, steps, fresh = np.random.default_rng(3), 40_000, 0.1
    series = np.zeros(steps)
    for row in range(1, steps):
        series[row] = 0.95 * series[row - 1] + fresh * rng.normal()
    assumed = replace(
        noise, correlation=0.99, best_correlation=0.95, sigma_deg=fresh / np.sqrt(1 - 0.99**2)
    )
    assert assumed.likely_spread_deg == pytest.approx(np.std(series), rel=0.05)
    with_error = assumed.with_model_error(3.0)
    assert with_error.likely_spread_deg == pytest.approx(assumed.likely_spread_deg)
    assert assumed.spread_deg > 2.0 * assumed.likely_spread_deg
    read = replace(noise, sigma_deg=0.2, step_deg=2.0)
    exact = rng.uniform(0.0, 50.0, steps)
    said = np.std(2.0 * np.round((exact + 0.2 * rng.normal(size=steps)) / 2.0) - exact)
    assert read.likely_spread_deg == pytest.approx(said, rel=0.05)
    assert read.spread_deg == pytest.approx(said, rel=0.05)
    assert read.plain.sigma_deg == pytest.approx(said, rel=0.05)
    assert read.with_model_error(10.0).likely_spread_deg == pytest.approx(said, rel=0.05)
