"""What can be read but not diagnosed: the fault, its verdict and its reason."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.inspection import inspect
from cyclosweep.recording.proposed import Known
from tests.support.dry_friction import twist_with_friction

TORQUE = np.r_[np.linspace(0.5, 20, 40), np.linspace(20, 0.5, 40), np.linspace(-0.5, -20, 40)]
ANGLE = 28 * np.sign(TORQUE) + 2.73 * TORQUE
TIME = np.arange(len(TORQUE), dtype=float)


KNOWN = Known(cs.Drive.load("reference-87"), "reference-87", "input")


def kinds(recording: cs.Recording) -> dict[str, str | None]:
    return {fault.kind: fault.verdict for fault in recording.faults}


def test_a_sound_recording_has_no_faults() -> None:
    assert cs.Recording.from_arrays(TORQUE, ANGLE, time_s=TIME).faults == ()


def test_a_dozen_hand_read_points_without_a_clock_are_enough() -> None:
    torque = np.array([1, 2, 3, 4, 5, 6, 5, 4, 3, 2, 1, 0.5])
    angle = np.round(2 * (28 + 2.73 * torque)) / 2
    assert cs.Recording.from_arrays(torque, angle).blocking_fault is None


def test_two_samples_are_insufficient() -> None:
    fault = cs.Recording.from_arrays([1.0, 2.0], [30.0, 33.0]).blocking_fault
    assert fault is not None
    assert fault.verdict == "INSUFFICIENT_DATA"
    assert "2 samples" in fault.reason


def test_no_samples_are_insufficient(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg\n")
    assert kinds(cs.Recording.read(path))["too_few_samples"] == "INSUFFICIENT_DATA"


def test_constant_torque_is_insufficient() -> None:
    recording = cs.Recording.from_arrays(np.full(50, 3.0), ANGLE[:50])
    assert kinds(recording) == {"constant_torque": "INSUFFICIENT_DATA"}


def test_constant_angle_is_a_data_fault() -> None:
    recording = cs.Recording.from_arrays(TORQUE, np.full(len(TORQUE), 3.0))
    assert kinds(recording) == {"constant_angle": "DATA_FAULT"}


def test_time_that_runs_backwards_is_a_data_fault() -> None:
    time = TIME.copy()
    time[50] = 3.0
    fault = cs.Recording.from_arrays(TORQUE, ANGLE, time_s=time).blocking_fault
    assert fault is not None
    assert fault.verdict == "DATA_FAULT"
    assert "sample 51" in fault.reason


def test_time_may_restart_with_a_run() -> None:
    run = np.repeat([1, 2], 60)
    time = np.r_[TIME[:60], TIME[:60]]
    assert cs.Recording.from_arrays(TORQUE, ANGLE, time_s=time, run=run).faults == ()


def test_runs_in_two_places_are_a_data_fault() -> None:
    run = np.repeat([1, 2, 1], 40)
    assert kinds(cs.Recording.from_arrays(TORQUE, ANGLE, run=run)) == {"run_split": "DATA_FAULT"}


def test_gaps_ticks_and_absent_runs_are_said_without_a_verdict() -> None:
    time = TIME.copy()
    time[80:] += 500
    time[10] = time[9]
    recording = cs.Recording.from_arrays(TORQUE, ANGLE, time_s=time, holdout_runs=(5,))
    assert kinds(recording) == {"gaps": None, "clock_ticks": None, "run_absent": None}
    assert recording.blocking_fault is None


def test_a_clipped_angle_is_said() -> None:
    recording = cs.Recording.from_arrays(TORQUE, np.minimum(ANGLE, 70))
    assert kinds(recording) == {"saturation": None}
    clipped = cs.Recording.from_arrays(TORQUE, np.minimum(ANGLE, 30.5))
    assert kinds(clipped)["saturation"] == "DATA_FAULT"


def test_unrelated_columns_are_a_data_fault() -> None:
    angle = np.random.default_rng(3).normal(size=5000)
    torque = np.random.default_rng(4).normal(size=5000)
    assert kinds(cs.Recording.from_arrays(torque, angle)) == {"unrelated": "DATA_FAULT"}


def test_absurd_numbers_are_a_data_fault() -> None:
    recording = cs.Recording.from_arrays(TORQUE * 1e300, ANGLE)
    assert kinds(recording) == {"absurd_value": "DATA_FAULT"}
    assert recording.faults[0].reason.startswith("The torque reaches")


def test_contradictions_come_before_shortage() -> None:
    recording = cs.Recording.from_arrays([1.0, 2.0], [30.0, 33.0], time_s=[1.0, 0.0])
    assert [fault.verdict for fault in recording.faults] == ["DATA_FAULT", "INSUFFICIENT_DATA"]


@pytest.mark.parametrize("rows", [200_000])
def test_one_value_over_and_over_is_quick(tmp_path: Path, rows: int) -> None:
    path = tmp_path / "stuck.csv"
    path.write_text("torque_nm,angle_deg,time_s\n" + "1.5,2.5,3.0\n" * rows)
    fault = cs.Recording.read(path).blocking_fault
    assert fault is not None
    assert fault.verdict == "INSUFFICIENT_DATA"


def test_arrays_with_gaps_lose_the_samples_without_a_number() -> None:
    torque = np.linspace(-20.0, 20.0, 300)
    angle = 28.0 * np.sign(torque) + 2.7 * torque
    angle[::3] = np.nan
    recording = cs.Recording.from_arrays(torque, angle)
    assert len(recording) == 200
    assert "100 of 300 samples" in recording.notes[0]


def clipped_on_both_flanks(limit_deg: float, step_deg: float = 0.0) -> cs.Recording:
    angle = ANGLE + 0.02 * np.random.default_rng(5).normal(size=len(ANGLE))
    if step_deg:
        angle = step_deg * np.round(angle / step_deg)
    return cs.Recording.from_arrays(TORQUE, np.clip(angle, -limit_deg, limit_deg))


def test_an_angle_clipped_near_the_ends_of_both_flanks_is_said() -> None:
    # The load goes on by 8 % of the range of both flanks together.
    assert kinds(clipped_on_both_flanks(74.0)) == {"saturation": None}


def with_limited_torque(limit_nm: float, friction_nm: float = 0.0, seed: int = 5) -> cs.Recording:
    """Three loops to 30 N m, read by a torque sensor that ends earlier."""
    rng = np.random.default_rng(seed)
    once = np.r_[np.linspace(0.3, 30, 99), np.linspace(30, -30, 200), np.linspace(-30, -0.3, 99)]
    torque = np.tile(once, 3)
    angle = twist_with_friction(torque, friction_nm, 2.73) + 0.2 * rng.normal(size=len(torque))
    run = np.repeat([1, 2, 3], len(once))
    clipped = np.clip(torque, -limit_nm, limit_nm)
    return cs.Recording.from_arrays(clipped, angle, run=run, drive="reference-87")


@pytest.mark.parametrize("limit_nm", [15.0, 25.0, 28.0])
def test_a_clipped_torque_is_said_and_its_samples_do_not_count(limit_nm: float) -> None:
    recording = with_limited_torque(limit_nm)
    assert kinds(recording) == {"saturation": None}
    assert recording.unscored is not None
    np.testing.assert_array_equal(recording.unscored, np.abs(recording.torque_nm) == limit_nm)
    answer = cs.diagnose(recording, cs.Drive.load("reference-87"))
    assert answer.verdict == "NOTHING_MISSING"
    assert "the sensor is saturated" in answer.statement


def test_friction_remembers_a_load_that_was_not_read() -> None:
    clipped = with_limited_torque(25.0, friction_nm=1.0)
    assert kinds(clipped) == {"saturation": None}
    assert clipped.unscored is not None
    # On the way down as far as the lower branch, twice the friction below the end.
    lost = clipped.unscored & (clipped.torque_nm < 25.0) & (clipped.torque_nm > 0.0)
    assert clipped.torque_nm[lost].min() == pytest.approx(23.0, abs=0.5)
    answer = cs.diagnose(clipped, cs.Drive.load("reference-87"), full=False)
    assert [effect["name"] for effect in answer.effects] == ["friction_hysteresis"]
    assert answer.verdict == "IDENTIFIED"


def test_samples_that_are_left_out_already_are_not_counted_as_saturated() -> None:
    whole = with_limited_torque(8.0)
    assert kinds(whole) == {"saturation": "DATA_FAULT"}
    known = cs.Recording.from_arrays(
        whole.torque_nm, whole.angle_deg, run=whole.run, unscored=np.abs(whole.torque_nm) == 8.0
    )
    assert kinds(known) == {}


def test_too_little_left_without_saturated_samples_is_a_data_fault() -> None:
    torque = [0, 0, 0, 0, 0, 1, 1, 1, 1, 1.0]
    few = cs.Recording.from_arrays(torque, [0, 1, 2, 3, 4, 5, 6, 7, 6, 5.0])
    assert cs.diagnose(few, cs.Drive.load("reference-87"), full=False).verdict in (
        "DATA_FAULT",
        "INSUFFICIENT_DATA",
    )


@pytest.mark.parametrize("case", ["breakaway", "coarse torque", "two loads", "coarse dial"])
def test_what_stands_for_another_reason_is_not_saturated(case: str) -> None:
    rng, run = np.random.default_rng(8), np.repeat(range(6), 50)
    rise = np.tile(np.linspace(0, 30, 50), 6)
    if case == "breakaway":
        angle = 28 + 2.7 * np.clip(rise - 5, 0, None) + 0.1 * rng.normal(size=300)
        torque, angle = rise, np.round(2 * angle) / 2
    elif case == "coarse torque":
        torque = 30 * np.abs(2 / np.pi * np.arcsin(np.sin(2 * np.pi * np.arange(300) / 150)))
        angle = 28 + 2.7 * torque + 0.1 * rng.normal(size=300)
        torque = 2 * np.round(torque / 2)
    elif case == "two loads":
        torque = np.tile(np.r_[np.full(25, 30.0), np.full(25, -30.0)], 6)
        creep = np.tile(np.tile(1 - np.exp(-np.arange(25) / 8), 2), 6)
        angle = torque * (3.6 + 0.4 * creep) + 0.1 * rng.normal(size=300)
    else:
        torque = np.tile(np.r_[np.linspace(0, 30, 25), np.linspace(30, 0, 25)], 6)
        angle = 28 + 2.7 * (torque - 3.0 * np.sign(np.gradient(torque)))
        angle = 5 * np.round(angle / 5)
    found = kinds(cs.Recording.from_arrays(torque, angle, run=run))
    assert "saturation" not in found
    assert found.get("saturation_suspected") is None


def test_a_hold_with_creep_and_runs_that_begin_at_one_torque_are_no_saturation() -> None:
    rng = np.random.default_rng(6)
    rise = np.linspace(0.5, 30, 60)
    torque = np.tile(np.r_[rise, np.full(60, 30.0), rise[::-1]], 3)
    hold = np.r_[np.zeros(60), 1.0 - np.exp(-np.arange(60) / 15), np.linspace(1, 0, 60)]
    angle = 28.0 + 2.73 * torque + 8.0 * np.tile(hold, 3) + 0.1 * rng.normal(size=len(torque))
    angle[torque == 0.5] -= 28.0  # within the play
    run = np.repeat([1, 2, 3], 180)
    assert kinds(cs.Recording.from_arrays(torque, angle, run=run)) == {}


@pytest.mark.parametrize("step_deg", [0.0, 1.0, 4.0])
def test_a_coarse_dial_and_friction_at_the_turn_are_no_saturation(step_deg: float) -> None:
    assert kinds(clipped_on_both_flanks(200.0, step_deg)) == {}
    turning = np.r_[np.full(6, 20.0), np.linspace(20.0, 17.0, 8)]
    torque = np.r_[np.linspace(0.5, 20, 40), turning, np.linspace(16.5, 0.5, 40)]
    angle = 28.0 + 2.73 * np.r_[torque[:40], np.full(14, 20.0), torque[54:]]
    assert kinds(cs.Recording.from_arrays(np.r_[torque, -torque], np.r_[angle, -angle])) == {}


def test_a_clock_that_stands_still_is_left_out(tmp_path: Path) -> None:
    recording = cs.Recording.from_arrays(TORQUE, ANGLE, time_s=np.full(len(TORQUE), 5.0))
    assert recording.time_s is None
    assert len(recording) == len(TORQUE)
    path = tmp_path / "loop.csv"
    rows = "".join(f"5.0,{t},{a}\n" for t, a in zip(TORQUE, ANGLE, strict=True))
    path.write_text("time_s,torque_nm,angle_deg\n" + rows)
    assert "same_time" not in repr(inspect(path, KNOWN, {}))
    assert len(cs.Recording.read(path)) == len(TORQUE)


def test_a_torque_that_no_sensor_reads_is_a_data_fault() -> None:
    recording = cs.Recording.from_arrays(TORQUE * 1e-300, ANGLE)
    assert kinds(recording) == {"absurd_value": "DATA_FAULT"}


def test_a_column_that_stands_twice_is_said_when_a_file_is_inspected(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg,torque_nm\n" + "1.0,2.0,1.0\n" * 20)
    found = inspect(path, KNOWN, {})
    assert found.text_columns == []
    assert any("torque_nm: more than one column" in text for text in found.proposal.assumed)
