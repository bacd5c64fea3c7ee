"""What is said of runs that were kept for the verdict and are missed by more than noise."""

import numpy as np
import pytest

import cyclosweep as cs

DRIVE = cs.Drive.reference_87()


def recording(
    *, zero_deg: float = 0.0, softer: float = 0.0, wider_deg: float = 0.0
) -> cs.Recording:
    """Three runs of one loop without effects, the kept last one with another calibration."""
    up = np.linspace(0.5, 12.0, 40)
    loop = np.r_[up, up[::-1], -up, -up[::-1]]
    torque, run = np.tile(loop, 3), np.repeat([1, 2, 3], loop.size)
    last = run == 3
    twist = 2.7 * torque * (1.0 + softer * last)
    angle = 28.0 * np.sign(torque) + twist + last * (zero_deg + wider_deg * np.sign(torque))
    angle += np.random.default_rng(1).normal(0.0, 0.05, angle.size)
    return cs.Recording.from_arrays(
        torque, angle, run=run, time_s=np.arange(angle.size) * 1.0, holdout_runs=(3,)
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"zero_deg": 0.6}, "their zero is another one, by 0.6"),
        ({"softer": 0.05}, "their compliance is another one, by +5 %"),
        ({"wider_deg": 0.4}, "their free play is wider by 0.4 deg each side"),
        ({"wider_deg": -0.4}, "their free play is narrower by 0.4 deg each side"),
    ],
)
def test_how_a_kept_run_differs_is_said(change: dict[str, float], words: str) -> None:
    found = cs.diagnose(recording(**change), DRIVE)
    assert "The runs that were kept are missed by" in found.statement
    assert words in found.statement


def test_of_one_flank_no_play_is_told() -> None:
    whole = recording(zero_deg=0.6)
    found = cs.diagnose(whole.take(whole.torque_nm > 0.0), DRIVE)
    assert "their zero is another one, by 0.6" in found.statement


def test_a_kept_run_like_the_others_is_not_mentioned() -> None:
    assert "that were kept" not in cs.diagnose(recording(), DRIVE).statement


def test_an_error_that_does_not_fall_is_not_said_to_fall() -> None:
    up = np.linspace(0.5, 12.0, 40)
    loop = np.r_[up, up[::-1], -up, -up[::-1]]
    torque, run = np.tile(loop, 6), np.repeat(np.arange(6), loop.size)
    zero = np.array([0.0, 0.5, -0.4, 0.3, 0.1, 0.9])[run]
    angle = 28.0 * np.sign(torque) + 2.7 * torque + zero
    angle += np.random.default_rng(1).normal(0.0, 0.05, angle.size)
    made = cs.Recording.from_arrays(
        torque, angle, run=run, time_s=np.arange(angle.size) * 1.0, holdout_runs=(5,)
    )
    found = cs.diagnose(made, DRIVE)
    assert [effect["name"] for effect in found.effects] == ["datum_drift"]
    assert "falls from" in found.statement
    assert "; on data not used it is" in found.statement
    assert "their zero is another one" in found.statement
    assert "falls" not in found.content["summary"][0]
