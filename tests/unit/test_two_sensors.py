"""Two columns that could be the torque, or the angle: one signal in two units, or two sensors."""

from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_inspect import inspected, loop, run, write


@pytest.mark.parametrize(("gain", "zero"), [(1.01, 0.0), (1.0, 0.05), (1.01, 0.02), (-1.0, 0.0)])
@pytest.mark.parametrize("what", ["torque", "angle"])
def test_two_sensors_that_follow_each_other_are_asked_about(
    tmp_path: Path, gain: float, zero: float, what: str
) -> None:
    _, torque, angle, _ = loop("input")
    one = torque if what == "torque" else angle
    two = gain * one + zero * np.ptp(one)
    if what == "torque":
        path = write(tmp_path / "a.csv", "Torque 1 [Nm],Torque 2 [Nm],phi [deg]", one, two, angle)
    else:
        path = write(tmp_path / "a.csv", "M [Nm],Angle 1 [deg],Angle 2 [deg]", torque, one, two)
    out = tmp_path / "a.toml"
    result = run("inspect", str(path), "--drive", "reference-87", "--out", str(out))
    assert result.returncode == 2
    assert f"could be the {what}: {what.capitalize()} 1" in result.stderr
    assert f"--{what} NAME" in result.stderr
    assert not out.exists()


def test_one_signal_in_two_units_is_taken_from_its_first_column(tmp_path: Path) -> None:
    _, torque, angle, _ = loop("input")
    header = "Torque [Nm],Torque [lbf in],Angle [rad],Angle [deg]"
    columns = torque, torque / 0.1129848, np.deg2rad(angle), angle
    found = inspected(write(tmp_path / "a.csv", header, *columns), "--drive", "reference-87")
    assert found["open"] == []
    columns_read = found["metadata"]["columns"]
    assert columns_read["torque_nm"]["column"] == "Torque [Nm]"
    assert columns_read["angle_deg"]["column"] == "Angle [rad]"
