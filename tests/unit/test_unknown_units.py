"""Units that a file states and that nobody knows: asked for, never replaced by a usual one."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.units import KILOPOND_N, find_unit
from tests.unit.test_inspect import inspected, loop, run, write


@pytest.mark.parametrize(
    ("header", "unit", "way"),
    [
        ("Zeit [s],Torque [foo],Angle [deg]", "foo", "--torque-unit"),
        ("Zeit [s],Torque (mV/V),Angle [deg]", "mV/V", "--torque-unit"),
        ("Zeit [s],Torque [%],Angle [deg]", "%", "--torque-unit"),
        ("Zeit [s],Torque [10 Nm],Angle [deg]", "10 Nm", "--torque-unit"),
        ("Zeit [s],Torque [MNm],Angle [deg]", "MNm", "--torque-unit"),
        ("Zeit [s],Torque [Nm],Angle [mm]", "mm", "--angle-unit"),
        ("Zeit [s],Torque [Nm],Angle [degree min]", "degree min", "--angle-unit"),
        ("Zeit [1/100 s],Torque [Nm],Angle [deg]", "1/100 s", "columns.time_s"),
        ("Zeit [samples],Torque [Nm],Angle [deg]", "samples", "columns.time_s"),
    ],
)
def test_a_unit_that_is_not_known_is_asked_for(
    tmp_path: Path, header: str, unit: str, way: str
) -> None:
    path, out = write(tmp_path / "loop.csv", header, *loop()[:3]), tmp_path / "loop.toml"
    result = run("inspect", str(path), "--out", str(out))
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1
    assert f"unit {unit!r} is not known, expected '" in result.stderr
    assert way in result.stderr
    assert not out.exists()


def test_the_option_answers_it(tmp_path: Path) -> None:
    time, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "Zeit [s],Torque [foo],Angle [deg]", time, torque, angle)
    out = tmp_path / "loop.toml"
    result = run("inspect", str(path), "--torque-unit", "kN m", "--out", str(out))
    assert result.returncode == 0, result.stderr
    np.testing.assert_allclose(cs.Recording.read(path).torque_nm, 1e3 * torque, rtol=1e-6)


def test_settings_without_a_unit_do_not_pass_one_over(tmp_path: Path) -> None:
    path = write(tmp_path / "loop.csv", "Torque [foo],Angle [deg]", *loop()[1:3])
    meta = tmp_path / "loop.toml"
    columns = '[columns]\nangle_deg = "Angle [deg]"\ntorque_nm = {{ column = "Torque [foo]"{} }}\n'
    meta.write_text(columns.format(""))
    with pytest.raises(cs.InputError, match=r"column Torque \[foo\]: unit 'foo' is not known"):
        cs.Recording.read(path)
    meta.write_text(columns.format(", scale = 2.0"))
    assert cs.Recording.read(path).torque_nm.max() == pytest.approx(40.0)


@pytest.mark.parametrize("name", ["Torque (filtered)", "Torque[2]", "Torque [-]", "Torque (CH 1)"])
def test_a_word_about_a_column_is_no_unit(tmp_path: Path, name: str) -> None:
    path = write(tmp_path / "loop.csv", f"{name},Angle [deg]", *loop()[1:3])
    assert inspected(path)["open"] == []


def test_a_temperature_in_volts_is_left_out(tmp_path: Path) -> None:
    time, torque, angle, _ = loop()
    header = "torque_nm,angle_deg,Temperature [V]"
    found = inspected(write(tmp_path / "loop.csv", header, torque, angle, time))
    assert "temperature_c" not in found["metadata"].get("columns", {})
    assert any("unit 'V' is not known: not read" in text for text in found["assumed"])


@pytest.mark.parametrize(
    ("spelling", "column", "factor"),
    [
        ("foot-pounds", "torque_nm", 1.3558179),
        ("pound-feet", "torque_nm", 1.3558179),
        ("daNm", "torque_nm", 10.0),
        ("dN·m", "torque_nm", 0.1),
        ("µNm", "torque_nm", 1e-6),
        ("kg·m", "torque_nm", KILOPOND_N),
        ("mkp", "torque_nm", KILOPOND_N),
        ("gons", "angle_deg", 0.9),
        ("Altgrad", "angle_deg", 1.0),
        ("arc minutes", "angle_deg", 1 / 60),
        ("Bogenmin.", "angle_deg", 1 / 60),
        ("Tage", "time_s", 86400.0),
    ],
)
def test_more_spellings(spelling: str, column: str, factor: float) -> None:
    unit = find_unit(spelling, column)
    assert unit is not None
    assert unit.factor == pytest.approx(factor, rel=1e-7)
