"""Evidence and the projected scan."""

import numpy as np
import pytest

from cyclosweep.diagnosis.scan import evidence, likelihood_gain
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


@pytest.mark.parametrize(
    ("factor", "word"),
    [(57.3, "57.3"), (1 / 57.3, "57.3"), (1000, "1000"), (87.0**2, "squared"), (87.0, "the ratio")],
)
def test_unit_slips_are_named(factor, word):
    assert word in unit_slip(factor * 1.05, 87.0)


def test_other_factors_are_not():
    assert unit_slip(20.0, 87.0) is None
