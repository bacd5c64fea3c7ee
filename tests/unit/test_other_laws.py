"""Other laws in the place of accepted ones: dials, and what makes the curve of a dial."""

import pytest

from cyclosweep.diagnosis.identify.other_laws import with_better_laws
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.base import Shape
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

ONCE: Shape = {"order": 1.0}
TILTED: Shape = {"order": 1.0, "order_2": 2.0}
POWER: Shape = {"power": 1.0}
KINKS: Shape = {"kink_1_nm": 7.0, "kink_2_nm": 12.0, "kink_3_nm": 17.0}


def better(search: Search, *accepted: tuple[str, Shape]) -> dict[str, Shape]:
    """Shapes of what is settled on, by name, where laws of these shapes were accepted."""
    terms = tuple(Term(find(name), shape) for name, shape in accepted)
    fitted = search.refit(terms, search.baseline.fit).fit
    begun = Search(search.problem, search.noise, search.library, 0, fitted)
    return {term.name: term.shape for term in with_better_laws(begun).terms}


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
