"""Effects that may be the error of a larger one's law, by what that law cannot miss."""

import numpy as np
import pytest

import cyclosweep.diagnosis.identify.laws.model_error_terms as model_error_terms
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.model_error_terms import (
    LEAST_OF_MISMATCH,
    LEAST_OF_RECORDED,
    without_model_error,
)
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import friction
from tests.support.searches import search_of

WARM = EffectValue("thermal_drift", {"datum": 1.0}, (1.8,))
CREEP = EffectValue("creep", {"time_constant_s": 20.0}, (0.67,))
SMALL_DEG = 0.1


def of(search: Search, *values: EffectValue) -> FittedStructure:
    terms = [
        Term(find(v.name), dict(v.shape), None, v.amplitudes[0] if "slip_deg" in v.shape else 0.0)
        for v in values
    ]
    return fit(search.problem, search.noise, tuple(terms), search.baseline.fit, rounds=20)


@pytest.mark.parametrize(("large", "kept"), [(WARM, True), (CREEP, False)])
def test_a_small_loop_is_no_error_of_a_law_without_memory(
    large: EffectValue, kept: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As large as a fraction of the mismatch that a law with memory may miss as a loop.
    monkeypatch.setattr(model_error_terms, "TIMES_WHAT_IS_LEFT", np.inf)
    small = friction(SMALL_DEG)
    search = search_of(large, small)
    found = of(search, large, small)
    share = float(np.std(recalibrated_twist(found, 1))) / search.baseline.fit.rmse_deg
    assert LEAST_OF_RECORDED < share < LEAST_OF_MISMATCH
    names = {
        term.name
        for term in without_model_error(found, of(search, large), search.baseline.fit.rmse_deg)
    }
    assert names == ({large.name, small.name} if kept else {large.name})
