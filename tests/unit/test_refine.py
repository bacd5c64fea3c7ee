"""Refinement of a joint fit: where it ends when path and law do not settle, and what it costs."""

from collections.abc import Sequence
from typing import Any, cast

import numpy as np
import pytest

from cyclosweep.diagnosis.identify.fitting import refine as refinement
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fit_parameters import FitParameter
from cyclosweep.diagnosis.identify.fitting.fit_state import Expansion
from cyclosweep.diagnosis.identify.fitting.joint_fit import JointFit
from cyclosweep.diagnosis.identify.fitting.refine import (
    EXPANSIONS,
    FAR_ABOVE,
    MOST_RISES,
    ROUNDS_FAR_OFF,
    STEPS_A_ROUND,
    refine,
)
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
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
