"""Angles known modulo a period, and long recordings averaged with a stated bound."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import Floats, present


def loop(turns: int = 3) -> tuple[Floats, Floats]:
    """Torque and twist of a play of +-28 deg, unread, with a compliance of 2.73 deg/(N m)."""
    up = np.linspace(0.5, 10, 20)
    torque = np.concatenate([np.r_[up, up[::-1], -up, -up[::-1]] for _ in range(turns)])
    return torque, 28.0 * np.sign(torque) + 2.73 * torque


def written(folder: Path, torque: Floats, angle: Floats, period: float, extra: str = "") -> Path:
    path = folder / "loop.csv"
    path.write_text(
        "torque_nm,angle_deg\n"
        + "".join(f"{t:.5f},{a % period:.5f}\n" for t, a in zip(torque, angle, strict=True))
    )
    path.with_name("loop.toml").write_text(
        f'{extra}\n[columns]\nangle_deg = {{ column = "angle_deg", modulo = {period} }}\n'
    )
    return path


@pytest.mark.parametrize("period", [62.0, 65.0, 90.0, 360.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_modulo_close_to_the_play(tmp_path: Path, period: float, sense: float) -> None:
    torque, angle = loop()
    recording = cs.Recording.read(written(tmp_path, torque, sense * angle, period))
    got = present(recording.angle_deg)
    np.testing.assert_allclose(got - got[0], angle - angle[0], atol=1e-3)
    kinds = [fault.kind for fault in recording.faults]
    assert ("modulo_too_small" in kinds) == (period < 360)
    assert recording.angle_modulo_deg == period


def test_what_no_file_can_tell_is_a_remark_where_the_drive_is_known(tmp_path: Path) -> None:
    torque, angle = loop()
    # The step through the play is a whole period: the file looks as if there were no play.
    path = written(tmp_path, torque, angle, 58.0, 'drive = "reference-87"')
    (remark,) = (f for f in cs.Recording.read(path).faults if f.kind == "modulo_too_small")
    assert remark.verdict is None
    assert "58 deg" in remark.reason
    assert "56 deg" in remark.reason


def test_a_diagnosis_remarks_on_the_modulo_with_the_drive_it_is_given(
    tmp_path: Path, reference: cs.Drive
) -> None:
    torque, angle = loop()
    angle = angle + 0.05 * np.random.default_rng(1).normal(size=len(angle))
    recording = cs.Recording.read(written(tmp_path, torque, angle, 58.0))
    assert recording.faults == ()
    found = cs.diagnose(recording, reference, full=False)
    assert "known modulo 58 deg" in found.statement


def test_a_fine_modulo_is_no_remark(tmp_path: Path) -> None:
    torque = np.sin(np.linspace(0, 20, 2000)) * 10
    angle = np.sign(torque) * np.minimum(np.abs(torque) * 20, 28) + 2.73 * torque
    path = written(tmp_path, torque, angle, 60.0, 'drive = "reference-87"')
    recording = cs.Recording.read(path)
    got = present(recording.angle_deg)
    np.testing.assert_allclose(got - got[0], angle - angle[0], atol=1e-3)


def test_averaging_neighbours_keeps_extremes_and_states_its_bound(tmp_path: Path) -> None:
    n = 4000
    torque = 10 * np.sin(np.linspace(0, 4 * np.pi, n))
    angle = 3 * torque + 0.02 * torque**3
    path = tmp_path / "loop.csv"
    path.write_text(
        "torque_nm,angle_deg,run\n"
        + "".join(f"{t:.6f},{a:.6f},{1 + k // 2000}\n"
                  for k, (t, a) in enumerate(zip(torque, angle, strict=True)))
    )  # fmt: skip
    path.with_name("loop.toml").write_text("[merge]\nneighbours = 16\n")
    recording = cs.Recording.read(path)
    assert n / 16 <= len(recording) < n / 15
    assert recording.torque_nm.max() == pytest.approx(torque.max(), abs=1e-6)
    assert recording.torque_nm.min() == pytest.approx(torque.min(), abs=1e-6)
    (note,) = (note for note in recording.notes if note.startswith("Bound"))
    bound = float(note.split("farther than ")[1].split(" deg")[0])
    at = 3 * recording.torque_nm + 0.02 * recording.torque_nm**3
    assert np.abs(present(recording.angle_deg) - at).max() <= bound
    assert 0 < bound < 0.1
