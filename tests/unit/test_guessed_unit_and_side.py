"""Unit and side that `inspect` guesses by the drive: only what fits clearly."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from tests.unit.test_inspect import inspected, loop, run, write

DRIVE = ("--drive", "reference-87")


def refused(path: Path, *more: str) -> str:
    """Last line of an inspection that writes nothing."""
    out = path.with_suffix(".toml")
    result = run("inspect", str(path), *DRIVE, *more, "--out", str(out))
    assert result.returncode == 2
    assert not out.exists()
    [line] = result.stderr.splitlines()
    return line


def test_whole_numbers_of_an_encoder_are_asked_about(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("output")
    counts = np.rint(angle / 360 * 2**23)
    path = write(tmp_path / "loop.csv", "Torque [N m],Encoder", torque, counts)
    line = refused(path)
    assert "--counts-per-turn" in line
    assert "--angle-unit" in line
    found = inspected(path, *DRIVE, "--counts-per-turn", str(2**23))
    assert found["metadata"]["columns"]["angle_deg"]["unit"] == "counts"
    assert found["metadata"]["side"] == "output"


def test_a_shaft_that_does_not_bear_the_torque_is_not_guessed(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("output")
    path = write(tmp_path / "loop.csv", "Torque [N m],phi", torque, 200 * angle)
    line = refused(path)  # in radians the compliance is within a factor of two of the input's
    assert "output shaft" in line
    assert "--angle-unit" in line


def test_two_guesses_at_once_must_fit_clearly(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("input")
    path = write(tmp_path / "loop.csv", "Torque [N m],phi", 0.1 * torque, 0.17 * angle)
    assert "--side" in refused(path)
    found = inspected(path, *DRIVE, "--side", "input")
    assert found["metadata"]["columns"]["angle_deg"] == "phi"


def test_a_torque_far_beyond_the_rated_one_is_remarked_on(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("output")
    path = write(tmp_path / "loop.csv", "Torque [N m],Angle [deg]", torque, angle)
    found = inspected(path, *DRIVE, "--side", "input")
    assert any("times the rated one of the input shaft" in text for text in found["checks"])
    assert inspected(path, *DRIVE)["checks"] == []


def test_where_neither_side_fits_nothing_is_written(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("output")
    path = write(tmp_path / "loop.csv", "Torque [N m],Angle [deg]", torque, 60 * angle)
    assert "Neither side fits" in refused(path)
    assert inspected(path, *DRIVE, "--side", "output")["metadata"]["side"] == "output"


@pytest.mark.parametrize("wraps_at", [15, 45, -20])
@pytest.mark.parametrize(("header", "scale"), [("Angle [deg]", 1.0), ("phi", 60.0)])
def test_a_dial_that_wraps_is_put_together_first(
    tmp_path: Path, wraps_at: int, header: str, scale: float
) -> None:
    _, torque, angle, _ = loop("output")
    read = (angle - angle[wraps_at]) % 360.0 * scale
    found = inspected(write(tmp_path / "loop.csv", f"Torque [N m],{header}", torque, read), *DRIVE)
    assert found["metadata"]["side"] == "output"
    assert found["checks"] == []
    if scale != 1.0:
        assert found["metadata"]["columns"]["angle_deg"]["unit"] == "arcmin"


def test_a_drive_that_cannot_be_built_is_refused_though_its_stiffness_is_given(
    tmp_path: Path,
) -> None:
    drive = cs.Drive.reference_87().replace(
        eccentricity_mm=30.0, output_stiffness_nm_per_arcmin=140.0, shaft=()
    )
    drive.to_toml(tmp_path / "drive.toml")
    _, torque, angle, _ = loop("output")
    path = write(tmp_path / "loop.csv", "torque_nm,angle_deg", torque, angle)
    result = run("inspect", str(path), "--drive", str(tmp_path / "drive.toml"))
    assert result.returncode == 2
    assert "eccentricity too large" in result.stderr
    with pytest.raises(cs.DesignError, match="eccentricity too large"):
        cs.diagnose(cs.Recording.read(path), drive)
