"""What is said of a zero that steps or drifts within one run, and shares of places in a misfit."""

import numpy as np
import pytest

import cyclosweep as cs

DRIVE = cs.Drive.load("reference-87")
TORQUE = np.concatenate([
    np.linspace(0, 5, 50), np.linspace(5, -5, 100), np.linspace(-5, 5, 100),
    np.linspace(5, -5, 100), np.linspace(-5, 5, 100), np.linspace(5, 0, 50),
])  # fmt: skip
TIME = 0.2 * np.arange(len(TORQUE))
TWIST = DRIVE.free_play_deg * np.where(TORQUE >= 0, 1.0, -1.0) + 2.6 * TORQUE
NOISE = 0.05 * np.random.default_rng(7).normal(size=len(TORQUE))


def diagnosed(beside_deg: np.ndarray) -> cs.Diagnosis:
    recording = cs.Recording.from_arrays(
        TORQUE, TWIST + NOISE + beside_deg, time_s=TIME, side="input", drive="reference-87"
    )
    return cs.diagnose(recording, DRIVE, full=False)


@pytest.mark.parametrize("size_deg", [1.0, -0.6])
def test_one_step_of_the_zero_is_called_so_with_its_time(size_deg: float) -> None:
    answer = diagnosed(np.where(TIME >= 42.0, size_deg, 0.0)).answer
    rest = answer.unknown
    assert answer.verdict == "UNKNOWN_PHYSICS"
    assert rest is not None
    assert rest.shape == "step of the angle"
    assert "t = 42 s" in rest.place
    assert rest.size_deg == pytest.approx(abs(size_deg), rel=0.05)


def test_a_steady_drift_is_no_step_and_its_size_is_that_of_the_drift() -> None:
    answer = diagnosed(2.0 * TIME / TIME[-1]).answer
    rest = answer.unknown
    assert rest is not None
    assert rest.shape == "slow drift"
    assert rest.size_deg == pytest.approx(2.0, rel=0.03)


def test_places_of_equal_misfit_have_equal_shares() -> None:
    reach = np.abs(TWIST).max()
    bent = -np.sign(TWIST) * np.maximum(np.abs(TWIST) - (reach - 2.5), 0.0)
    first, second = diagnosed(bent).answer.mismatch.regions[:2]
    assert first.torque_nm is not None
    assert first.torque_nm == tuple(-limit for limit in reversed(second.torque_nm or ()))
    assert first.direction == second.direction
    shares = first.share_of_excess or 0.0, second.share_of_excess or 0.0
    assert 0.5 < shares[0] / shares[1] < 2.0


def test_the_size_of_a_drift_is_how_far_the_zero_moved() -> None:
    """Beside a calibrated datum and play a quarter of it is left, which was given as its size."""
    leg, moved_deg = np.linspace(0.0, 600.0, 60), 0.0192
    torque = np.r_[leg, leg[-2::-1], -leg[1:], -leg[-2::-1]]
    angle = 0.32 * np.where(torque < 0, -1.0, 1.0) + 0.00036 * torque
    angle += np.linspace(0.0, moved_deg, len(torque))
    angle += 0.001 * np.random.default_rng(5).normal(size=len(torque))
    recording = cs.Recording.from_arrays(
        torque, angle, time_s=2.0 * np.arange(len(torque)), side="output"
    )
    rest = cs.diagnose(recording, DRIVE, full=False).answer.unknown
    assert rest is not None
    assert rest.shape == "slow drift"
    assert rest.size_deg == pytest.approx(moved_deg, rel=0.1)
