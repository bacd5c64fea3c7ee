"""Friction whose limit a recording does not reach: what is said of the loop is measured on it."""

import re

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.whole_loop.forecast import fit_forecast, starting_model
from cyclosweep.diagnosis.whole_loop.known_flank import WholeLoopFit, whole_loop_fit
from cyclosweep.diagnosis.whole_loop.loop_width import widest_nm
from cyclosweep.report import ReportData
from cyclosweep.report.loop_width import fitted_frictions
from cyclosweep.result import Answer, EffectParameter, FoundEffect, Size
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.simulate import EffectValue
from tests.support.arrays import Floats, present

TOP = 24.0


def programme(runs: int = 3) -> cs.Recording:
    one = TOP * np.r_[0:1:100j, 1:-1:200j, -1:0:100j]
    torque = np.tile(one, runs)
    run = np.repeat(np.arange(runs), len(one))
    return cs.Recording.from_arrays(torque, run=run, side="output", history="continuous")


def drive() -> cs.Drive:
    known = cs.Drive.reference_87()
    return known.model_copy(update={"output_stiffness_nm_per_arcmin": 0.2, "free_play_deg": 0.0})


def shape_of(slip_deg: float) -> dict[str, float]:
    return {"slip_deg": slip_deg, "scatter": 2.0 if slip_deg > 0.5 else 0.6, "skew": 0.0}


def model_of(limit_nm: float, slip_deg: float) -> cs.Model:
    return cs.Model(
        compliance_deg_per_nm=0.08,
        free_play_deg=1e-3,
        datum_deg=0.3,
        side="output",
        effects=(EffectValue("friction_hysteresis", shape_of(slip_deg), (limit_nm,)),),
    )


def loop(limit_nm: float, slip_deg: float) -> cs.Recording:
    load = programme()
    angle = present(cs.simulate(model_of(limit_nm, slip_deg), load).angle_deg)
    noise = 4e-4 * np.random.default_rng(4).normal(size=len(angle))
    return load.with_angle(angle + noise)


def width_of(recording: cs.Recording) -> float:
    """Largest width in torque at equal angle, between the branches of the last run."""
    last = recording.run == recording.run.max()
    torque, angle = recording.torque_nm[last], present(recording.angle_deg)[last]
    falling = slice(int(torque.argmax()), int(torque.argmin()) + 1)
    order = np.argsort(angle[falling])
    down: Floats = np.interp(angle, angle[falling][order], torque[falling][order])
    rising = np.r_[np.zeros(torque.argmin(), bool), np.ones(len(torque) - torque.argmin(), bool)]
    return float((torque - down)[rising].max())


def fitted(recording: cs.Recording, limit_nm: float, slip_deg: float) -> WholeLoopFit:
    """The law with which the recording was made, as a fit of whole loops."""
    problem = prepare(recording, drive().nominal_line("output"), 8)
    term = Term(find("friction_hysteresis"), shape_of(slip_deg), None, limit_nm)
    alone = fit_forecast(problem, starting_model(problem), (), zero=False)
    law = fit_forecast(problem, model_of(limit_nm, slip_deg), (term,), zero=False, most=1)
    return whole_loop_fit(
        law, alone, Noise(4e-4, 0.0, 0.0, np.inf, 0.0, 1e3, problem.gap[problem.fitted])
    )


@pytest.fixture(scope="module")
def unreached() -> tuple[cs.Recording, WholeLoopFit]:
    """Presliding as long as the twist: the limit lies beyond the torque that is taken."""
    recording = loop(limit_nm=9.0, slip_deg=0.75)
    return recording, fitted(recording, 9.0, 0.75)


def texts(fit: WholeLoopFit) -> dict[str, str]:
    return {each.topic: each.text for each in fit.findings(None, unsteady=False)}


def test_the_width_that_is_stated_is_that_of_the_loop(
    unreached: tuple[cs.Recording, WholeLoopFit],
) -> None:
    recording, fit = unreached
    text = texts(fit)["friction hysteresis"]
    stated = re.search(r"up to ([\d.]+) N m wide at equal angle", text)
    assert stated, text
    # It was twice the limit of the law, which no reading comes near.
    assert float(stated[1]) == pytest.approx(width_of(recording), rel=0.05)
    assert "was not reached" in text


def test_a_limit_beyond_the_recording_hides_neither_play_nor_stiffness(
    unreached: tuple[cs.Recording, WholeLoopFit],
) -> None:
    _, fit = unreached
    assert fit.terms[0].amplitude > 0.35 * TOP, "the limit would hide them"
    assert fit.hidden_play is None
    assert not texts(fit)["stiffness"].startswith("Not reported")


def test_friction_that_is_reached_and_large_hides_them_as_before() -> None:
    fit = fitted(loop(limit_nm=12.0, slip_deg=0.05), 12.0, 0.05)
    said = texts(fit)
    assert "as friction hides it: Coulomb friction takes up to" in said["play"]
    assert "was not reached" not in said["friction hysteresis"]


def test_an_effect_carries_the_torque_that_was_reached() -> None:
    found = cs.diagnose(loop(limit_nm=3.0, slip_deg=0.05), drive(), full=False)
    (friction,) = found.answer.effects
    assert friction.reached_nm == pytest.approx(3.0, rel=0.1)


def test_the_row_of_the_fitted_torque_says_how_much_of_it_was_reached() -> None:
    torque = EffectParameter(
        estimate=5.3, std_error=1.3, unit="N m", meaning="Coulomb friction torque"
    )

    def label(reached_nm: float | None) -> str:
        effect = FoundEffect(
            name="friction_hysteresis",
            parameters={"friction_torque_nm": torque},
            size_deg=Size(estimate=1.0, ci95=(0.9, 1.1)),
            reached_nm=reached_nm,
        )
        answer = Answer(verdict="MOSTLY_EXPLAINED", effects=(effect,))
        ((text, _),) = fitted_frictions(ReportData(recording=programme(), result=answer))
        return text

    plain = "Coulomb friction torque at the output, fitted"
    assert label(5.2) == label(None) == plain
    assert label(3.79) == f"{plain} limit (3.79 N m reached)"


def test_the_widest_place_of_a_path_is_found_within_one_run() -> None:
    recording = loop(limit_nm=3.0, slip_deg=0.02)
    problem = prepare(recording, drive().nominal_line("output"), 8)
    path = problem.history.with_state(angle_deg=problem.angle_deg)
    everything = np.ones(len(path), dtype=bool)
    assert widest_nm(path, everything) == pytest.approx(6.0, rel=0.05)
    assert widest_nm(path, ~everything) is None
    rising = (path.run == 0) & (np.arange(len(path)) < 90)
    assert widest_nm(path, rising) is None, "no angle is passed twice"
