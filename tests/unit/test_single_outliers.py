"""Single readings that no neighbour bears out are left out and named; physics is not."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.single_outliers import without_single_outliers

DRIVE = cs.Drive.reference_87()
LINE = DRIVE.nominal_line("input")
FRICTION_NM = 0.3
NOISE_DEG = 0.2


def loops(friction_nm: float = FRICTION_NM) -> cs.Recording:
    """Three loops, the twist by friction that holds the shaft until the torque exceeds it."""
    up = np.linspace(0.0, 12.0, 60)
    torque = np.tile(np.r_[up, np.linspace(12.0, -12.0, 120)[1:], -up[::-1][1:]], 3)
    elastic, state = np.empty_like(torque), 0.0
    for k, applied in enumerate(torque):
        state = min(max(state, applied - friction_nm), applied + friction_nm)
        elastic[k] = state
    angle = 28.0 * np.sign(elastic) + 2.7 * elastic
    angle += np.random.default_rng(3).normal(0.0, NOISE_DEG, angle.size)
    shown = np.abs(torque) > 0.4
    return cs.Recording.from_arrays(
        torque[shown], angle[shown], time_s=np.flatnonzero(shown) * 1.0, history="continuous"
    )


def spoilt(recording: cs.Recording, row: int, change_deg: float, rows: int = 1) -> cs.Recording:
    """The recording with some readings of the angle moved."""
    angle = np.array(recording.angle_deg)
    angle[row : row + rows] += change_deg
    return recording.with_angle(angle)


def left_out(recording: cs.Recording) -> int:
    return len(recording) - len(without_single_outliers(recording, LINE))


@pytest.mark.parametrize("change_deg", [5.0, -20.0, 500.0])
def test_one_wrong_reading_changes_no_diagnosis(change_deg: float) -> None:
    recording = loops()
    found = cs.diagnose(spoilt(recording, 400, change_deg), DRIVE, full=False)
    assert found.verdict == "IDENTIFIED"
    assert [effect["name"] for effect in found.effects] == ["friction_hysteresis"]
    (remark,) = [note for note in found.content["notes"] if "single outliers" in note]
    assert "sample 401" in remark
    assert "angle" in remark


def test_a_wrong_torque_is_named_as_one() -> None:
    recording = loops()
    torque = np.array(recording.torque_nm)
    torque[100] = -torque[100]
    other = cs.Recording.from_arrays(torque, recording.angle_deg, time_s=recording.time_s)
    cleaned = without_single_outliers(other, LINE)
    assert len(cleaned) == len(other) - 1
    assert "sample 101" in cleaned.faults[-1].reason
    assert "torque" in cleaned.faults[-1].reason


@pytest.mark.parametrize("apart", [2, 3, 4])
def test_two_wrong_readings_close_by_do_not_hide_each_other(apart: int) -> None:
    """Three samples apart, the larger one was left out, and the smaller one fitted."""
    recording = spoilt(spoilt(loops(), 400, 6.0), 400 + apart, -40.0)
    cleaned = without_single_outliers(recording, LINE)
    assert len(cleaned) == len(recording) - 2
    assert "sample 401" in cleaned.faults[-1].reason
    assert f"sample {401 + apart}" in cleaned.faults[-1].reason


def test_a_jump_that_stays_and_a_knock_of_two_readings_are_kept() -> None:
    recording = loops()
    assert left_out(spoilt(recording, 400, 5.0, rows=60)) == 0
    assert left_out(spoilt(recording, 400, 5.0, rows=2)) == 0


def test_many_outliers_are_noise_of_heavy_tails() -> None:
    recording = loops()
    for row in range(20, len(recording) - 20, 60):
        recording = spoilt(recording, row, 5.0)
    assert left_out(recording) == 0


def test_loads_to_and_fro_without_readings_between_are_kept() -> None:
    torque = np.tile([10.0, -10.0, 5.0, -5.0, 10.0, 8.0, 10.0, -10.0], 5)
    angle = 28.0 * np.sign(torque) + 2.7 * torque
    assert left_out(cs.Recording.from_arrays(torque, angle)) == 0


def test_a_reading_on_the_other_flank_near_zero_is_kept() -> None:
    down = np.linspace(12.0, 0.1, 60)
    torque = np.tile(np.r_[down[::-1], down, -0.05], 3)
    angle = 28.0 * np.sign(torque) + 2.7 * torque
    assert left_out(cs.Recording.from_arrays(torque, angle)) == 0


@pytest.mark.parametrize(("change_deg", "count"), [(15.0, 1), (-15.0, 0)])
def test_a_reading_beyond_the_flank_is_left_out_beside_a_crossing(
    change_deg: float, count: int
) -> None:
    recording = loops()
    angle = recording.angle_deg
    assert angle is not None
    crossing = int(np.flatnonzero(np.diff(angle) < -30.0)[0])
    assert left_out(spoilt(recording, crossing - 1, change_deg)) == count


def test_changes_of_another_run_are_not_nearby() -> None:
    recording = loops()
    angle, run = np.array(recording.angle_deg), np.ones(len(recording), dtype=int)
    run[300:] = 2
    for row in (1, 301):
        spoiled = angle.copy()
        spoiled[row] += 20.0
        made = cs.Recording.from_arrays(recording.torque_nm, spoiled, run=run)
        assert left_out(made) == 0


def test_turning_points_of_a_quiet_recording_are_kept() -> None:
    torque = np.tile(np.r_[np.linspace(1.0, 12.0, 20), np.linspace(12.0, 1.0, 20)], 4)
    angle = 28.0 + 2.7 * torque + 0.5 * torque**2
    assert left_out(cs.Recording.from_arrays(torque, angle)) == 0
    assert left_out(cs.Recording.from_arrays(torque[::5], angle[::5])) == 0
