"""Torque and angle that stand in each other's column are suspected, with the way to say so."""

from pathlib import Path

import numpy as np

import cyclosweep as cs
from tests.unit.test_inspect import inspected, run

DRIVE = ("--drive", "reference-87")


def exchanged(path: Path, header: str) -> Path:
    """Loops with a play, the torque written first, under headings that say the reverse.

    Parameters
    ----------
    path : Path
    header : str

    Returns
    -------
    Path
    """
    up = np.linspace(0.2, 6.0, 30)
    torque = np.tile(np.r_[up, up[::-1], -up, -up[::-1]], 3)
    noise = 0.1 * np.random.default_rng(2).standard_normal(len(torque))
    angle = 28.0 * np.sign(torque) + 2.7 * torque + noise
    rows = [f"{t:.4f},{a:.3f}" for t, a in zip(torque, angle, strict=True)]
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def test_a_diagnosis_names_the_exchange_where_the_play_hides_the_compliance(
    tmp_path: Path,
) -> None:
    recording = cs.Recording.read(exchanged(tmp_path / "loop.csv", "angle_deg,torque_nm"))
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.verdict == "DATA_FAULT"
    assert "torque and angle were read from each other's column" in found.statement
    assert found.answer.do_now.startswith("Correct the columns of torque and angle")


def test_inspect_names_the_options_that_exchange_them_back(tmp_path: Path) -> None:
    path = exchanged(tmp_path / "loop.csv", "angle_deg,torque_nm")
    found = inspected(path, *DRIVE)
    [check] = [text for text in found["checks"] if "each other's column" in text]
    assert check.endswith("say --torque angle_deg --angle torque_nm.")
    back = inspected(path, *DRIVE, "--torque", "angle_deg", "--angle", "torque_nm")
    assert back["metadata"]["side"] == "input"
    assert back["checks"] == []


def test_names_without_units_are_suspected_too(tmp_path: Path) -> None:
    found = inspected(exchanged(tmp_path / "loop.csv", "Winkel,Drehmoment"), *DRIVE)
    assert any("--torque Winkel --angle Drehmoment" in text for text in found["checks"])


def test_a_side_that_alone_bears_the_torque_is_not_called_the_nearer(tmp_path: Path) -> None:
    path = exchanged(tmp_path / "loop.csv", "angle_deg,torque_nm")
    said = run("inspect", str(path), *DRIVE).stdout
    assert "the only one that bears the" in said
    assert "nearer" not in said
    assert "nearest" not in said
