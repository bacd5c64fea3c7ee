"""Stages of a search: how large what a structure leaves is, against the noise alone."""

import pytest

from cyclosweep.diagnosis.hypotheses.flexible_basis import flexible_basis
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.staged_search import FAINT, visibility
from cyclosweep.simulation.model import EffectValue
from tests.support.searches import search_of

CREEP = EffectValue("creep", {"lag_s": 20.0}, (2.0,))


def test_what_is_left_is_measured_against_the_noise_alone_however_it_was_fitted() -> None:
    # Measured against noise and model error, all that a law misses counted as faint, the last
    # stage judged the law by the noise alone, and it lost its name.
    search = search_of(CREEP)
    flexible = flexible_basis(search.problem, search.library)
    by_noise = search.baseline.fit
    loud = search.noise.with_model_error(20.0)
    by_both = fit(search.problem, loud, (), by_noise)
    left = visibility(by_noise, search.noise, flexible)
    assert left > 3.0 * FAINT
    assert visibility(by_both, search.noise, flexible) == pytest.approx(left, rel=0.01)
