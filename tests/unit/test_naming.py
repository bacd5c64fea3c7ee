"""Which laws of a simulation of whole loops may be named where another of them may not."""

import re
from collections.abc import Sequence

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.behaviour_classes import ODD_CURVE
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws import naming
from cyclosweep.diagnosis.identify.laws.class_check import check_laws
from cyclosweep.diagnosis.identify.laws.law_in_class import LawCheck
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.whole_loop.forecast import fit_forecast, starting_model
from cyclosweep.diagnosis.whole_loop.known_flank import WholeLoopFit, whole_loop_fit
from cyclosweep.simulation import effects
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import COMPLIANCE, friction, long_recording

NAMES = ("friction_hysteresis", "contact_stiffening")
WITHDRAWN = LawCheck("contact_stiffening", ODD_CURVE, 0.0, 9.0, holds=False)


@pytest.fixture(scope="module")
def searched() -> Search:
    """A large friction and a contact that stiffens, calibrated, with nothing searched."""
    bent = EffectValue("contact_stiffening", {"turn_nm": 3.0}, (0.4,))
    recording = long_recording(1_500, [friction(3.0), bent])
    drive = cs.Drive.reference_87()
    problem = prepare(recording, drive.nominal_line("input"), int(drive.output_pin_count))
    library = build_library(problem.history, problem.fitted, [effects.find(n) for n in NAMES])
    return calibrate(problem, library, seed=0)


@pytest.fixture(scope="module")
def whole(searched: Search) -> WholeLoopFit:
    """Both laws, fitted as a simulation to whole loops."""
    problem, values = (
        searched.problem,
        [friction(3.0), EffectValue(NAMES[1], {"turn_nm": 3.0}, (0.4,))],
    )
    terms = [
        Term(effects.find(NAMES[0]), values[0].shape, None, 3.0 / COMPLIANCE),
        Term(effects.find(NAMES[1]), values[1].shape),
    ]
    base = fit_forecast(problem, starting_model(problem), (), zero=False, most=5)
    model = cs.Model(COMPLIANCE, 28.0, 0.1, effects=tuple(values))
    both = fit_forecast(problem, model, terms, zero=False, most=5)
    return whole_loop_fit(both, base, searched.noise)


def test_a_law_is_judged_beside_the_whole_class_of_a_stand_in(whole: WholeLoopFit) -> None:
    assert [(each.name, each.holds) for each in check_laws(whole)] == [(n, True) for n in NAMES]
    (check,) = check_laws(whole, [WITHDRAWN])
    assert check.name == "friction_hysteresis"
    assert check.holds


def test_friction_keeps_its_name_where_the_curve_beside_it_loses_its_own(
    searched: Search, whole: WholeLoopFit, monkeypatch: pytest.MonkeyPatch
) -> None:
    def without_curve(
        fitted: FittedStructure, stand_ins: Sequence[LawCheck] = ()
    ) -> tuple[LawCheck, ...]:
        held = [each for each in check_laws(fitted, stand_ins) if each.name != NAMES[1]]
        return (*held, *(() if stand_ins else (WITHDRAWN,)))

    monkeypatch.setattr(naming, "check_laws", without_curve)
    candidate = searched.judged(whole, 0.0, 0.0)
    found = naming.names_that_hold(searched, candidate, candidate)
    assert found.names == {"friction_hysteresis"}
    assert [each.name for each in found.withdrawn] == ["contact_stiffening"]
    # What is named alone is fitted to whole loops, too.
    assert isinstance(found.part.fit, WholeLoopFit)
    assert found.part.fit.names == ("friction_hysteresis",)


def test_a_prediction_says_which_readings_its_error_counts(
    searched: Search, whole: WholeLoopFit
) -> None:
    contact = searched.baseline.fit
    assert contact.prediction.counted == "readings in contact"
    assert whole.prediction.counted == "whole loops"
    # Errors before and after are of one kind.
    assert whole.baseline_prediction(contact).counted == "whole loops"
    assert contact.baseline_prediction(contact).counted == "readings in contact"


def test_bounds_of_shapes_add_to_what_whole_loops_tell(whole: WholeLoopFit) -> None:
    """Errors were once those of the flanks alone, 0.16 to 0.64 of these."""
    scale = np.sqrt(np.diag(whole.covariance))
    told = np.linalg.inv(whole.covariance / np.outer(scale, scale))
    for place, each in enumerate(whole.fit_parameters, len(whole.beta)):
        room = each.to_scale(each.quantity.upper) - each.to_scale(each.quantity.lower)
        told[place, place] += 12.0 * (scale[place] / room) ** 2
    bounded = whole.covariance_within_bounds / np.outer(scale, scale)
    np.testing.assert_allclose(bounded, np.linalg.inv(told), rtol=1e-5, atol=1e-7)
    assert np.all(np.diag(bounded) < 1.0 + 1e-9)


def test_what_is_known_of_each_parameter_adds_to_what_whole_loops_tell(whole: WholeLoopFit) -> None:
    # Compliance and amplitudes are fitted by their logarithm, and in another order.
    scale = np.sqrt(np.diag(whole.covariance))
    told = np.linalg.inv(whole.covariance / np.outer(scale, scale))
    for place, known in enumerate(scale):
        information = np.zeros(len(scale))
        information[place] = 1.0 / known**2
        more = told.copy()
        more[place, place] += 1.0
        found = whole.covariance_given(information) / np.outer(scale, scale)
        np.testing.assert_allclose(found, np.linalg.inv(more), rtol=1e-4, atol=1e-6)


def test_a_friction_has_one_interval_wherever_it_is_said(whole: WholeLoopFit) -> None:
    (text,) = (
        each.text
        for each in whole.findings(None, unsteady=False)
        if each.topic == "friction hysteresis"
    )
    said = re.search(r"friction of (\S+) ± (\S+) N m", text)
    assert said is not None
    place = next(k for k, each in enumerate(whole.fit_parameters) if each.name == "amplitude")
    error = np.sqrt(
        whole.covariance_within_bounds[len(whole.beta) + place, len(whole.beta) + place]
    )
    assert float(said[2]) == pytest.approx(1.96 * error, rel=0.06)
    assert float(said[1]) == pytest.approx(whole.terms[0].amplitude, rel=0.01)
