"""`cyclosweep inspect` with settings beside the file, cells of text, and what it marks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_inspect import inspected, loop, run, write


def lab(folder: Path, name: str = "loop.csv") -> Path:
    """A loop of the reference drive as a laboratory writes it, units stated."""
    time, torque, angle, trial = loop(runs=3)
    return write(
        folder / name, "Zeit [ms],Drehmoment [lbf in],Verdrehwinkel [arcmin],Versuch",
        time * 1e3, torque / 0.112984829, angle * 60, trial,
    )  # fmt: skip


def test_settings_beside_the_file_are_what_is_shown(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "lever.csv", "Nr,G1,phi", np.arange(480), torque / 1.962, angle)
    path.with_suffix(".toml").write_text(
        'side = "input"\ndrive = "reference-87"\n'
        '[columns]\ntorque_nm = {column = "G1", unit = "kg", lever_arm_m = 0.2}\nangle_deg="phi"\n'
    )
    found = inspected(path)
    assert found["open"] == []
    roles = {column["name"]: (column["role"], column["unit"]) for column in found["columns"]}
    assert roles["G1"] == ("torque_nm", "kg")
    assert "-19.99 to 19.99 N m" in found["facts"]["torque"]
    assert found["metadata"]["columns"]["torque_nm"]["lever_arm_m"] == 0.2
    assert found["suggested"] == []
    shown = run("inspect", str(path))
    # The path may be longer than a line.
    assert f"settingsinforce:{path.with_suffix('.toml')}" in "".join(shown.stdout.split())
    assert "Proposed metadata file" not in shown.stdout
    alone = inspected(path, "--ignore-settings")
    assert "No column is recognised as the torque" in alone["open"][0]
    assert "--header-row" in alone["open"][0]


def test_what_the_file_suggests_otherwise_is_listed(tmp_path: Path) -> None:
    path = lab(tmp_path)
    path.with_suffix(".toml").write_text(
        'side = "input"\ndrive = "reference-87"\nconditioning_runs = [2]\n'
        '[columns]\ntorque_nm = "Drehmoment [lbf in]"\nangle_deg = "Verdrehwinkel [arcmin]"\n'
        'run = "Versuch"\n'
    )
    found = inspected(path)
    text = "\n".join(found["suggested"])
    assert "time_s: not read by the settings, could be 'Zeit [ms]'" in text
    assert 'history = "continuous"' in text
    assert "conditioning_runs = [1]" in text
    assert "the settings say [2]" in text
    assert "clock" in found["facts"]
    assert found["facts"]["clock"].startswith("none")  # as diagnose would read it
    out = tmp_path / "better.toml"
    assert run("inspect", str(path), "--out", str(out)).returncode == 0
    written = out.read_text()
    assert "conditioning_runs = [2]\n" in written  # what the settings say stands
    assert 'history = "continuous"  # Assumed: the clock goes on' in written


def test_settings_that_do_not_fit_stop_inspect_as_diagnose(tmp_path: Path) -> None:
    path = lab(tmp_path)
    settings = path.with_suffix(".toml")
    settings.write_text('drive="reference-87"\n[columns]\ntorque_nm = "Moment"\n')
    result = run("inspect", str(path))
    assert result.returncode == 2
    assert "columns.torque_nm" in result.stderr
    assert "'Moment'" in result.stderr
    settings.write_text(
        'drive="reference-87"\n[columns]\ntorque_nm="Drehmoment [lbf in]"\n'
        'angle_deg={column="Verdrehwinkel [arcmin]", unit="deg"}\n'
    )
    for command in (["inspect"], ["diagnose", "--out", str(tmp_path / "out")]):
        result = run(command[0], str(path), *command[1:])
        assert result.returncode == 2
        assert "'arcmin' by the file" in result.stderr
    settings.write_text('side = "input"\n')  # says nothing of columns: the file is still proposed
    found = inspected(path, "--drive", "reference-87")
    assert "no column torque_nm" in found["stops"]
    assert found["metadata"]["columns"]["torque_nm"]["unit"] == "lbf in"


def test_settings_may_be_given(tmp_path: Path) -> None:
    path = lab(tmp_path)
    (tmp_path / "series.toml").write_text('[columns]\ntorque_nm = "Moment"\n')
    result = run("inspect", str(path), "--meta", str(tmp_path / "series.toml"))
    assert result.returncode == 2
    assert "series.toml, key columns.torque_nm" in result.stderr


@pytest.mark.parametrize(("cell", "column"), [("OVERLOAD", 1), ("abc", 2), ("gap", 0)])
def test_one_text_does_not_change_what_a_column_is(tmp_path: Path, cell: str, column: int) -> None:
    path = lab(tmp_path)
    lines = path.read_text().splitlines()
    cells = lines[40].split(",")
    cells[column] = cell
    path.write_text("\n".join([*lines[:40], ",".join(cells), *lines[41:]]) + "\n")
    name = lines[0].split(",")[column]
    found = inspected(path, "--drive", "reference-87", "--side", "input")
    (question,) = found["open"]
    for word in (str(path), "line 41", name, f"'{cell}'", f"--missing {cell}"):
        assert word in question
    assert {"torque_nm", "angle_deg", "time_s"} <= {c["role"] for c in found["columns"]}
    out = path.with_suffix(".toml")
    args = ["--drive", "reference-87", "--side", "input", "--out", str(out)]
    assert run("inspect", str(path), *args).returncode == 2
    assert not out.exists()
    done = run("inspect", str(path), *args, "--missing", cell)
    assert done.returncode == 0, done.stderr
    assert f'missing = ["{cell}"]' in out.read_text()
    assert inspected(path)["facts"]["samples"].startswith("719 of")


def test_a_unit_option_against_the_file_is_refused(tmp_path: Path) -> None:
    result = run("inspect", str(lab(tmp_path)), "--torque-unit", "N m")
    assert result.returncode == 2
    assert "--torque-unit: found 'N m', but the file states 'lbf in'" in result.stderr
    assert "instead_of" in result.stderr


def test_a_drive_that_cannot_be_built_stops_inspect(tmp_path: Path) -> None:
    run("new", "drive", "--out", str(tmp_path / "d.toml"))
    drive = tmp_path / "d.toml"
    text = drive.read_text()
    drive.write_text(text.replace("end_diameter_mm = 60.0", "end_diameter_mm = 80.0"))
    result = run("inspect", str(lab(tmp_path)), "--drive", str(drive))
    assert result.returncode == 2
    assert "flange cuts the pin circle" in result.stderr
    assert len(result.stderr.splitlines()) == 1
    shown = run("show", str(drive))
    assert shown.returncode == 2
    assert run("show", "reference-87").returncode == 0


def test_everything_that_the_file_does_not_state_is_marked(tmp_path: Path) -> None:
    path = lab(tmp_path)
    out = tmp_path / "loop.toml"
    run("inspect", str(path), "--drive", "reference-87", "--out", str(out))
    for line in out.read_text().splitlines():
        if line.split(" = ")[0] in ("side", "history", "conditioning_runs", "holdout_runs"):
            assert "# Assumed" in line
    path = write(tmp_path / "odd.csv", "Torque [N m],Angle [deg]", *(
        values * factor for values, factor in zip(loop()[1:3], (1, 12), strict=True)))  # fmt: skip
    found = inspected(path, "--drive", "reference-87", "--side", "input")
    assert any("times the drive's" in text for text in found["checks"])
    assert not any("times the drive's" in text for text in found["assumed"])
    assert "# Check: In these units" in found["toml"]


def test_times_of_day_have_no_unit_to_assume(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    stamps = [f"2026-11-23T10:{k // 60:02d}:{k % 60:02d}" for k in range(len(torque))]
    rows = zip(stamps, torque, angle, strict=True)
    path = tmp_path / "loop.csv"
    path.write_text("Zeitstempel,Torque [N m],Angle [deg]\n" + "".join(
        f"{s},{t},{a}\n" for s, t, a in rows))  # fmt: skip
    found = inspected(path, "--drive", "reference-87")
    assert not any("Zeitstempel" in text for text in found["assumed"])
    assert any("Zeitstempel holds" in text for text in found["notes"])


def test_what_is_lost_without_a_clock_is_said(tmp_path: Path) -> None:
    _, torque, angle, trial = loop(runs=3)
    path = write(tmp_path / "loop.csv", "Torque [N m],Angle [deg],run", torque, angle, trial)
    text = "\n".join(inspected(path, "--drive", "reference-87")["assumed"])
    for word in ("No clock", "history", "conditioning", "held out"):
        assert word in text
    result = run("inspect", str(path), "--drive", "reference-87", "--json")
    assert "history" not in json.loads(result.stdout)["metadata"]
