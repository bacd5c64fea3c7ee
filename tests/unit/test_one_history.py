"""Runs that go on from each other although the recording takes each to begin afresh."""

from dataclasses import replace
from typing import Literal

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.one_history import friction_of, may_be_one_history
from cyclosweep.recording.unbroken_runs import ONE_HISTORY
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats, present
from tests.support.searches import search_of_recording

NOISE_DEG = 0.05
History = Literal["per-run", "continuous"]
FRICTION = EffectValue("friction_hysteresis", {"slip_deg": 3.0, "scatter": 0.6}, (1.2,))
MODEL = cs.Model(compliance_deg_per_nm=2.7, free_play_deg=28.0, effects=(FRICTION,))


def programme(history: History = "per-run", *, pause_s: float = 60.0) -> cs.Recording:
    """Five loops of one flank, each from the load at which the one before ended."""
    parts = []
    for k, top in enumerate((9.0, 14.0, 6.0, 12.0, 4.0)):
        torque = np.interp(np.arange(160), [0, 80, 159], [1.0, top, 1.0])
        parts.append((torque, np.arange(160.0) + k * (160.0 + pause_s), np.full(160, k + 1)))
    torque, time, run = map(np.concatenate, zip(*parts, strict=True))
    load = cs.Recording.from_arrays(torque, time_s=time, run=run)
    return replace(load, history=history)


def twist(model: cs.Model, load: cs.Recording) -> Floats:
    return present(cs.simulate(model, load).angle_deg)


def measured(history: History, model: cs.Model = MODEL) -> cs.Recording:
    """Readings of a drive with this history, in a recording that says nothing of it."""
    angle = twist(model, programme(history))
    noise = np.random.default_rng(5).normal(0.0, NOISE_DEG, len(angle))
    return programme().with_angle(angle + noise)


@pytest.fixture(scope="module")
def found() -> cs.Diagnosis:
    return cs.diagnose(measured("continuous"), cs.Drive.reference_87())


def test_runs_that_go_on_from_each_other_are_found(found: cs.Diagnosis) -> None:
    assert found.verdict == "IDENTIFIED"
    assert [effect["name"] for effect in found.effects] == ["friction_hysteresis"]
    assert ONE_HISTORY in found.content["notes"]
    assert found.content["repaired"]["rmse_deg"] < 1.2 * NOISE_DEG


def test_the_repaired_model_simulates_its_recording(found: cs.Diagnosis) -> None:
    model = found.model
    assert model is not None
    load = programme()
    missed = twist(model, load) - twist(MODEL, programme("continuous"))
    assert np.sqrt(np.mean(missed**2)) < 0.5 * NOISE_DEG
    again = cs.Model.from_json(model.to_json())
    assert np.array_equal(twist(again, load), twist(model, load))
    afresh = twist(replace(model, one_history=False), load)
    assert np.sqrt(np.mean((afresh - twist(model, load)) ** 2)) > 5.0 * NOISE_DEG
    assert np.array_equal(twist(model, replace(load, reset_between_runs=True)), afresh)


def test_runs_that_begin_afresh_stay_apart() -> None:
    diagnosis = cs.diagnose(measured("per-run"), cs.Drive.reference_87(), full=False)
    assert diagnosis.verdict == "IDENTIFIED"
    assert ONE_HISTORY not in diagnosis.content["notes"]
    assert diagnosis.model is not None
    assert not diagnosis.model.one_history


def test_creep_that_goes_on_is_found_instead_of_a_datum_that_drifts() -> None:
    creep = EffectValue("creep", {"time_constant_s": 150.0}, (0.6,))
    recording = measured("continuous", replace(MODEL, effects=(creep,)))
    diagnosis = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert [effect["name"] for effect in diagnosis.effects] == ["creep"]
    assert ONE_HISTORY in diagnosis.content["notes"]


def test_a_programme_whose_clock_starts_anew_begins_afresh() -> None:
    model, anew = replace(MODEL, one_history=True), programme(pause_s=-160.0)
    assert np.array_equal(twist(model, anew), twist(MODEL, anew))
    assert not np.allclose(twist(model, programme()), twist(MODEL, programme()))


def test_a_rig_that_was_reset_has_no_history() -> None:
    recording = replace(measured("continuous"), reset_between_runs=True)
    diagnosis = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert ONE_HISTORY not in diagnosis.content["notes"]
    assert diagnosis.content["repaired"]["rmse_deg"] > 2.0 * NOISE_DEG


LOADED_FRICTION = EffectValue("load_dependent_friction", {"slip_deg": 3.0, "scatter": 0.6}, (0.1,))


@pytest.mark.parametrize("standing_in", [FRICTION, LOADED_FRICTION], ids=lambda value: value.name)
def test_friction_that_goes_on_is_tried_where_another_may_stand_in_for_it(
    standing_in: EffectValue,
) -> None:
    joined = search_of_recording(measured("continuous"), one_history=True)
    within_noise = search_of_recording(measured("per-run", replace(MODEL, effects=(standing_in,))))
    found = within_noise.extend(within_noise.baseline, standing_in.name)
    assert found is not None
    assert found.fit.rmse_deg < 1.2 * NOISE_DEG
    friction = friction_of(lambda: joined, found.fit)
    assert (friction is None) == (standing_in is FRICTION)
    much_left = friction_of(lambda: joined, within_noise.baseline.fit)
    for each in (friction, much_left):
        assert each is None or each.rmse_deg < 1.2 * NOISE_DEG
    assert much_left is not None


def to_and_fro(tops: tuple[float, ...], limit_nm: float, slip_deg: float) -> cs.Recording:
    """Loops to both sides, one a run, of friction that goes on from each to the next."""
    steps = np.arange(109)
    parts = []
    for k, top in enumerate(tops):
        torque = np.interp(steps, [0, 27, 81, 108], [0.01, top, -top, 0.01])
        parts.append((torque, 1.1 * steps + 150.0 * k, np.full(len(steps), k + 1)))
    torque, time, run = map(np.concatenate, zip(*parts, strict=True))
    load = cs.Recording.from_arrays(torque, time_s=time, run=run)
    shape = {"slip_deg": slip_deg, "scatter": 0.8}
    model = replace(MODEL, effects=(EffectValue("friction_hysteresis", shape, (limit_nm,)),))
    angle = twist(model, replace(load, history="continuous"))
    return load.with_angle(angle + np.random.default_rng(1).normal(0.0, 0.02, len(angle)))


def test_runs_that_are_read_from_a_load_on_need_no_other_effect() -> None:
    """Sharp friction that holds beyond the first reading asked for a line with a kink beside it.

    That line took the whole compliance, so that the recording was said to be at fault.
    """
    whole = to_and_fro((6.0,) * 7, 0.38, 0.2)
    recording = whole.take(np.flatnonzero(np.arange(len(whole)) % 109 > 0))
    diagnosis = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert diagnosis.verdict == "IDENTIFIED"
    assert [effect["name"] for effect in diagnosis.effects] == ["friction_hysteresis"]
    assert diagnosis.content["repaired"]["rmse_deg"] < 0.025


@pytest.mark.parametrize(
    ("recording", "may_be"),
    [
        (programme(), True),
        (programme("continuous"), False),
        (replace(programme(), reset_between_runs=True), False),
        (programme(pause_s=-160.0), False),
        (replace(programme(), time_s=None), True),
        (replace(programme(), run=np.zeros(800, dtype=np.int64)), False),
    ],
    ids=["pauses", "stated", "reset", "clock that starts anew", "no clock", "one run"],
)
def test_which_recordings_may_be_one_history(recording: cs.Recording, may_be: bool) -> None:
    assert may_be_one_history(recording) is may_be
