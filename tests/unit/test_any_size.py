"""Laws that fit as well at any size, or let friction do so, and faint waves keep no name."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest

from cyclosweep.diagnosis.identify.fitting.fit_state import Linearisation
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws import naming, travel_check
from cyclosweep.diagnosis.identify.laws.law_in_class import LawCheck
from cyclosweep.diagnosis.identify.laws.naming import names_that_hold
from cyclosweep.diagnosis.identify.laws.travel_check import without_faint_waves
from cyclosweep.diagnosis.identify.structures import testability as sizes
from cyclosweep.diagnosis.identify.structures.testability import (
    of_any_size,
    strength_of,
)
from cyclosweep.result.part import NORMAL_95
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of
from tests.unit.test_one_class import CREEP, fitted

AT_ONCE = {"onset_nm": 0.01, "power": 1.0}
"""A softening that begins at no torque is compliance."""


def rubbing() -> Term:
    """Friction as the recordings here have it."""
    return Term(find("friction_hysteresis"), friction().shape, None, 0.1)


@pytest.mark.parametrize(
    ("name", "shape"),
    [("contact_stiffening", {"turn_nm": 0.3}), ("creep", {"time_constant_s": 20.0})],
)
@pytest.mark.parametrize("at_work", [False, True])
def test_a_law_is_of_any_size_only_where_it_is_not_at_work(
    name: str, shape: Mapping[str, float], at_work: bool
) -> None:
    law = EffectValue(name, shape, (0.1,))
    search = search_of(friction(0.3), *([law] if at_work else []))
    found = fitted(search, [rubbing(), Term(find(name), dict(shape))])
    assert of_any_size(search, found.fit) == (frozenset() if at_work else {name})


@pytest.mark.parametrize("in_series", [False, True])
def test_compliance_before_the_friction_hides_it(in_series: bool) -> None:
    # Behind the friction it is the compliance of the line: it hides nothing, but has any size.
    search = search_of(friction(0.3))
    soft = Term(find("overload_softening"), AT_ONCE, in_series=in_series)
    found = fitted(search, [rubbing(), soft]).fit
    assert (strength_of(search, found, 0) < NORMAL_95) is in_series
    assert strength_of(search, found, 0, [1]) > 100.0
    assert of_any_size(search, found) == {"overload_softening"}


@pytest.mark.parametrize(
    ("beside", "alone", "hides"), [(1.0, 6.0, True), (1.0, 4.0, False), (3.0, 6.0, False)]
)
def test_a_law_of_known_size_is_withdrawn_where_it_hides_a_plain_friction(
    *, beside: float, alone: float, hides: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = search_of(friction(0.3), CREEP)
    both = fitted(search, [rubbing(), Term(find("creep"), dict(CREEP.shape))]).fit

    def strength(_: object, __: object, index: int, left_out: Sequence[int] = ()) -> float:
        return 10.0 if index else alone if 1 in left_out else beside

    monkeypatch.setattr(sizes, "strength_of", strength)
    assert of_any_size(search, both) == ({"creep"} if hides else set())


@pytest.mark.parametrize(("spread", "withdrawn"), [(0.4, False), (0.6, True), (np.nan, True)])
def test_an_interval_that_holds_zero_withdraws_a_law_whatever_its_strength(
    *, spread: float, withdrawn: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = search_of(friction(0.3), CREEP)
    both = fitted(search, [rubbing(), Term(find("creep"), dict(CREEP.shape))]).fit
    size = float(np.max(np.abs(sizes.recalibrated_twist(both, 1))))
    asked: list[np.ndarray] = []

    def of_size(_: object, __: object, covariance: np.ndarray) -> float:
        asked.append(covariance)
        return spread * size

    monkeypatch.setattr(sizes, "spread_of_size", of_size)
    assert of_any_size(search, both) == ({"creep"} if withdrawn else set())
    # Nothing is known of the shape besides.
    np.testing.assert_array_equal(asked[0], both.covariance)


def test_what_has_any_size_is_withdrawn_and_the_rest_fitted_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(friction(0.3), CREEP)
    both = fitted(search, [rubbing(), Term(find("creep"), dict(CREEP.shape))])
    asked: list[Sequence[str]] = []

    def creep(_: object, each: object) -> frozenset[str]:
        asked.append(each.names)  # type: ignore[attr-defined]
        return frozenset({"creep"})

    assert names_that_hold(search, both, both).names == {"friction_hysteresis", "creep"}
    monkeypatch.setattr(naming, "of_any_size", creep)
    found = names_that_hold(search, both, both)
    assert found.names == set(found.part.fit.names) == {"friction_hysteresis"}
    assert [check.name for check in found.withdrawn] == ["creep"]
    assert both.fit.names in asked


def test_what_alone_explains_a_recording_is_at_work_whatever_its_shape() -> None:
    search = search_of()
    found = fitted(search, [Term(find("creep"), {"time_constant_s": 20.0})])
    assert of_any_size(search, found.fit) == set()


def with_sensitivity(fitted: FittedStructure, sensitivity: Floats) -> FittedStructure:
    """The same fit with other slopes."""
    slopes = Linearisation(fitted.linearisation.target, lambda: sensitivity)
    return replace(fitted, linearisation=slopes)


def test_a_law_that_the_others_can_replace_whole_has_any_size() -> None:
    # The covariance of least squares knows nothing of a direction in which nothing changes.
    search = search_of(friction(0.3), CREEP)
    both = fitted(search, [rubbing(), Term(find("creep"), dict(CREEP.shape))]).fit
    twice = both.sensitivity.copy()
    place = both.amplitude_places(1)[0]
    twice[:, len(both.beta)] = twice[:, place]
    found = with_sensitivity(both, twice)
    assert of_any_size(search, both) == set()
    assert of_any_size(search, found) == {"creep"}


@pytest.mark.parametrize("louder", [1.0, 10.0, 1000.0])
def test_parameters_that_make_up_for_each_other_are_known_within_their_bounds(
    louder: float,
) -> None:
    """With a variance of 1e19 before the bounds, or noise a tenth as large, theirs was lost."""
    both = fitted(search_of(friction(0.3)), [rubbing()]).fit
    first, second = len(both.beta), len(both.beta) + 1
    twins = louder * both.sensitivity
    twins[:, second] = twins[:, first]
    found = with_sensitivity(both, twins)
    bounded = found.covariance_within_bounds
    one, other = (
        (each.to_scale(each.quantity.upper) - each.to_scale(each.quantity.lower)) ** 2 / 12.0
        for each in found.fit_parameters[:2]
    )
    # What they add to each other is known, so that each is as well known as by both bounds.
    known = 1.0 / (1.0 / one + 1.0 / other)
    assert bounded[first, first] == pytest.approx(known, rel=1e-3)
    assert bounded[second, second] == pytest.approx(known, rel=1e-3)


def test_a_shape_that_is_not_told_is_known_to_lie_within_its_bounds() -> None:
    search = search_of(friction(0.3))
    shape = {"onset_nm": 30.9, "power": 1.0}
    found = fitted(search, [Term(find("overload_softening"), shape)]).fit
    free, bounded = found.covariance, found.covariance_within_bounds
    line = search.problem.line_columns
    for place in range(line):
        assert bounded[place, place] == pytest.approx(free[place, place], rel=0.1)
    untold = set()
    for place, each in enumerate(found.fit_parameters, len(found.beta)):
        evenly = (each.quantity.upper - each.quantity.lower) ** 2 / 12.0
        assert bounded[place, place] <= 1.001 * evenly
        if free[place, place] > evenly:
            untold.add(each.name)
    assert untold == {"power"}


@pytest.mark.parametrize(
    ("loud", "faint", "held"), [(120.0, 8.0, False), (120.0, 12.0, True), (80.0, 8.0, True)]
)
def test_a_faint_wave_beside_a_loud_effect_is_withdrawn(
    *, loud: float, faint: float, held: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = search_of(friction(0.3), CREEP)
    wave = Term(find("transmission_error"), {"order_1": 1.0})
    found = fitted(search, [rubbing(), Term(find("creep"), dict(CREEP.shape)), wave])
    checks = tuple(LawCheck(name, "", 0.0, 0.0, holds=True) for name in found.fit.names)
    strength = {"friction_hysteresis": loud, "creep": faint, "transmission_error": faint}
    names = found.fit.names
    monkeypatch.setattr(travel_check, "strength_of", lambda _, __, k: strength[names[k]])
    left = {c.name for c in without_faint_waves(search, found.fit, checks) if c.holds}
    assert left == (set(names) if held else {"friction_hysteresis", "creep"})
