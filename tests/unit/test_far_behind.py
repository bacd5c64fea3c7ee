"""Structures that a search by better-known noise need not extend once more."""

from dataclasses import replace

import pytest

import cyclosweep.diagnosis.identify.stages.far_behind as far_behind_module
from cyclosweep.diagnosis.identify.stages.far_behind import far_behind
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

TWO = (friction(2.0), EffectValue("load_asymmetry", {"orders": 2.0}, (0.02, 0.01)))


@pytest.fixture(scope="module")
def searched() -> Search:
    search = search_of(*TWO)
    search.run()
    return search


def again(before: Search, not_extended: frozenset[frozenset[str]]) -> Search:
    """Search once more, by noise larger by a hundredth."""
    noise = replace(before.noise, sigma_deg=1.01 * before.noise.sigma_deg)
    search = Search(before.problem, noise, before.library, before.seed)
    search.not_extended = not_extended
    search.run()
    return search


def test_a_search_once_more_finds_the_same_with_fewer_fits(searched: Search) -> None:
    behind = far_behind(searched)
    assert behind
    whole, short = again(searched, frozenset()), again(searched, behind)
    assert len(short.tried) < 0.8 * len(whole.tried)
    first, second = whole.best(), short.best()
    assert first is not None
    assert second is not None
    assert second.names == first.names
    assert second.score == pytest.approx(first.score, abs=0.1)


def test_what_leads_to_the_best_structure_is_extended(searched: Search) -> None:
    best = searched.best()
    assert best is not None
    assert not any(names <= best.names for names in far_behind(searched))
    assert searched.start.names not in far_behind(searched)


def test_what_was_not_extended_before_stays_so(searched: Search) -> None:
    behind = far_behind(searched)
    assert far_behind(again(searched, behind)) >= behind


def test_faint_structures_are_near_each_other(
    searched: Search, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(far_behind_module, "LEAST_BEHIND", 1e6)
    assert not far_behind(searched)
