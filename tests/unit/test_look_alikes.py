"""Effects that look alike: each is tried in the other's place, and stays a rival if it fits."""

from types import SimpleNamespace
from typing import cast

import pytest

from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.other_laws import LEAST_PROBABLE, rivals_of
from cyclosweep.diagnosis.identify.own_classes import look_alikes
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.verdict import with_further
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

STIFFENING = EffectValue("contact_stiffening", {"turn_nm": 4.0}, (2.0,))


def candidate(name: str, score: float = 0.0) -> Candidate:
    return cast(Candidate, SimpleNamespace(names=frozenset([name]), score=score))


def listed(pairs: list[tuple[Candidate, float]]) -> dict[str, float]:
    return {next(iter(each.names)): share for each, share in pairs}


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


def test_what_fits_as_well_is_a_rival_and_what_does_not_is_none() -> None:
    chosen, near, far = candidate("a", 30.0), candidate("b", 29.0), candidate("c", 20.0)
    shares = listed(rivals_of(chosen, [chosen, None, near, far]))
    assert shares == {"b": pytest.approx(0.2689, abs=1e-3)}
    assert rivals_of(None, [near]) == []
    assert 0.0 < LEAST_PROBABLE < 0.2


def test_a_rival_that_is_ahead_by_little_is_as_likely_and_no_more() -> None:
    chosen, ahead = candidate("a", 30.0), candidate("b", 40.0)
    assert listed(rivals_of(chosen, [chosen, ahead])) == {"b": pytest.approx(0.5)}


def test_further_rivals_share_what_is_left() -> None:
    a, b, c = (candidate(name) for name in "abc")
    shares = listed(with_further([(a, 0.4)], [(b, 0.5), (a, 0.3), (c, 0.25)]))
    assert shares == {"a": 0.4, "b": pytest.approx(0.3), "c": pytest.approx(0.15)}
