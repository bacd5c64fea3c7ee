"""Friction of a drive that was worked to and fro before its first reading."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.behaviour_classes import LOOP, class_columns
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats, present
from tests.support.searches import search_of_recording

TOP_NM, WORKED_NM = 14.0, 8.4
LIMIT_NM, SLIP_DEG, SCATTER = 0.6, 3.0, 0.8
NOISE_DEG = 0.15
LINE = cs.Model(compliance_deg_per_nm=2.7, free_play_deg=4.0)


def friction(**shape: float) -> EffectValue:
    """Constant friction of the fixture, with more of a shape."""
    return EffectValue(
        "friction_hysteresis", {"slip_deg": SLIP_DEG, "scatter": SCATTER, **shape}, (LIMIT_NM,)
    )


def loaded_friction(**shape: float) -> EffectValue:
    """Friction in proportion to the load."""
    own = {"slip_deg": SLIP_DEG, "scatter": SCATTER}
    return EffectValue("load_dependent_friction", {**own, **shape}, (0.08,))


def loops(before: tuple[float, ...] = (), runs: int = 1, rows: int = 500) -> cs.Recording:
    """Loops of a triangle, each run after some loads that are readings themselves."""
    place = np.linspace(0.0, 3.0, rows)
    triangle = TOP_NM * np.interp(place % 1.0, [0.0, 0.25, 0.75, 1.0], [0.0, 1.0, -1.0, 0.0])
    torque = np.r_[before, 0.001 * TOP_NM, triangle[1:]]
    run = np.repeat(np.arange(runs), len(torque))
    return cs.Recording.from_arrays(np.tile(torque, runs), run=run)


def twist(effects: tuple[EffectValue, ...], load: cs.Recording, model: cs.Model = LINE) -> Floats:
    return present(cs.simulate(replace(model, effects=effects), load).angle_deg)


@pytest.mark.parametrize("make", [friction, loaded_friction])
@pytest.mark.parametrize("place", [{"slack": 0.0}, {"slack": 1.0}, {"behind_play": 1.0}], ids=str)
@pytest.mark.parametrize("load_nm", [WORKED_NM, -WORKED_NM, 0.3 * WORKED_NM])
def test_conditioning_is_that_of_readings_before(
    make: Callable[..., EffectValue], place: dict[str, float], load_nm: float
) -> None:
    long = twist((make(**place),), loops((-load_nm, load_nm), runs=2))
    seen = np.arange(len(long)) % (len(long) // 2) >= 2
    short = twist((make(**place, conditioning_nm=load_nm),), loops(runs=2))
    assert np.max(np.abs(short - long[seen])) < 1e-9
    fresh = twist((make(**place),), loops(runs=2))
    assert np.max(np.abs(fresh - short)) > 1e-3 * SLIP_DEG


def test_torque_follows_from_the_angle_within_the_error_of_a_line() -> None:
    model = replace(LINE, effects=(friction(slack=0.0, conditioning_nm=-WORKED_NM),))
    load = loops()
    programme = load.with_angle(twist(model.effects, load))
    again = cs.simulate(model, programme, predict="torque").torque_nm
    assert np.max(np.abs(again - load.torque_nm)) < 0.1 * LIMIT_NM


def test_the_class_of_a_loop_begins_as_its_friction() -> None:
    model = replace(LINE, free_play_deg=0.0)
    load = loops()
    angle = twist((friction(slack=0.0, conditioning_nm=-WORKED_NM),), load, model)
    loop = angle - twist((), load, model)
    history = search_of_recording(load.with_angle(angle)).problem.history
    missed = []
    for conditioning_nm in (-WORKED_NM, 0.0):
        columns = class_columns(history, conditioning_nm)[LOOP]
        amplitudes = np.linalg.lstsq(columns, loop, rcond=None)[0]
        missed.append(float(np.std(loop - columns @ amplitudes)))
    assert missed[0] < 0.5 * missed[1]


@pytest.fixture(scope="module")
def worked() -> cs.Diagnosis:
    """Diagnosis of friction and stiffening, of a drive that was worked to 0.6 of the load."""
    stiffening = EffectValue("contact_stiffening", {"cubic_nm": 6.0}, (3.0,))
    load = loops((WORKED_NM, -WORKED_NM), rows=1500)
    angle = twist((friction(slack=0.0), stiffening), load)
    noise = np.random.default_rng(7).normal(0.0, NOISE_DEG, len(angle))
    kept = np.arange(2, len(angle))
    recording = replace(load, time_s=0.5 * np.arange(float(len(angle)))).with_angle(angle + noise)
    return cs.diagnose(recording.take(kept), cs.Drive.reference_87(), full=False)


def test_friction_of_a_worked_drive_is_found(worked: cs.Diagnosis) -> None:
    assert worked.verdict == "IDENTIFIED"
    names = {effect["name"] for effect in worked.effects}
    assert names == {"friction_hysteresis", "contact_stiffening"}
    assert worked.content["repaired"]["rmse_deg"] < 1.15 * NOISE_DEG
    assert worked.model is not None
    shape = next(e.shape for e in worked.model.effects if e.name == "friction_hysteresis")
    assert shape["conditioning_nm"] < 0.0
    assert any("left from the negative side" in note for note in worked.content["notes"])


def test_fresh_friction_needs_no_conditioning() -> None:
    load = loops(rows=1500)
    angle = twist((friction(slack=0.0),), load)
    noise = np.random.default_rng(8).normal(0.0, NOISE_DEG, len(angle))
    recording = replace(load, time_s=0.5 * np.arange(float(len(angle)))).with_angle(angle + noise)
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.model is not None
    assert all("conditioning_nm" not in effect.shape for effect in found.model.effects)
