"""Which structures a search extends by one more term."""

from dataclasses import dataclass

import pytest

from cyclosweep.diagnosis.identify import front as module
from cyclosweep.diagnosis.identify.front import front, least_near
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

TWO = (friction(2.0), EffectValue("load_asymmetry", {"orders": 2.0}, (0.02, 0.01)))


@dataclass(frozen=True)
class Structure:
    """Of a candidate what is asked here."""

    score: float
    all_recognised: bool = True


def extended(*found: Structure, breadth: int = 3, named: int = 3) -> list[float]:
    """Log odds of those that are extended."""
    return [each.score for each in front(found, breadth, named)]  # type: ignore[arg-type]


def test_what_is_far_behind_the_best_is_not_extended() -> None:
    assert extended(Structure(1000.0), Structure(801.0), Structure(799.0)) == [1000.0, 801.0]


def test_faint_structures_are_near_each_other() -> None:
    assert extended(Structure(60.0), Structure(11.0), Structure(9.0)) == [60.0, 11.0]
    assert least_near(-10.0) == -60.0


def test_structures_with_names_alone_are_compared_with_the_best_of_them() -> None:
    unnamed = Structure(5000.0, all_recognised=False)
    assert extended(unnamed, Structure(1000.0), Structure(900.0), Structure(10.0)) == [
        5000.0,
        1000.0,
        900.0,
    ]


def test_no_more_are_extended_than_asked_and_none_twice() -> None:
    every = [Structure(100.0 - k, all_recognised=k % 2 == 0) for k in range(8)]
    assert extended(*every, breadth=2, named=1) == [100.0, 99.0]
    assert extended(*every, breadth=2, named=2) == [100.0, 99.0, 98.0]
    assert extended() == []


def test_a_search_finds_the_same_with_fewer_fits(monkeypatch: pytest.MonkeyPatch) -> None:
    def searched() -> Search:
        search = search_of(*TWO)
        search.run()
        return search

    short = searched()
    monkeypatch.setattr(module, "LEAST_BEHIND", 1e9)
    whole = searched()
    first, second = whole.best(), short.best()
    assert len(short.tried) < 0.8 * len(whole.tried)
    assert first is not None
    assert second is not None
    assert second.names == first.names
    assert second.score == pytest.approx(first.score, abs=0.1)
