"""Variants of an accepted effect, between which a fit with less beside it decided."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.variants import in_better_variant
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.starting_terms import starting_terms
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import present
from tests.support.searches import search_of, search_of_recording
from tests.validation.test_turns_between_readings import FRICTION, read_once_a_second

BETWEEN = {"power": 0.7, "lag_s": 1.0}
BY_READING = {**BETWEEN, "by_reading": 1.0}
NOISE_DEG = 0.05
THINNING = {"thinned_power": 0.3, "thinning_deg_per_s": 0.4, "lag_s": 1.0}
SLOWLY = {**BETWEEN, "approach_s": 200.0}
DRAG_NM = 0.8


def drag(shape: dict[str, float]) -> Search:
    """Search of a recording with a drag whose lag is not much shorter than a step."""
    history = search_of().problem.history
    own = find("viscous_drag").consistent(history, shape, np.array([DRAG_NM]))
    return search_of(EffectValue("viscous_drag", dict(own), (DRAG_NM,)))


def fitted(search: Search, shape: dict[str, float]) -> FittedStructure:
    term = Term(find("viscous_drag"), shape)
    return fit(search.problem, search.noise, (term,), search.baseline.fit, rounds=20)


@pytest.mark.parametrize(
    ("made", "taken"),
    [(BETWEEN, BY_READING), (BY_READING, BETWEEN), (THINNING, BETWEEN), (SLOWLY, BETWEEN)],
    ids=["between", "by reading", "thinning", "slowly"],
)
def test_the_variant_that_fits_takes_the_place_of_the_other(
    made: dict[str, float], taken: dict[str, float]
) -> None:
    search = drag(made)
    wrong = fitted(search, taken)
    right = in_better_variant(wrong)
    assert right.rmse_deg < 0.8 * wrong.rmse_deg
    assert right.rmse_deg < 1.02 * NOISE_DEG
    found = right.terms[0].shape.keys()
    assert found >= made.keys()
    assert ("by_reading" in found) == ("by_reading" in made)
    assert in_better_variant(right) is right


def test_a_search_starts_from_both_variants_and_from_one_of_other_effects() -> None:
    search = drag(BETWEEN)
    begun = [dict(term.shape) for term, _, _ in starting_terms(search.baseline, "viscous_drag")]
    assert [each.get("by_reading", 0.0) for each in begun] == [0.0, 1.0]


def test_friction_turns_where_the_recording_says() -> None:
    # Of the same readings, one recording was solved from reading to reading.
    load = read_once_a_second()
    shape = dict(FRICTION.shape)
    for made in (shape, {**shape, "by_reading": 1.0}):
        model = cs.Model(
            compliance_deg_per_nm=1.4,
            free_play_deg=14.0,
            effects=(EffectValue("friction_hysteresis", made, FRICTION.amplitudes),),
        )
        noise = np.random.default_rng(1).normal(0.0, 0.04, len(load))
        search = search_of_recording(
            load.with_angle(present(cs.simulate(model, load).angle_deg) + noise)
        )
        for taken in (shape, {**shape, "by_reading": 1.0}):
            term = Term(find("friction_hysteresis"), taken, None, 1.2)
            begun = fit(search.problem, search.noise, (term,), search.baseline.fit, rounds=20)
            assert in_better_variant(begun).terms[0].shape.keys() == made.keys()


def test_friction_without_corners_has_one_variant() -> None:
    history = search_of().problem.history
    assert len(history.corners) == 0
    assert len(find("friction_hysteresis").variants(history, dict(FRICTION.shape))) == 1
