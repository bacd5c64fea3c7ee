"""Torque, angle and clock that are read from one column are refused."""

from pathlib import Path

import pytest

import cyclosweep as cs
from tests.unit.test_inspect import run


@pytest.mark.parametrize(
    ("columns", "key", "other"),
    [
        ('torque_nm = { column = "angle_deg" }', "torque_nm", "angle_deg"),
        ('angle_deg = { column = "torque_nm", unit = "mrad" }', "angle_deg", "torque_nm"),
        ('torque_nm = "M"\nangle_deg = { column = "M", scale = 2.0 }', "torque_nm", "angle_deg"),
        ('time_s = { column = "angle_deg" }', "time_s", "angle_deg"),
    ],
)
def test_settings_that_read_one_column_twice_are_refused(
    tmp_path: Path, columns: str, key: str, other: str
) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg,M\n" + "".join(f"{k},{k},{k}\n" for k in range(20)))
    meta = tmp_path / "loop.toml"
    meta.write_text(f"[columns]\n{columns}\n")
    with pytest.raises(cs.InputError) as refused:
        cs.Recording.read(path)
    said = str(refused.value)
    assert said.startswith(f"{meta}, key columns.{key}: found column ")
    assert f"which {other} reads, too" in said


def test_a_position_may_be_told_by_the_angle(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg\n" + "".join(f"{k},{k}\n" for k in range(20)))
    path.with_suffix(".toml").write_text('[columns]\ncrank_deg = { column = "angle_deg" }\n')
    assert cs.Recording.read(path).crank_deg is not None


def test_options_of_inspect_that_name_one_column_twice_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_text("torque_nm,angle_deg\n" + "".join(f"{k},{k}\n" for k in range(20)))
    result = run("inspect", str(path), "--torque", "angle_deg", "--angle", "angle_deg")
    assert result.returncode == 2
    assert "--angle: found column 'angle_deg', which --torque names, too" in result.stderr
