"""A torque read from a wrong zero is found by the odd curve that it makes uneven."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import Floats, present

TOP_NM = 8.0
PLAY_DEG = 28.0
NOISE_DEG = 0.02
SLIP_DEG = 0.6
STRAIGHT_DEG_PER_NM = 1.9


def loops() -> Floats:
    """Torque of two loops through zero [N m]."""
    rise = np.linspace(0.02, 1.0, 140)
    half = np.concatenate([rise, rise[-2::-1]])
    found: Floats = TOP_NM * np.concatenate([half, -half, 0.6 * half, -0.6 * half])
    return found


def elastic(torque: Floats) -> Floats:
    """Twist of line contacts in series with a shaft [deg]: stiffer under load."""
    load = np.abs(torque)
    twist: Floats = PLAY_DEG + STRAIGHT_DEG_PER_NM * load + 3.0 * (1.0 - np.exp(-load / 2.0))
    return np.sign(torque) * twist


def twist_under(torque: Floats, limit_nm: float) -> Floats:
    """Twist where dry friction behind a spring holds a part of the torque [deg]."""
    grid = np.linspace(-1.3 * TOP_NM, 1.3 * TOP_NM, 40_001)
    angles, found = elastic(grid), np.empty(len(torque))
    anchor = 0.0
    for k, load in enumerate(torque):
        holds = limit_nm * np.clip((angles - anchor) / SLIP_DEG, -1.0, 1.0)
        found[k] = np.interp(load, grid + holds, angles)
        anchor = float(np.clip(anchor, found[k] - SLIP_DEG, found[k] + SLIP_DEG))
    return found


def recording(zero_nm: float, side_load_deg: float = 0.0, friction_nm: float = 0.0) -> cs.Recording:
    """Readings of that drive.

    Parameters
    ----------
    zero_nm : float
        What the sensor reads without load [N m].
    side_load_deg : float
        Twist by a side load under the largest torque, the same in both directions [deg].
    friction_nm : float
        Limit of the friction [N m].
    """
    torque = loops()
    angle = twist_under(torque, friction_nm)
    angle += side_load_deg * np.abs(torque / TOP_NM)
    angle += np.random.default_rng(11).normal(0.0, NOISE_DEG, len(torque))
    return cs.Recording.from_arrays(torque + zero_nm, angle, time_s=np.arange(float(len(torque))))


def names(found: cs.Diagnosis) -> set[str]:
    return {effect.name for effect in found.answer.effects}


@pytest.mark.parametrize("zero_nm", [-0.08, 0.04, 0.16])
def test_wrong_zero_is_no_second_effect(zero_nm: float) -> None:
    measured = recording(zero_nm)
    found = cs.diagnose(measured, cs.Drive.reference_87())
    assert names(found) == {"contact_stiffening"}
    assert found.answer.verdict == "IDENTIFIED"
    zero = found.answer.repaired.parameters["torque_zero_nm"]
    assert zero.estimate is not None
    assert zero.std_error is not None
    assert abs(zero.estimate - zero_nm) < 4 * zero.std_error + 0.002
    assert any("without load" in note for note in found.answer.notes)


def test_model_carries_the_zero() -> None:
    measured = recording(0.16)
    found = cs.diagnose(measured, cs.Drive.reference_87())
    assert found.model is not None
    simulated = present(cs.simulate(found.model, measured).angle_deg)
    error = simulated - present(measured.angle_deg)
    assert np.sqrt(np.mean(error**2)) < 1.1 * NOISE_DEG
    assert np.allclose(simulated, present(found.after_deg), atol=NOISE_DEG)


def test_side_load_beside_a_curve_is_no_wrong_zero() -> None:
    found = cs.diagnose(recording(0.0, side_load_deg=0.6), cs.Drive.reference_87())
    assert names(found) == {"contact_stiffening", "load_asymmetry"}
    assert "torque_zero_nm" not in found.answer.repaired.parameters


def test_right_zero_is_left_alone() -> None:
    found = cs.diagnose(recording(0.0), cs.Drive.reference_87())
    assert names(found) == {"contact_stiffening"}
    assert "torque_zero_nm" not in found.answer.repaired.parameters


def test_wrong_zero_beside_friction() -> None:
    found = cs.diagnose(recording(-0.08, friction_nm=0.5), cs.Drive.reference_87())
    assert names(found) == {"friction_hysteresis", "contact_stiffening"}
    zero = found.answer.repaired.parameters["torque_zero_nm"]
    assert zero.estimate == pytest.approx(-0.08, abs=0.02)


def test_ripple_of_a_current_is_thought_of_where_something_was_found() -> None:
    measured = recording(0.0)
    by_current = replace(measured, torque_from="motor-current")
    notes = [
        cs.diagnose(each, cs.Drive.reference_87(), full=False).answer.notes
        for each in (measured, by_current)
    ]
    assert [any("ripple" in note for note in each) for each in notes] == [False, True]
