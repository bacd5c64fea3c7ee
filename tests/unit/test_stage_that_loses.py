"""A stage accepts nothing by which it would lose what was accepted before."""

from types import SimpleNamespace

import pytest

from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages import staged_search
from cyclosweep.diagnosis.identify.stages.acceptance import Accepted
from cyclosweep.diagnosis.identify.stages.stage import stage_of
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

CREEP = EffectValue("creep", {"time_constant_s": 20.0}, (0.05,))


@pytest.mark.parametrize(("kept", "accepted"), [(("creep",), False), (("friction", "creep"), True)])
def test_a_stage_does_not_accept_what_explains_less(
    monkeypatch: pytest.MonkeyPatch, kept: tuple[str, ...], accepted: bool
) -> None:
    search = search_of(friction(2.0), CREEP)
    flexible = flexible_basis(search.problem, search.library)
    stages = staged_search._Stages.begin(search, flexible, None)
    assert stages.names == {"friction_hysteresis"}
    before = stages.fitted
    creep = Term(find("creep"), dict(CREEP.shape))
    offered = tuple(
        term for part in kept for term in (before.terms if part == "friction" else (creep,))
    )

    def acceptable(*_: object) -> tuple[Candidate, Accepted]:
        found = Accepted(stage.start, offered, SimpleNamespace(unexplained=True))  # type: ignore[arg-type]
        return stage.start, found

    monkeypatch.setattr(staged_search, "acceptable", acceptable)
    for other in ("freer_instead_of_others", "bent_instead_of_others"):
        monkeypatch.setattr(staged_search, other, lambda *_: None)
    stage = stage_of(search, flexible, before)
    decision = SimpleNamespace(unexplained=True)
    assert stages.accepts(stage, decision, stage.start) is accepted  # type: ignore[arg-type]
    assert (stages.fitted is before) is not accepted


def test_what_was_given_up_comes_back_where_the_stages_since_explain_less(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(friction(2.0), CREEP)
    flexible = flexible_basis(search.problem, search.library)
    stages = staged_search._Stages.begin(search, flexible, None)
    before = stages.fitted
    stage = stage_of(search, flexible, before)
    creep = (Term(find("creep"), dict(CREEP.shape)),)
    monkeypatch.setattr(staged_search, "still_needed", lambda *_: ())
    assert stages.gives_up(stage, stage.start)
    assert not stages.accepted
    stages._refit(creep, search.baseline.fit)
    assert not stages.gives_up(stage, stage.start)
    assert stages.ended().start.names == frozenset(before.names)
    assert stages.fitted is before


def test_laws_are_settled_by_the_search_that_came_back(monkeypatch: pytest.MonkeyPatch) -> None:
    search = search_of(friction(2.0), CREEP)
    flexible = flexible_basis(search.problem, search.library)
    begun = staged_search._Stages.begin(search, flexible, None).fitted
    later = search_of(friction(1.0))
    monkeypatch.setattr(staged_search, "MOST_STAGES", 0)
    settled = []

    def ended(stages: staged_search._Stages) -> object:
        stages.searched = later
        return stages.last

    monkeypatch.setattr(staged_search._Stages, "ended", ended)
    monkeypatch.setattr(staged_search, "_with_settled_laws", lambda *given: settled.append(given))
    staged_search.search_in_stages(search, flexible, lambda _: None, begun)
    assert settled[0][0] is later
