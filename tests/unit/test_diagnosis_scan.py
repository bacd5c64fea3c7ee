"""Evidence and the projected scan."""

import numpy as np
import pytest

from cyclosweep.diagnosis.scan import evidence, likelihood_gain, price_of_vector
from cyclosweep.diagnosis.verdict import unit_slip


def test_evidence_is_nothing_without_gain_and_grows_with_it():
    assert evidence(1.0, 1) == 0
    assert evidence(20.0, 1) == pytest.approx(0.5 * (20 - 1 - np.log(20)))
    assert evidence(20.0, 10) < evidence(20.0, 1)


def test_gains_add_up_over_nested_models():
    whole = likelihood_gain(np.array(50.0), 60.0, 100.0)
    first = likelihood_gain(np.array(30.0), 60.0, 100.0)
    second = likelihood_gain(np.array(20.0), 30.0, 100.0)
    assert whole == pytest.approx(first + second)


def test_vector_of_equal_parts_costs_what_two_amplitudes_cost():
    size = np.array([3.0, 4.0])
    gain = float(size @ size) / 0.2**2
    found = 0.5 * gain - price_of_vector(size, 0.2**2 * np.eye(2))
    assert found == pytest.approx(evidence(gain, 2), abs=0.05)


def test_vector_in_a_direction_that_is_seldom_met_costs_more():
    # The second component is seen a hundred times worse, as the sine of a small angle is.
    spread = np.diag([0.01, 1.0]) ** 2
    usual = np.array([0.2, 0.0])
    seldom = np.array([0.0, 20.0])
    gain = usual @ np.linalg.solve(spread, usual)
    assert gain == pytest.approx(seldom @ np.linalg.solve(spread, seldom))
    assert price_of_vector(seldom, spread) > price_of_vector(usual, spread) + 3.0
    # Where the second one cannot show at all it is free.
    assert price_of_vector(usual, spread) == pytest.approx(0.5 * (1 + np.log(gain)), abs=0.1)


@pytest.mark.parametrize(
    ("factor", "word"),
    [(57.3, "57.3"), (1 / 57.3, "57.3"), (1000, "1000"), (87.0**2, "squared"), (87.0, "the ratio")],
)
def test_unit_slips_are_named(factor, word):
    assert word in unit_slip(factor * 1.05, 87.0)


def test_other_factors_are_not():
    assert unit_slip(20.0, 87.0) is None
