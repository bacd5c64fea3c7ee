"""An error once a turn is a dial's where it has both parts and a dial's size."""

import numpy as np
import pytest

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.dial_check import LEAST_ODDS, direction_odds
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

ONCE = {"order": 1.0}
LOPSIDED = np.array([1.0, 1.0, 0.5, 0.0])


@pytest.mark.parametrize(
    ("cos_deg", "sin_deg", "is_dial"),
    [
        *((1.5, 1.0, True), (6.0, 0.6, True), (6.0, 0.0, False), (0.0, 6.0, False), (9, 13, False)),
        *((0.3, 0.0, False), (0.3, 0.2, True)),
    ],
    ids=[
        *("oblique", "nearly even", "even", "odd", "off by more than a quarter of its radius"),
        *("even within its error", "small and oblique"),
    ],
)
def test_a_dial_errs_by_a_curve_neither_even_nor_odd_and_of_its_size(
    cos_deg: float, sin_deg: float, *, is_dial: bool
) -> None:
    """A side load or a contact whose own law was not in the library was called a dial."""
    search = search_of(EffectValue("dial_eccentricity", ONCE, (cos_deg, sin_deg)))
    term = Term(find("dial_eccentricity"), ONCE)
    (check,) = check_laws(fit(search.problem, search.noise, (term,), search.baseline.fit))
    assert check.holds == is_dial


def test_an_open_direction_counts_for_the_dial() -> None:
    """Its odds are those of all directions against an exactly even curve."""
    assert direction_odds(0.03, 0.4, 0.1) < LEAST_ODDS
    assert direction_odds(0.03, 0.4, 0.7) > LEAST_ODDS
    assert direction_odds(0.3, 0.4, 0.1) > 0.0
    # One that is known to be zero is no dial's, one that is not known at all says nothing.
    assert direction_odds(0.0, 0.4, 1e-4) < -6.0
    assert direction_odds(0.0, 0.4, 1e4) == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(("size_deg", "is_dial"), [(3.0, True), (8.0, False)])
def test_an_error_twice_a_turn_is_twice_as_steep(size_deg: float, *, is_dial: bool) -> None:
    shape = {"order": 2.0}
    search = search_of(EffectValue("dial_eccentricity", shape, (size_deg, 0.7 * size_deg)))
    term = Term(find("dial_eccentricity"), shape)
    (check,) = check_laws(fit(search.problem, search.noise, (term,), search.baseline.fit))
    assert check.holds == is_dial


def test_two_errors_far_larger_than_a_dials_are_none() -> None:
    """They made up for each other, and a simulation with them was off by thirty degrees."""
    history = search_of().problem.history
    shape = {"order": 1.0, "order_2": 2.0}
    recognised = find("dial_eccentricity").is_recognised
    assert recognised(history, shape, 1.0 * LOPSIDED)
    assert not recognised(history, shape, 8.0 * LOPSIDED)
