"""Cells that programs write in their own way, and columns of text where numbers belong."""

from __future__ import annotations

from pathlib import Path
from unittest import mock

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import present
from tests.unit.test_inspect import inspected, loop, run, write


@pytest.mark.parametrize(
    ("cell", "value"),
    [("\N{MINUS SIGN}3.3", -3.3), ("2.05157D-05", 2.05157e-05), ("-1.5d+01", -15.0)],
)
def test_numbers_as_programs_write_them(tmp_path: Path, cell: str, value: float) -> None:
    path = tmp_path / "loop.csv"
    path.write_text(f"torque_nm,angle_deg\n1,2\n{cell},3\n4,5\n")
    np.testing.assert_allclose(cs.Recording.read(path).torque_nm, [1, value, 4])


@pytest.mark.parametrize("cell", ["1.#QNAN", "-1.#IND", "1.#INF"])
def test_no_number_of_an_old_compiler_is_missing(tmp_path: Path, cell: str) -> None:
    path = tmp_path / "loop.csv"
    path.write_text(f"torque_nm,angle_deg\n1,2\n{cell},3\n4,5\n")
    recording = cs.Recording.read(path)
    np.testing.assert_allclose(recording.torque_nm, [1, 4])
    assert any("the first of them sample 2" in note for note in recording.notes)


@pytest.mark.parametrize(
    ("header", "cells", "said"),
    [
        ("time_s,torque,angle_deg", "{0},{1} Nm,{2}", "line 2, column torque: found '0.4"),
        ("time_s,torque_nm,angle", "{0},{1},{2}°00'", 'line 2, column angle: found "'),
        ("time_s,torque_nm,Angle [min]", "{0},{1},{2}", "'min' is a unit of time"),
    ],
)
def test_torque_and_angle_that_cannot_be_read_are_refused(
    tmp_path: Path, header: str, cells: str, said: str
) -> None:
    path, out = tmp_path / "loop.csv", tmp_path / "loop.toml"
    rows = zip(*loop()[:3], strict=True)
    text = "".join(cells.format(*(f"{x:g}" for x in row)) + "\n" for row in rows)
    path.write_text(f"{header}\n{text}")
    result = run("inspect", str(path), "--out", str(out))
    assert result.returncode == 2
    [line] = result.stderr.splitlines()
    assert said in line
    assert not out.exists()


def test_a_clock_that_is_text_is_said_not_to_be_read(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    rows = enumerate(zip(*loop()[1:3], strict=True))
    text = "".join(f"at {k},{t:g},{a:g}\n" for k, (t, a) in rows)
    path.write_text("Zeit,torque_nm,angle_deg\n" + text)
    assert any("the clock is not read" in text for text in inspected(path)["assumed"])


def test_names_and_units_in_a_comment_above_blanks(tmp_path: Path) -> None:
    time, torque, angle, _ = loop()
    path = tmp_path / "loop.txt"
    names = "time [s]  torque [Nm]  angle [deg]"
    np.savetxt(path, np.c_[time, torque, angle], header=names, fmt="%12.6f")
    inspected(path, "--out", str(tmp_path / "loop.toml"))
    np.testing.assert_allclose(present(cs.Recording.read(path).angle_deg), angle, atol=1e-5)


def test_a_clock_that_starts_anew_asks_for_a_run_column() -> None:
    time = np.r_[np.arange(60.0), np.arange(60.0)]
    torque = np.r_[np.linspace(0, 10, 60), np.linspace(0, 10, 60)]
    [fault] = cs.Recording.from_arrays(torque, 2 * torque, time_s=time).faults
    assert fault.reason.startswith("Time runs backwards once at sample 61")
    assert "column run" in fault.reason
    [fault] = cs.Recording.from_arrays(torque, 2 * torque, time_s=-np.arange(120.0)).faults
    assert "column run" not in fault.reason


def test_facts_of_a_clock(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    time = -np.arange(len(torque), dtype=np.float64)
    path = write(tmp_path / "loop.csv", "time_s,torque_nm,angle_deg", time, torque, angle)
    assert inspected(path, "--angle", "angle_deg")["facts"]["clock"] != "stands still"


def test_a_folder_as_out_is_not_said_to_be_replaced(tmp_path: Path) -> None:
    path = write(tmp_path / "loop.csv", "torque_nm,angle_deg", *loop()[1:3])
    result = run("inspect", str(path), "--out", str(tmp_path))
    assert result.returncode == 2
    assert "expected a file" in result.stderr
    assert "--force" not in result.stderr


def test_an_interruption_has_the_status_that_shells_expect(tmp_path: Path) -> None:
    path = write(tmp_path / "loop.csv", "torque_nm,angle_deg", *loop()[1:3])
    with mock.patch("cyclosweep.diagnosis.diagnose", side_effect=KeyboardInterrupt):
        arguments = ("diagnose", str(path), "--drive", "reference-87", "--out")
        result = run(*arguments, str(tmp_path / "out"))
    assert result.returncode == 130
    assert result.stderr.startswith("cyclosweep: interrupted; ")
    with mock.patch("cyclosweep.recording.inspection.inspect", side_effect=KeyboardInterrupt):
        assert run("inspect", str(path)).returncode == 130
