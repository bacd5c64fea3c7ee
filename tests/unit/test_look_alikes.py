"""Effects that look alike: each is tried in the other's place."""

import pytest

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.own_classes import look_alikes
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

STIFFENING = EffectValue("contact_stiffening", {"turn_nm": 4.0}, (2.0,))


def test_a_take_up_looks_like_a_stiffening_and_no_drag() -> None:
    library = search_of().library
    effect = library.effects["clearance_takeup"].effect
    term = Term(effect, library.effects["clearance_takeup"].shape)
    found = set(look_alikes(library, {"clearance_takeup", "overload_softening"}, term))
    assert "contact_stiffening" in found
    assert not found & {"overload_softening", "clearance_takeup", "viscous_drag", "creep"}


def test_a_search_that_took_the_wrong_law_first_finds_the_right_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(STIFFENING)
    only = {"clearance_takeup"}
    monkeypatch.setattr(
        Candidate, "hypotheses_to_add", lambda self, *_: sorted(only - set(self.names))
    )
    search.run()
    best = search.best()
    assert best is not None
    assert best.fit.names == ("contact_stiffening",)
    (part,) = [each for each, name in search.tried if name == "contact_stiffening"]
    assert part is search.start
