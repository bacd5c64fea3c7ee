"""Results in a folder: the second diagnosis replaces the first; any terminal can show them."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs

TORQUE = np.array([0.5, 2, 4, 6, 8, 10, 14, 18, 14, 10, 6, 2])


def diagnosed(factor: float = 1.0) -> cs.Diagnosis:
    """Diagnose a dozen readings."""
    recording = cs.Recording.from_arrays(TORQUE, factor * np.round(2 * (28 + 2.73 * TORQUE)) / 2)
    return cs.diagnose(recording, cs.Drive.reference_87(), full=False)


def test_a_second_diagnosis_leaves_nothing_of_the_first(tmp_path: Path) -> None:
    diagnosed().write(tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {
        "diagnosis.json",
        "model.json",
        "report.html",
    }
    diagnosed().write(tmp_path, report=False)
    assert not (tmp_path / "report.html").exists()
    diagnosed(1000.0).write(tmp_path)
    assert not (tmp_path / "model.json").exists()


def test_an_emptied_folder_of_pictures_goes_and_other_files_stay(tmp_path: Path) -> None:
    pictures = tmp_path / "pictures"
    pictures.mkdir()
    found = diagnosed()
    found.write(tmp_path, report=False)
    assert pictures.is_dir()  # nothing of ours was in it
    (pictures / "loop.png").write_bytes(b"")
    (pictures / "notes.txt").write_text("mine")
    found.write(tmp_path, report=False)
    assert [path.name for path in pictures.iterdir()] == ["notes.txt"]
    (pictures / "notes.txt").rename(pictures / "map.png")
    found.write(tmp_path, report=False)
    assert not pictures.exists()


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "cp437", "latin-1", "utf-8"])
def test_a_terminal_of_any_encoding_shows_the_summary(tmp_path: Path, encoding: str) -> None:
    file = tmp_path / "loop.csv"
    rows = [f"{t},{28 + 2.7 * t:.1f}" for t in TORQUE]
    file.write_text("torque_nm,angle_deg\n" + "\n".join(rows) + "\n")
    command = [sys.executable, "-m", "cyclosweep", "diagnose", str(file), "--quick"]
    command += ["--drive", "reference-87", "--out", str(tmp_path / "out")]
    done = subprocess.run(
        command,
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"},
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert b"Traceback" not in done.stderr
    assert "deg" in done.stdout.decode(encoding)
