"""Rows of units above or below the names, and text that stands there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present
from tests.unit.test_inspect import inspected, loop, run, write


@pytest.mark.parametrize("above", [False, True])
def test_a_row_of_units_counts_where_one_of_them_is_not_known(tmp_path: Path, above: bool) -> None:
    rows = ["Zeit;Drehmoment;Winkel", "ms;kNm;Striche"]
    known = [rows[0], "ms;kNm;arcmin"]
    time, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "\n".join(rows), time, torque, angle, sep=";")
    result = run("inspect", str(path), "--out", str(tmp_path / "loop.toml"))
    assert result.returncode == 2
    assert "Winkel: unit 'Striche' is not known" in result.stderr
    lines = "\n".join(reversed(known) if above else known)
    path = write(tmp_path / "other.csv", lines, 1e3 * time, torque, 60 * angle, sep=";")
    assert run("inspect", str(path), "--out", str(tmp_path / "other.toml")).returncode == 0
    recording = cs.Recording.read(path)
    np.testing.assert_allclose(recording.torque_nm, 1e3 * torque, rtol=1e-6)
    np.testing.assert_allclose(present(recording.angle_deg), angle, rtol=1e-6)


def test_text_between_names_and_numbers_is_not_passed_over_without_a_word(tmp_path: Path) -> None:
    lines = "Zeit;Drehmoment;Winkel\nCH1;CH2;CH3\ns;kNm;arcmin"
    path = write(tmp_path / "loop.csv", lines, *loop()[:3], sep=";")
    found = inspected(path)
    assert any(text.startswith("Line 2 between names and numbers") for text in found["notes"])
    assert found["metadata"]["columns"]["torque_nm"]["unit"] == "kNm"
