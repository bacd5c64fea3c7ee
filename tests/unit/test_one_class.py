"""Which laws keep their names where one class, or what has no name, explains more than they do."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from cyclosweep.diagnosis.hypotheses.behaviour_classes import LOOP
from cyclosweep.diagnosis.identify.fitting.fit import ContactFit, fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws import naming
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.law_in_class import LawCheck
from cyclosweep.diagnosis.identify.laws.naming import names_that_hold
from cyclosweep.diagnosis.identify.laws.one_class_check import without_laws_of_one_class
from cyclosweep.diagnosis.identify.laws.small_laws_check import errors_of_larger, without_small_laws
from cyclosweep.diagnosis.identify.stages.friction_first import friction_first
from cyclosweep.diagnosis.identify.structures import testability as bounds_of
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.diagnosis.identify.structures.verdict import decide, named_if_close
from cyclosweep.diagnosis.identify.structures.worth import INDISPENSABLE, still_needed, worth
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import COMPLIANCE, friction
from tests.support.searches import search_of

LOADED = {"slip_deg": 0.8, "scatter": 0.6, "skew": 0.0, "slack": 0.0}
ASYMMETRY = 0.1
"""Amplitude of a difference of the sides at 10 N m [deg]."""
KINKS = {"kink_1_nm": 4.0, "kink_2_nm": 8.0}
CREEP = EffectValue("creep", {"time_constant_s": 20.0}, (0.1,))


def fitted(search: Search, terms: Sequence[Term]) -> Candidate:
    """Candidate of terms fitted jointly."""
    found = fit(search.problem, search.noise, tuple(terms), search.baseline.fit, rounds=20)
    return search.judged(found, 0.0, 0.0)


def held(checks: Sequence[LawCheck]) -> set[str]:
    """Names of the laws that hold."""
    return {check.name for check in checks if check.holds}


def mean_square_explained(search: Search, candidate: Candidate) -> float:
    """What a structure explains of the mean square that a search starts from [deg^2]."""
    return search.start.fit.rmse_deg**2 - candidate.fit.rmse_deg**2


def all_hold(candidate: Candidate) -> tuple[LawCheck, ...]:
    """Checks of all laws of a structure, as if each alone stood for its class."""
    return tuple(LawCheck(name, "", 0.0, 0.0, holds=True) for name in candidate.fit.names)


def test_two_laws_that_make_the_loop_of_another_are_withdrawn() -> None:
    # Friction that opens with the load and a drag that depends on the rate make its loop.
    search = search_of(friction(0.15))
    shape = find("viscous_drag").shapes(search.problem.history)[0]
    both = fitted(
        search,
        [
            Term(find("load_dependent_friction"), LOADED, None, 0.02),
            Term(find("viscous_drag"), dict(shape)),
        ],
    )
    assert held(without_laws_of_one_class(both.fit, all_hold(both))) == set()
    withdrawn = without_laws_of_one_class(both.fit, all_hold(both))
    assert {check.behaviour for check in withdrawn} == {LOOP}


def test_two_effects_at_work_keep_their_names() -> None:
    search = search_of(friction(0.3), CREEP)
    both = fitted(
        search,
        [
            Term(find("friction_hysteresis"), friction().shape, None, 0.1),
            Term(find("creep"), dict(CREEP.shape)),
        ],
    )
    names = {"friction_hysteresis", "creep"}
    assert held(check_laws(both.fit)) == names
    assert held(without_laws_of_one_class(both.fit, all_hold(both))) == names
    assert names_that_hold(search, both, both).names == names


@pytest.mark.parametrize("rubs", [True, False])
def test_beside_friction_a_withdrawn_law_stays_while_the_others_are_judged(
    rubs: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    side = EffectValue("load_asymmetry", {"power": 1.0}, (ASYMMETRY,))
    search = search_of(CREEP, side, *([friction(0.3)] if rubs else []))
    terms = [Term(find("creep"), dict(CREEP.shape)), Term(find("load_asymmetry"), side.shape)]
    if rubs:
        terms.append(Term(find("friction_hysteresis"), friction().shape, None, 0.1))
    whole = fitted(search, terms)
    judged: list[tuple[tuple[str, ...], list[str]]] = []

    def without_side_load(
        each: FittedStructure, stand_ins: Sequence[LawCheck] = ()
    ) -> tuple[LawCheck, ...]:
        judged.append((each.names, [check.name for check in stand_ins]))
        checks = check_laws(each, stand_ins)
        return tuple(replace(c, holds=c.holds and c.name != side.name) for c in checks)

    monkeypatch.setattr(naming, "check_laws", without_side_load)
    found = names_that_hold(search, whole, whole)
    others = tuple(name for name in whole.fit.names if name != side.name)
    again = (whole.fit.names, [side.name]) if rubs else (others, [])
    assert judged == [(whole.fit.names, []), again]
    assert found.names == set(others)
    assert found.part.fit.names == others


@pytest.mark.parametrize(("friction_deg", "named"), [(0.3, False), (0.03, True)])
def test_a_law_smaller_than_what_has_no_name_is_not_named(friction_deg: float, named: bool) -> None:
    # Friction stands here for something without a name, beside a small difference of the sides.
    shape = {"power": 1.0}
    search = search_of(friction(friction_deg), EffectValue("load_asymmetry", shape, (ASYMMETRY,)))
    small = Term(find("load_asymmetry"), shape)
    alone = fitted(search, [small])
    slipping = Term(find("friction_hysteresis"), friction().shape, None, friction_deg / COMPLIANCE)
    both = fitted(search, [small, slipping])
    assert ("load_asymmetry" in names_that_hold(search, alone, both).names) == named
    assert names_that_hold(search, alone, alone).names == {"load_asymmetry"}


@pytest.mark.parametrize(("unnamed", "named"), [("even curve", False), ("compliance by run", True)])
def test_a_law_that_is_worth_little_beside_what_has_no_name_is_not_named(
    unnamed: str, named: bool
) -> None:
    shape = {"power": 1.0}
    search = search_of(EffectValue("load_asymmetry", shape, (ASYMMETRY,)))
    law = fitted(search, [Term(find("load_asymmetry"), shape)])
    assert worth(search, "load_asymmetry", law) > INDISPENSABLE
    both = search.extend(law, unnamed)
    assert both is not None
    assert ("load_asymmetry" in names_that_hold(search, law, both).names) == named
    # A curve that was accepted is not asked again beside what was found since, friction is.
    assert still_needed(search, both, law.fit.terms) == both.fit.terms[:1]


def test_a_friction_that_stood_in_for_another_cause_is_given_up_again() -> None:
    search = search_of(CREEP)
    slipping = Term(find("friction_hysteresis"), friction().shape, None, 0.02)
    relaxing = Term(find("creep"), dict(CREEP.shape))
    both = fitted(search, [slipping, relaxing])
    assert still_needed(search, both, both.fit.terms[:1]) == ()
    assert still_needed(search, both, both.fit.terms) == both.fit.terms
    alone = fitted(search, [slipping])
    assert still_needed(search, alone, alone.fit.terms) == alone.fit.terms
    rubbing = search_of(CREEP, friction(0.3))
    both = fitted(rubbing, [slipping, relaxing])
    assert still_needed(rubbing, both, both.fit.terms[:1]) == both.fit.terms[:1]


@pytest.mark.parametrize("share", [0.02, 0.5])
def test_effects_do_not_take_the_place_of_the_line(share: float) -> None:
    search = search_of(friction(0.3))
    found = fitted(search, [Term(find("friction_hysteresis"), friction().shape, None, 0.1)]).fit
    assert isinstance(found, ContactFit)
    assert found.keeps_line
    slope = search.problem.history.compliance_deg_per_nm
    moved = found.moved(1, (share - 1.0) * slope)
    assert moved.keeps_line == (share > 0.1)
    assert (with_right_signs(moved) is None) == (share < 0.1)
    assert np.isfinite(moved.beta).all()


def test_friction_is_judged_without_a_curve_that_has_taken_the_place_of_the_line(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(friction(0.3))
    slipping = Term(find("friction_hysteresis"), friction().shape, None, 0.1)
    both = fitted(search, [slipping, Term(find("contact_stiffening"), {"turn_nm": 3.0})]).fit
    slope = search.problem.history.compliance_deg_per_nm
    moved = both.moved(1, 0.02 * slope - float(both.beta[1]))
    assert not moved.keeps_line

    def without_friction(
        fitted: FittedStructure, stand_ins: Sequence[LawCheck] = ()
    ) -> tuple[LawCheck, ...]:
        checks = check_laws(fitted, stand_ins)
        return (
            checks
            if fitted is not moved
            else tuple(replace(each, holds=each.name != "friction_hysteresis") for each in checks)
        )

    monkeypatch.setattr(naming, "check_laws", without_friction)
    candidate = search.judged(moved, 0.0, 0.0)
    found = names_that_hold(search, candidate, candidate)
    assert found.names == {"friction_hysteresis"}
    assert [each.name for each in found.withdrawn] == ["contact_stiffening"]


def test_no_friction_is_fitted_first_where_there_is_none() -> None:
    stiffening = EffectValue("contact_stiffening", {"turn_nm": 3.0}, (1.5,))
    search = search_of(stiffening)
    assert friction_first(search, search.noise) is None
    slipping = search_of(stiffening, friction(3.0))
    found = friction_first(slipping, slipping.noise)
    assert found is not None
    assert all(term.slips for term in found.terms)


def test_no_friction_is_fitted_first_where_a_drag_explains_more() -> None:
    drag = EffectValue("viscous_drag", {"power": 1.0, "lag_s": 1e-3}, (0.5,))
    search = search_of(drag)
    assert friction_first(search, search.noise) is None


@pytest.mark.parametrize(("ahead", "taken"), [(4.0, True), (6.0, False)])
def test_named_effects_are_taken_where_what_has_no_name_is_hardly_likelier(
    ahead: float, taken: bool
) -> None:
    search = search_of(EffectValue("load_asymmetry", {"power": 1.0}, (ASYMMETRY,)))
    named = search.extend(search.start, "load_asymmetry")
    other = search.extend(search.start, "even curve")
    assert named is not None
    assert other is not None
    assert search.suffices(named)
    assert search.suffices(other)
    other = replace(other, prior=other.prior + named.score + ahead - other.score)
    rival = replace(named, prior=named.prior - 1.0)
    search.visited = {
        frozenset(name): each for name, each in zip("nor", (named, other, rival), strict=True)
    }
    decision = decide(search)
    assert decision.best is other
    closer = named_if_close(search, decision)
    assert (closer.best is named) == taken
    # Both leave the noise alone: the named one explains nearly all of the other's mean square.
    share = mean_square_explained(search, named) / mean_square_explained(search, other)
    assert 0.98 < share < 1.02
    assert named_if_close(search, decision, share - 1e-6).best is named
    assert (named_if_close(search, decision, share + 1e-6).best is named) == taken
    # Named effects have the odds of what holds them and what may be error of their laws.
    beyond = search.extend(named, "smooth odd curve")
    assert beyond is not None
    assert beyond.recognised == (True, False)
    beyond = replace(beyond, prior=beyond.prior + other.score - 1.0 - beyond.score)
    search.visited[beyond.names] = beyond
    assert decide(search).best is other
    assert named_if_close(search, decision).best is named
    # What is far ahead holds more than errors: it is an explanation of its own.
    beyond = replace(beyond, prior=beyond.prior + 80.0)
    search.visited[beyond.names] = beyond
    decision_beyond = decide(search)
    assert decision_beyond.best is beyond
    assert named_if_close(search, decision_beyond) is decision_beyond
    del search.visited[beyond.names]
    if taken:
        # What it may be else is weighed among the named structures, however unlikely beside.
        share = 1.0 / (1.0 + np.exp(-1.0))
        assert [each for each, _ in closer.explanations] == [named, rival]
        assert [p for _, p in closer.explanations] == pytest.approx([share, 1.0 - share])


def test_bounds_of_a_structure_are_counted_by_its_own_noise() -> None:
    search = search_of(EffectValue("contact_stiffening", {"turn_nm": 3.0}, (0.4,)))
    wider = fit(search.problem, search.noise.with_model_error(5.0), ())

    def estimate(fitted: FittedStructure) -> float:
        bounds = bounds_of.testability(search, search.judged(fitted, 0.0, 0.0), {})
        return next(each.estimate_deg for each in bounds if each.name == "contact_stiffening")

    assert estimate(wider) == pytest.approx(estimate(search.baseline.fit), rel=0.2)


def test_a_law_with_little_evidence_beside_model_error_is_no_error_of_a_larger_one() -> None:
    # Positions have nothing in common with loops; little evidence is not taken up by them.
    shifted = EffectValue("transmission_error", {"order_1": 1.0}, (0.25, 0.1))
    sliding = friction(5.0)
    search = search_of(sliding, shifted)
    size = sliding.amplitudes[0]
    terms = [Term(find(each.name), dict(each.shape), None, size) for each in (sliding, shifted)]
    for factor in (1.0, 6.0):
        noise = search.noise.with_model_error(factor)
        found = fit(search.problem, noise, terms, search.baseline.fit, rounds=20)
        assert errors_of_larger(found) == frozenset()


def test_a_law_with_little_evidence_that_a_larger_class_holds_is_its_error() -> None:
    # A stiffening, and pins that close at one load, are both odd curves of the torque.
    stiff = EffectValue("contact_stiffening", {"turn_nm": 4.0}, (6.0,))
    search = search_of(stiff)
    law = search.extend(search.baseline, "contact_stiffening")
    assert law is not None
    pins = Term(find("clearance_takeup"), {"kink_1_nm": 9.0})
    for factor in (1.0, 4.0):
        noise = search.noise.with_model_error(factor)
        found = fit(search.problem, noise, (*law.fit.terms, pins), law.fit, rounds=20)
        assert "clearance_takeup" in errors_of_larger(found)


def test_two_look_alikes_of_one_class_are_one_curve() -> None:
    search = search_of(EffectValue("clearance_takeup", KINKS, (0.4, 0.4)))
    both = fitted(
        search,
        [Term(find("clearance_takeup"), KINKS), Term(find("contact_stiffening"), {"turn_nm": 5.0})],
    )
    size = [recalibrated_twist(both.fit, k) for k in range(2)]
    assert np.corrcoef(size[0], size[1])[0, 1] > 0.8
    assert len(held(without_small_laws(both.fit, all_hold(both)))) == 1
