"""Play that is passed softly: no negative play in its place, and a model that predicts the fit."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present

NOISE_DEG = 0.05


def soft_play(folder: Path, play_deg: float, softness_nm: float) -> cs.Recording:
    """Recording of a line with a play that a torque of this size passes smoothly."""
    up, down = np.linspace(0.0, 12.0, 51), np.linspace(12.0, -12.0, 101)[1:]
    torque = np.concatenate([up, down, -down, down, -down[:51]])
    noise = np.random.default_rng(0).normal(0.0, NOISE_DEG, len(torque))
    angle = play_deg * np.tanh(torque / softness_nm) + 2.7 * torque + noise
    rows = [
        f"{0.2 * k:.1f},{t:.4f},{a:.4f}" for k, (t, a) in enumerate(zip(torque, angle, strict=True))
    ]
    file = folder / "soft.csv"
    file.write_text("\n".join(["time_s,torque_nm,angle_deg", *rows]) + "\n")
    (folder / "soft.toml").write_text('drive = "reference-87"\nside = "input"\n')
    return cs.Recording.read(file)


@pytest.mark.parametrize(("play_deg", "softness_nm"), [(28.0, 0.6), (45.0, 1.2), (20.0, 2.4)])
def test_the_model_of_a_soft_play_predicts_what_was_fitted(
    tmp_path: Path, play_deg: float, softness_nm: float
) -> None:
    recording = soft_play(tmp_path, play_deg, softness_nm)
    found = cs.diagnose(recording, full=False)
    assert found.model is not None
    assert found.model.free_play_deg >= 0.0
    torque, angle = recording.torque_nm, present(recording.angle_deg)
    predicted = present(cs.simulate(found.model, recording).angle_deg)
    loaded = np.abs(torque) > 0.3 * np.abs(torque).max()
    missed = np.sqrt(np.mean((angle - predicted)[loaded] ** 2))
    assert missed < 1.3 * NOISE_DEG
