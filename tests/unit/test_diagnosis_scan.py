"""Evidence and the projected scan."""

import numpy as np
import pytest

from cyclosweep.diagnosis.identify.structures.scan import (
    evidence,
    likelihood_gain,
    shape_choice_penalty,
    vector_penalty,
)


def test_evidence_is_nothing_without_gain_and_grows_with_it() -> None:
    assert evidence(1.0, 1) == 0
    assert evidence(20.0, 1) == pytest.approx(0.5 * (20 - 1 - np.log(20)))
    assert evidence(20.0, 10) < evidence(20.0, 1)


def test_gains_add_up_over_nested_models() -> None:
    whole = likelihood_gain(np.array(50.0), 60.0, 100.0)
    first = likelihood_gain(np.array(30.0), 60.0, 100.0)
    second = likelihood_gain(np.array(20.0), 30.0, 100.0)
    assert whole == pytest.approx(first + second)


def test_vector_of_equal_parts_costs_what_two_amplitudes_cost() -> None:
    size = np.array([3.0, 4.0])
    gain = float(size @ size) / 0.2**2
    found = 0.5 * gain - vector_penalty(size, np.eye(2) / 0.2**2)
    assert found == pytest.approx(evidence(gain, 2), abs=0.05)


def test_vector_in_a_direction_that_is_seldom_met_costs_more() -> None:
    # The second component is seen a hundred times worse, as the sine of a small angle is.
    information = np.diag([1e4, 1.0])
    usual, seldom = np.array([0.2, 0.0]), np.array([0.0, 20.0])
    gain = usual @ information @ usual
    assert gain == pytest.approx(seldom @ information @ seldom)
    assert vector_penalty(seldom, information) > vector_penalty(usual, information) + 3.0


@pytest.mark.parametrize("noise", [0.0, 15.0, 700.0])
def test_component_that_does_not_show_costs_nothing(noise: float) -> None:
    # Whatever noise put into it: the penalty is that of the other component alone.
    information = np.diag([1e4, 1e-12])
    penalty = vector_penalty(np.array([0.2, noise]), information)
    assert penalty == pytest.approx(0.5 * (1 + np.log(400.0)), abs=0.02)
    assert vector_penalty(np.array([0.2, noise]), np.zeros((2, 2))) == 0.0


def test_choice_costs_the_range_over_the_error_and_nothing_where_nothing_is_known() -> None:
    assert shape_choice_penalty(np.array([[100.0**2]]), np.array([1.0])) == pytest.approx(
        np.log(100.0 / np.sqrt(2 * np.pi)), abs=1e-3
    )
    assert shape_choice_penalty(np.zeros((2, 2)), np.array([1.0, 5.0])) == 0.0
    # Two parameters of which only the sum is known are one.
    both = np.full((2, 2), 100.0**2)
    assert shape_choice_penalty(both, np.ones(2)) == pytest.approx(
        shape_choice_penalty(np.array([[2e4]]), np.ones(1)), abs=1e-3
    )
