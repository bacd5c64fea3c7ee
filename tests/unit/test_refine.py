"""Refinement of a joint fit: where it ends when path and law do not settle, and what it costs."""

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import pytest

from cyclosweep.diagnosis.identify.fitting import refine as refinement
from cyclosweep.diagnosis.identify.fitting.first_slopes import first_slopes
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fit_parameters import FitParameter, fit_parameters_of
from cyclosweep.diagnosis.identify.fitting.fit_state import Expansion
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.joint_fit import JointFit
from cyclosweep.diagnosis.identify.fitting.refine import (
    EXPANSIONS,
    FAR_ABOVE,
    MOST_RISES,
    ROUNDS_FAR_OFF,
    STEPS_A_ROUND,
    refine,
)
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.base import Parameter
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

BOUNDS = (np.array([-100.0]), np.array([100.0]))


class Wandering:
    """A fit whose every refinement asks for one more step of one, whatever that leaves."""

    def __init__(self, chi2: Sequence[float]) -> None:
        parameter = Parameter("power", "", "of a test", -100.0, 100.0)
        self.fit_parameters = (FitParameter(0, "power", parameter),)
        self.left, self.seen = list(chi2), list[Expansion]()
        self.returned: Expansion | None = None

    def residual(self, values: Floats) -> Floats:
        return values - (self.seen[-1].values + 1.0)

    def expand_at(self, values: Floats) -> Expansion:
        chi2 = self.left[min(len(self.seen), len(self.left) - 1)]
        self.seen.append(Expansion(chi2, chi2, values, *cast(Any, (None, None, ()))))
        return self.seen[-1]

    def return_to(self, before: Expansion) -> None:
        self.returned = before


@pytest.mark.parametrize(
    ("chi2", "asked", "best"),
    [
        ([9e4, 5e4, 4e4, 4.5e4, 6e4, 3e4], 3 + MOST_RISES, 2),
        ([9e4, 5e4, FAR_ABOVE * 5.1e4, 1e4], 3, 1),
        ([5e4, 6e4, 4e4, 4e4], 4, 2),
        ([float(5e4 - 1e3 * k) for k in range(20)], 1 + EXPANSIONS, EXPANSIONS),
    ],
    ids=["rises again and again", "far above", "rises once", "falls all along"],
)
def test_refinement_ends_at_the_best_expansion(
    chi2: Sequence[float], asked: int, best: int
) -> None:
    work = Wandering(chi2)
    found = refine(cast(JointFit, work), np.zeros(1), BOUNDS, 6)
    assert len(work.seen) == asked
    assert found == pytest.approx(work.seen[best].values)
    last = best == asked - 1
    assert work.returned is (None if last else work.seen[best])


def test_a_search_fits_no_structure_twice_from_the_same_parent(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(friction(0.3), EffectValue("load_asymmetry", {"power": 1.0}, (0.1,)))
    asked = list[tuple[Candidate, str]]()
    extend = Search.extend

    def counted(self: Search, parent: Candidate, hypothesis: str) -> Candidate | None:
        asked.append((parent, hypothesis))
        return extend(self, parent, hypothesis)

    monkeypatch.setattr(Search, "extend", counted)
    search.run()
    assert len(asked) == len(set(asked)) > 3


@pytest.mark.parametrize(
    ("left", "rival", "asked"),
    [
        ([9e4, 5e4, 4e4, 4e4], 3e4, 4),
        ([9e4, 5e4, 4e4, 4e4], 0.9e4, 2),
        ([9e4, 4e4, 1.9e4, 1.8e4, 1.8e4], 1e3, 4),
    ],
    ids=["near it", "far above it", "far above it, and falling fast for two times"],
)
def test_refinement_is_given_up_where_it_stays_far_above_a_rival(
    left: Sequence[float], rival: float, asked: int
) -> None:
    work = Wandering(left)
    refine(cast(JointFit, work), np.zeros(1), BOUNDS, 6, rival)
    assert len(work.seen) == asked


@pytest.mark.parametrize(("rival", "longer"), [(np.inf, True), (1.0, False)])
def test_far_above_a_rival_a_refinement_has_few_rounds_at_a_time(
    monkeypatch: pytest.MonkeyPatch, rival: float, longer: bool
) -> None:
    allowed = list[int]()

    def counted(residual: object, start: Floats, *rest: Any, **freshness: bool) -> Any:
        allowed.append(rest[2])
        return start, np.zeros((1, 1)), True

    monkeypatch.setattr(refinement, "minimise", counted)
    refine(cast(JointFit, Wandering([9e4])), np.zeros(1), BOUNDS, 20, rival)
    assert (allowed[0] > STEPS_A_ROUND * ROUNDS_FAR_OFF) is longer


def test_slopes_of_a_fit_are_measured_once_and_only_where_they_are_asked_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    search = search_of(friction(0.3))
    asked = list[Floats]()
    measure = JointFit.slopes

    def counted(self: JointFit, values: Floats) -> Floats:
        asked.append(values)
        return measure(self, values)

    monkeypatch.setattr(JointFit, "slopes", counted)
    found = fit(search.problem, search.noise, (), search.baseline.fit)
    assert found.chi2 > 0
    assert not asked
    assert found.residual @ found.residual <= found.chi2
    assert found.tangent.shape[1] == 3
    assert len(asked) == 1


def test_slopes_that_a_fit_shares_with_the_one_before_it_are_those_that_it_would_measure() -> None:
    search = search_of(friction(0.3), EffectValue("creep", {"time_constant_s": 20.0}, (0.05,)))
    rubbing = Term(find("friction_hysteresis"), friction().shape, None, 0.1)
    one = fit(search.problem, search.noise, (rubbing,), search.baseline.fit)
    creep = Term(find("creep"), {"time_constant_s": 20.0})
    work, values = workspace(search, (*one.terms, creep), one)
    assert first_slopes(work, one, values) is None
    assert one.tangent.shape[1] > len(one.beta)
    found = first_slopes(work, one, values)
    assert found is not None
    shared = [work.terms[each.term].slips for each in work.fit_parameters]
    assert list(~np.isnan(found[0])) == shared
    at = work.residual(values)
    for k in np.flatnonzero(shared):
        ahead = values.copy()
        ahead[k] += 1e-3
        measured = (work.residual(ahead) - at) / 1e-3
        along = found[:, k] @ measured / np.linalg.norm(measured) ** 2
        beside = np.linalg.norm(found[:, k] - measured) / np.linalg.norm(measured)
        assert along == pytest.approx(1.0, abs=0.2)
        assert beside < 0.5


def test_slopes_under_another_noise_are_measured_anew() -> None:
    search = search_of(friction(0.3))
    rubbing = Term(find("friction_hysteresis"), friction().shape, None, 0.1)
    one = fit(search.problem, search.noise.with_model_error(3.0), (rubbing,), search.baseline.fit)
    assert one.tangent.shape[1] > len(one.beta)
    work, values = workspace(search, one.terms, one)
    assert first_slopes(work, one, values) is None


def workspace(
    search: Search, terms: tuple[Term, ...], before: FittedStructure
) -> tuple[JointFit, Floats]:
    """A fit that goes on from another, expanded at its start."""
    parameters = fit_parameters_of(terms, search.problem)
    values = np.array(
        [
            each.to_scale(
                terms[each.term].amplitude
                if each.name == "amplitude"
                else float(terms[each.term].shape[each.name])
            )
            for each in parameters
        ]
    )
    work = JointFit(
        search.problem, search.noise, terms, parameters, before.history, before.mean_deg
    )
    work.expand_at(values)
    return work, values
