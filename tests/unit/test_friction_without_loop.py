"""Friction that adds a curve of the torque, and no loop, is not taken out first."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.loop_check import is_curve_of_torque, is_without_loop
from cyclosweep.diagnosis.identify.stages.friction_first import friction_first
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.history import Floats
from cyclosweep.simulation.model import EffectValue
from tests.support.long_recording import COMPLIANCE, friction, long_recording
from tests.support.searches import search_of_recording

TOP, PLAY, C = 20.0, 28.0, 2.7
SLIDE = {"slip_deg": 8.0, "scatter": 0.6, "slack": 0.0}


def curve(torque: Floats) -> Floats:
    """Twist of a drive without friction that is stiff at small loads [deg]."""
    held = 6.0 * np.tanh(np.abs(torque) / 5.0)
    return np.asarray(np.sign(torque) * (PLAY - held) + C * torque)


def recorded(torque: Floats, angle: Floats, runs: int) -> cs.Recording:
    """Recording with a little noise, in runs of the same length."""
    noise = 0.02 * np.random.default_rng(8).normal(size=len(torque))
    run = np.repeat(np.arange(runs), len(torque) // runs)
    return cs.Recording.from_arrays(torque, angle + noise, run=run, side="input")


def ramps() -> cs.Recording:
    """Loads that rise only, from zero in each run and in turn in both directions."""
    one = TOP * np.linspace(0.01, 1.0, 60)
    torque = np.concatenate([one, -one, 0.7 * one, -0.7 * one])
    return recorded(torque, curve(torque), 4)


def loop() -> cs.Recording:
    """Loops of one friction that sticks over 8 deg, after Jenkins."""
    one = np.concatenate([np.linspace(0, 1, 40), np.linspace(1, -1, 80), np.linspace(-1, 0, 40)])
    torque = np.concatenate([TOP * one, 0.7 * TOP * one])
    angle, at, anchor = np.zeros(len(torque)), 0.0, 0.0
    for i, load in enumerate(torque):
        anchor = 0.0 if i == len(one) else anchor
        for _ in range(60):
            state = np.clip((at - anchor) / 8.0, -1.0, 1.0)
            at = 0.5 * at + 0.5 * C * (load - 3.0 * state)
        anchor = np.clip(anchor, at - 8.0, at + 8.0)
        angle[i] = at
    return recorded(torque, angle + PLAY * np.sign(torque), 2)


@pytest.mark.parametrize(("recording", "is_curve"), [(ramps(), True), (loop(), False)])
def test_what_a_friction_adds(recording: cs.Recording, is_curve: bool) -> None:
    search = search_of_recording(recording)
    term = Term(find("friction_hysteresis"), SLIDE, None, 2.0)
    fitted = fit(search.problem, search.noise, (term,), search.baseline.fit, rounds=20)
    assert fitted.rmse_deg < 0.5 * search.baseline.fit.rmse_deg
    assert is_curve_of_torque(fitted) == is_curve
    first = friction_first(search, search.noise.with_model_error(10.0))
    assert (first is None) == is_curve
    assert not is_curve_of_torque(search.baseline.fit)


def test_a_curve_of_the_elastic_torque_is_no_curve_without_the_loop() -> None:
    # The elastic torque is what friction leaves of the applied one, and holds the loop.
    shape = {"first_nm": 0.01, "range_nm": 0.02}
    recording = long_recording(
        1_500, [friction(3.0), EffectValue("clearance_takeup", shape, (0.5,))]
    )
    search = search_of_recording(recording)
    terms = (
        Term(find("friction_hysteresis"), friction(3.0).shape, None, 3.0 / COMPLIANCE),
        Term(find("clearance_takeup"), shape),
    )
    fitted = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    assert fitted.rmse_deg < 0.06
    assert not is_without_loop(fitted, 0)
