"""Other laws in the place of accepted ones: dials, and what makes the curve of a dial."""

import pytest

from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.other_laws import visit_rivals, with_better_laws
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import (
    decide,
    decide_in_stages,
    with_further_rivals,
)
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.base import Shape
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

ONCE: Shape = {"order": 1.0}
TILTED: Shape = {"order": 1.0, "order_2": 2.0}
POWER: Shape = {"power": 1.0}
TURN: Shape = {"turn_nm": 3.0}
KINKS: Shape = {"kink_1_nm": 7.0, "kink_2_nm": 12.0, "kink_3_nm": 17.0}


def better(search: Search, *accepted: tuple[str, Shape]) -> dict[str, Shape]:
    """Shapes of what is settled on, by name, where laws of these shapes were accepted."""
    fitted, _ = with_better_laws(begun_with(search, *accepted))
    return {term.name: term.shape for term in fitted.terms}


def begun_with(search: Search, *accepted: tuple[str, Shape]) -> Search:
    """Search that starts from laws of these shapes."""
    terms = tuple(Term(find(name), shape) for name, shape in accepted)
    fitted = search.refit(terms, search.baseline.fit).fit
    return Search(search.problem, search.noise, search.library, 0, fitted)


def test_a_tilted_dial_takes_the_place_of_a_side_load() -> None:
    # Without its tilt the dial explained less than the side load, and was not tried with it.
    search = search_of(EffectValue("dial_eccentricity", TILTED, (1.5, 0.5, 1.6, -1.2)))
    assert better(search, ("load_asymmetry", POWER)) == {"dial_eccentricity": TILTED}


def test_a_side_load_and_kinks_take_the_place_of_a_dial() -> None:
    # Either alone explains less than a dial, which has an odd and an even part.
    kinks = EffectValue("clearance_takeup", KINKS, (0.4, 0.5, 0.4))
    search = search_of(EffectValue("load_asymmetry", POWER, (0.6,)), kinks)
    assert set(better(search, ("dial_eccentricity", ONCE))) == {
        "load_asymmetry",
        "clearance_takeup",
    }


@pytest.mark.parametrize(("shape", "amplitudes"), [(ONCE, (1.5, 0.8)), (TILTED, (1.5, 0.5, 1, -1))])
def test_a_dial_gives_way_to_no_two_others(shape: Shape, amplitudes: tuple[float, ...]) -> None:
    search = search_of(EffectValue("dial_eccentricity", shape, amplitudes))
    assert better(search, ("dial_eccentricity", ONCE)) == {"dial_eccentricity": shape}


@pytest.mark.parametrize("odd", [("contact_stiffening", TURN), ("clearance_takeup", KINKS)])
@pytest.mark.parametrize("amplitudes", [(1.5, 0.8), (0.8, 1.5), (1.0, -1.0)])
def test_a_dial_takes_the_place_of_a_side_load_and_a_curve_of_the_torque(
    amplitudes: tuple[float, float], odd: tuple[str, Shape]
) -> None:
    # One by one, the dial took the place of one of them and left the other.
    search = search_of(EffectValue("dial_eccentricity", ONCE, amplitudes))
    assert better(search, ("load_asymmetry", POWER), odd) == {"dial_eccentricity": ONCE}


def test_a_side_load_and_a_stiffening_stay_two() -> None:
    stiffening = EffectValue("contact_stiffening", TURN, (3.0,))
    search = search_of(EffectValue("load_asymmetry", POWER, (0.6,)), stiffening)
    found = better(search, ("load_asymmetry", POWER), ("contact_stiffening", TURN))
    assert set(found) == {"load_asymmetry", "contact_stiffening"}


@pytest.mark.parametrize("amplitudes", [(0.06, 0.02, 0.064, -0.048), (0.08, -0.024, 0.096, 0.064)])
def test_a_tilted_dial_is_found_where_a_side_load_made_up_for_the_tilt(
    amplitudes: tuple[float, ...],
) -> None:
    search = search_of(EffectValue("dial_eccentricity", TILTED, amplitudes))
    search.run()
    best = decide(search).best
    assert best is not None
    assert best.names == {"dial_eccentricity", "load_asymmetry"}
    visit_rivals(search)
    best = decide(search).best
    assert best is not None
    assert {term.name: term.shape for term in best.fit.terms} == {"dial_eccentricity": TILTED}


def test_a_law_that_hardly_shows_has_rivals_and_a_loud_one_has_none() -> None:
    odds = []
    for amplitude in (0.005, 2.0):
        search = search_of(EffectValue("clearance_takeup", {"kink_1_nm": 7.0}, (amplitude,)))
        _, rivals = with_better_laws(begun_with(search, ("clearance_takeup", {"kink_1_nm": 7.0})))
        listed = {each.names: value for each, value in rivals}
        odds.append(listed.get(frozenset({"contact_stiffening"}), 0.0))
    assert 0.1 < odds[0] <= 1.0
    assert odds[1] < 1e-3


def test_further_rivals_share_what_is_left_and_none_is_counted_twice() -> None:
    search = search_of(EffectValue("clearance_takeup", {"kink_1_nm": 7.0}, (0.5,)))
    takeup, dial, side = (
        search.judged(begun_with(search, (name, shape)).start.fit, 0.0, 0.0)
        for name, shape in (
            ("clearance_takeup", {"kink_1_nm": 7.0}),
            ("dial_eccentricity", ONCE),
            ("load_asymmetry", POWER),
        )
    )
    others = [(takeup, 0.9), (dial, 0.5), (side, 0.5), (dial, 0.4)]
    found = with_further_rivals([(takeup, 0.2)], others)
    assert [each for each, _ in found] == [takeup, dial, side]
    assert [share for _, share in found] == pytest.approx([0.2, 0.2, 0.2])


def test_the_rivals_of_a_tilted_dial_are_measured_against_it_with_its_tilt() -> None:
    amplitudes = (0.06, 0.02, 0.064, -0.048)
    search = search_of(EffectValue("dial_eccentricity", TILTED, amplitudes))
    begun = begun_with(search, ("dial_eccentricity", TILTED))
    fitted, rivals = with_better_laws(begun)
    assert {term.name: term.shape for term in fitted.terms} == {"dial_eccentricity": TILTED}
    assert max((odds for _, odds in rivals), default=0.0) < 0.05


def test_what_was_accepted_is_listed_however_many_rivals_it_has() -> None:
    search = search_of(EffectValue("load_asymmetry", POWER, (0.5,)))
    begun = begun_with(search, ("load_asymmetry", POWER))
    others = [search.judged(begun.start.fit, 0.0, 0.0) for _ in range(5)]
    begun.rivals_of_start = list(zip(others, (0.4, 0.3, 0.2, 0.06, 0.03), strict=True))
    decision = decide_in_stages(begun, 1.0)
    assert decision.verdict == "AMBIGUOUS"
    assert any(each is decision.best for each, _ in decision.explanations)
