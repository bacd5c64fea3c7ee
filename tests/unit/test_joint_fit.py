"""Joint fits of friction and what bends the elastic law: both settle on each other."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import calibrate
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.other_laws import with_better_laws
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.simulation.effects import effects, find
from cyclosweep.simulation.model import EffectValue
from cyclosweep_challenge.scoreboard.made import Recipe, make

DRIVE = cs.Drive.reference_87()
SLIP = {"slip_deg": 2.0, "scatter": 0.5, "skew": 0.0, "slack": 0.0}


def search_of(*values: EffectValue) -> Search:
    """Calibrated search of a recording made by a model with these effects."""
    programme = make(Recipe(4_420))
    angle = cs.simulate(cs.Model(2.5, 28.0, 0.0, effects=values), programme).angle_deg
    assert angle is not None
    noise = np.random.default_rng(3).normal(0.0, 0.05, angle.size)
    recording = programme.with_angle(angle + noise)
    line, pins = DRIVE.nominal_line(recording.side), int(DRIVE.output_pin_count)
    problem = prepare(recording, line, pins)
    library = build_library(problem.history, problem.fitted, tuple(effects()))
    return calibrate(problem, library, 0)


def settled(search: Search, fitted: FittedStructure) -> float:
    """How far a fit moves when it is begun where it ended, over the noise."""
    again = fit(search.problem, search.noise, fitted.terms, fitted)
    use = search.problem.fitted
    moved = float(np.sqrt(np.mean((again.mean_deg - fitted.mean_deg)[use] ** 2)))
    return moved / search.noise.sigma_deg


def test_friction_beside_a_steep_stiffening_settles() -> None:
    # With the line alone in the solver, and two expansions, the fit ended at 1 deg.
    stiffening = EffectValue("contact_stiffening", {"turn_nm": 1.0}, (1.0,))
    search = search_of(EffectValue("friction_hysteresis", SLIP, (2.0,)), stiffening)
    terms = (
        Term(find("friction_hysteresis"), {**SLIP, "slip_deg": 1.0}, None, 1.0),
        Term(find("contact_stiffening"), {"turn_nm": 3.0}),
    )
    found = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    assert found.rmse_deg < 1.1 * 0.05
    assert settled(search, found) < 0.05
    assert found.terms[0].amplitude == pytest.approx(2.0, rel=0.02)


@pytest.mark.parametrize("growth", [0.2, 1.0])
def test_how_presliding_grows_with_the_load_is_fitted(growth: float) -> None:
    shape = {**SLIP, "growth": growth, "reference_nm": 8.0}
    search = search_of(EffectValue("load_dependent_friction", shape, (0.2,)))
    begun = Term(find("load_dependent_friction"), {**shape, "growth": 0.7}, None, 0.1)
    found = fit(search.problem, search.noise, (begun,), search.baseline.fit, rounds=20)
    assert found.terms[0].shape["growth"] == pytest.approx(growth, abs=0.1)
    assert found.rmse_deg < 1.1 * 0.05


def test_a_law_gives_way_to_another_one_of_its_class_once_the_rest_is_known() -> None:
    shape = {"kink_1_nm": 5.0, "kink_2_nm": 11.0}
    search = search_of(EffectValue("clearance_takeup", shape, (0.4, 0.4)))
    stiffening = Term(find("contact_stiffening"), {"turn_nm": 3.0})
    wrong = search.refit((stiffening,), search.baseline.fit)
    begun = Search(search.problem, search.noise, search.library, 0, wrong.fit)
    assert with_better_laws(begun)[0].names == ("clearance_takeup",)
    right = Term(find("clearance_takeup"), shape)
    kept = Search(
        search.problem, search.noise, search.library, 0,
        search.refit((right,), search.baseline.fit).fit,
    )  # fmt: skip
    assert with_better_laws(kept)[0] is kept.start.fit


def test_kinks_may_change_places_but_the_first_lies_in_the_lower_half() -> None:
    search = search_of(EffectValue("clearance_takeup", {"kink_1_nm": 5.0}, (0.4,)))
    effect, history = find("clearance_takeup"), search.problem.history
    top = history.largest_torque_nm
    early = {"kink_1_nm": 0.7 * top, "kink_2_nm": 0.3 * top}
    late = {"kink_1_nm": 0.7 * top, "kink_2_nm": 0.8 * top}
    assert effect.is_recognised(history, early, np.ones(2))
    assert not effect.is_recognised(history, late, np.ones(2))


def test_another_law_never_takes_the_place_of_one_that_fits_better() -> None:
    kinks = {f"kink_{k}_nm": 1.5 * k for k in range(1, 6)}
    takeup = EffectValue("clearance_takeup", kinks, (0.2,) * 5)
    search = search_of(EffectValue("friction_hysteresis", SLIP, (2.0,)), takeup)
    terms = (
        Term(find("friction_hysteresis"), SLIP, None, 2.0),
        Term(find("clearance_takeup"), kinks),
    )
    accepted = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    again = Search(search.problem, search.noise, search.library, 0, accepted)
    assert with_better_laws(again)[0].chi2 <= again.start.fit.chi2
