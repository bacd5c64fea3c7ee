"""Noise of the torque reading is smoothed; torque that the twist follows is not."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.torque_noise import torque_without_noise
from cyclosweep.simulation.effects.history import Floats, Ints

COMPLIANCE = 2.7


def programme(rows: int = 60, runs: int = 8) -> tuple[Floats, Ints, Floats]:
    """Ramps up, a dwell with a corner on either side, and down; piece and clock of each row."""
    up = np.r_[np.linspace(0.5, 15.0, rows), np.full(rows // 3, 15.0)]
    down = np.linspace(15.0, 0.5, rows) ** 1.2 / 15.0**0.2
    torque = np.tile(np.r_[up, down], runs)
    piece = np.repeat(np.arange(2 * runs), np.tile([len(up), len(down)], runs))
    return torque, piece, np.arange(len(torque), dtype=np.float64)


def off_lines(read: Floats, twist: Floats, mismatch: float = 0.1) -> Floats:
    """What a line leaves of the twist, and a mismatch beside it."""
    return twist - COMPLIANCE * read + mismatch


def noisy(seed: int, torque: Floats, size: float) -> tuple[Floats, Floats]:
    rng = np.random.default_rng(seed)
    return torque + size * rng.normal(size=len(torque)), 0.1 * rng.normal(size=len(torque))


@pytest.mark.parametrize("size", [0.01, 0.03, 0.1])
def test_noise_that_the_twist_does_not_follow_is_smoothed(size: float) -> None:
    torque, piece, time = programme()
    read, scatter = noisy(1, torque, size)
    left = off_lines(read, COMPLIANCE * torque + scatter)
    found = torque_without_noise(read, piece, COMPLIANCE, left, time)
    assert found.noise_nm == pytest.approx(size, rel=0.1)
    assert np.std(found.torque_nm - torque) < 0.5 * size


def test_torque_that_the_twist_follows_is_left_as_it_was_read() -> None:
    torque, piece, time = programme()
    real, scatter = noisy(2, torque, 0.1)
    left = off_lines(real, COMPLIANCE * real + scatter)
    found = torque_without_noise(real, piece, COMPLIANCE, left, time)
    assert found.noise_nm == 0.0
    assert found.torque_nm is real


def test_a_clean_torque_is_left_as_it_was_read() -> None:
    torque, piece, time = programme()
    read = np.round(torque, 6)
    twist = COMPLIANCE * torque + noisy(3, torque, 0.0)[1]
    found = torque_without_noise(read, piece, COMPLIANCE, off_lines(read, twist), time)
    assert found.noise_nm == 0.0
    assert found.torque_nm is read


def test_noise_far_below_the_mismatch_is_left() -> None:
    torque, piece, time = programme()
    read, scatter = noisy(1, torque, 0.03)
    far, near = (off_lines(read, COMPLIANCE * torque + scatter, size) for size in (5.0, 3.0))
    assert torque_without_noise(read, piece, COMPLIANCE, far, time).torque_nm is read
    assert torque_without_noise(read, piece, COMPLIANCE, near, time).torque_nm is not read


def test_steps_of_a_staircase_of_weights_stay() -> None:
    rng = np.random.default_rng(4)
    torque = np.repeat(np.r_[1.0:11.0], 6)
    read = torque + 0.03 * rng.normal(size=len(torque))
    twist = COMPLIANCE * torque + 0.02 * rng.normal(size=len(torque))
    piece = np.zeros(len(torque), np.int64)
    found = torque_without_noise(read, piece, COMPLIANCE, off_lines(read, twist))
    assert np.abs(found.torque_nm - torque).max() < 0.15


def test_the_diagnosis_stays_silent_beside_noise_of_the_torque() -> None:
    """As read, the torque's noise was called a loop by rate in nearly every second recording."""
    rng = np.random.default_rng(5)
    torque = np.tile(np.r_[np.linspace(0.5, 15.0, 75), np.linspace(15.0, 0.5, 75)], 6)
    torque = np.r_[torque, -torque]
    run = np.repeat(np.arange(1, 13), 150)
    angle = 28.0 * np.sign(torque) + COMPLIANCE * torque + 0.19 * rng.normal(size=len(torque))
    recording = cs.Recording.from_arrays(
        torque_nm=torque + 0.027 * rng.normal(size=len(torque)),
        angle_deg=angle,
        run=run,
        time_s=0.4 * np.arange(len(torque)),
        side="input",
    )
    found = cs.diagnose(recording, cs.Drive.reference_87())
    assert found.verdict in ("NOTHING_MISSING", "INSUFFICIENT_DATA")
    assert found.answer.noise.torque_nm == pytest.approx(0.027, rel=0.15)
    (said,) = [each.text for each in found.answer.findings if each.topic == "torque noise"]
    assert "0.027 N m" in said or "0.026 N m" in said or "0.028 N m" in said
    assert "average of" not in said


def test_noise_of_averaged_rows_is_not_said_to_be_that_of_samples() -> None:
    """Hum of 2.1 N m in the samples was reported as a scatter of 0.15 N m."""
    rng = np.random.default_rng(7)
    leg = np.linspace(0.0, 600.0, 2500)
    torque = np.tile(np.r_[leg, leg[::-1], -leg, -leg[::-1]], 2)
    time = 0.005 * np.arange(len(torque))
    angle = 0.32 * np.sign(torque) + 0.00036 * torque + 0.001 * rng.normal(size=len(torque))
    read = torque + 3.0 * np.sin(2.0 * np.pi * 49.97 * time) + 0.3 * rng.normal(size=len(torque))
    recording = cs.Recording.from_arrays(
        read, angle, run=np.repeat([1, 2], len(torque) // 2), time_s=time, side="output"
    )
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False).answer
    assert found.thinning is not None
    (said,) = [each.text for each in found.findings if each.topic == "torque noise"]
    assert f"each the average of about {found.thinning.averaged} samples" in said
    assert "single samples may scatter by more" in said


def test_short_ramps_are_compared_with_the_torque_as_read() -> None:
    """A line through a dozen readings holds a third of their noise, as an error of the ramp."""
    torque, piece, time = programme(12, 24)
    read, scatter = noisy(6, torque, 0.03)
    found = torque_without_noise(
        read, piece, COMPLIANCE, off_lines(read, COMPLIANCE * torque + scatter, 0.0), time
    )
    assert np.allclose(found.twist_deg, COMPLIANCE * (read - found.torque_nm))
    assert np.any(found.twist_deg)
    slow = np.repeat(0.4 * scatter[::16], 16)[: len(torque)] * 10.0
    left = off_lines(read, COMPLIANCE * torque + scatter + slow, 0.0)
    found = torque_without_noise(read, piece, COMPLIANCE, left, time)
    assert found.noise_nm > 0.0
    assert not np.any(found.twist_deg)


def test_steps_of_two_readings_each_are_no_noise() -> None:
    """Lines through such a staircase differ from it as from noise; the twist follows the steps."""
    steps = np.r_[np.arange(70.0, 950.0, 290.0), np.arange(880.0, -950.0, -290.0)]
    torque = np.tile(np.repeat(steps, 2), 4)
    left = 0.02 + 0.002 * np.random.default_rng(6).normal(size=len(torque))
    piece = np.zeros(len(torque), np.int64)
    assert torque_without_noise(torque, piece, 0.00036, left).torque_nm is torque
