"""Outliers beside a large effect: heavy tails do not make a wrong law the likelier one."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects import find
from tests.support.arrays import Floats
from tests.support.searches import search_of, search_of_recording

NOISE_DEG = 0.004


def recorded(seed: int) -> cs.Recording:
    """Loops of a drive that is softer in one direction, read with three outliers."""
    rng = np.random.default_rng(seed)
    up = np.r_[np.linspace(0.1, 6.7, 60), np.linspace(6.7, 0.1, 60)]
    torque = np.tile(np.r_[up, -up], 4)
    angle = 22.0 * np.sign(torque) + 1.9 * torque + 0.04 * np.abs(torque)
    angle += NOISE_DEG * rng.standard_normal(len(torque))
    angle[rng.choice(len(torque), 3, replace=False)] += rng.choice([-0.05, 0.05], 3)
    return cs.Recording.from_arrays(
        torque,
        angle,
        run=np.repeat(np.arange(1, 5), 240),
        time_s=np.arange(float(len(torque))),
        crank_deg=np.repeat([10.0, 100.0, 190.0, 280.0], 240),
        side="input",
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_side_load_is_named_beside_three_outliers(seed: int) -> None:
    """Nothing was named: a dial left 0.03 deg, seven times the noise, and was the likeliest."""
    found = cs.diagnose(recorded(seed), cs.Drive.reference_87(), full=False)
    assert [effect["name"] for effect in found.effects] == ["load_asymmetry"]
    assert found.verdict == "IDENTIFIED"


def fitted_with(tail: float) -> tuple[Floats, Floats]:
    """Chi-squared and loss of a right law and of none, by noise with so many degrees of freedom."""
    search = search_of_recording(recorded(0))
    noise = replace(search.noise.plain, sigma_deg=NOISE_DEG, tail=tail)
    term = Term(find("load_asymmetry"), {"power": 1.0})
    fits = [fit(search.problem, noise, terms) for terms in ((term,), ())]
    return np.array([each.chi2 for each in fits]), np.array([each.loss for each in fits])


def test_the_loss_of_a_fit_is_the_likelihood_that_it_lacks() -> None:
    right, wrong = fitted_with(5.0)[1]
    assert wrong > 5.0 * right
    chi2, loss = fitted_with(np.inf)
    np.testing.assert_array_equal(loss, chi2)


@pytest.mark.parametrize("tail", [2.5, 5.0, 30.0, 3000.0])
def test_the_loss_of_a_row_is_its_mean(tail: float) -> None:
    noise = replace(search_of().noise.plain, correlation=0.0, white_share=0.0, tail=tail)
    count = len(noise.gap)
    size = noise.sigma_deg * np.sqrt((tail - 2.0) / tail)
    rows = size * stats.t.ppf((np.arange(count) + 0.5) / count, tail)
    found = noise.misfit(rows, np.zeros_like(rows)) / count
    assert found == pytest.approx(noise.loss_of_row, rel=0.01)
