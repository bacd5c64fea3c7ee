"""`cyclosweep inspect`: what it understands of a file, what it asks, what it writes."""

from __future__ import annotations

import io
import json
import os
import shlex
import subprocess
import sys
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.cli import main
from tests.support.arrays import present


def run(*arguments: str, columns: int = 100) -> subprocess.CompletedProcess[str]:
    """Run the command line in this process."""
    out, err, status = io.StringIO(), io.StringIO(), 0
    with (
        redirect_stdout(out),
        redirect_stderr(err),
        mock.patch.object(sys, "argv", ["cyclosweep", *arguments]),
        mock.patch.dict(os.environ, {"COLUMNS": str(columns)}),
    ):
        try:
            main()
        except SystemExit as stop:
            status = stop.code if isinstance(stop.code, int) else 0
    return subprocess.CompletedProcess(arguments, status, out.getvalue(), err.getvalue())


def loop(side: str = "input", runs: int = 2) -> tuple[Any, Any, Any, Any]:
    """Time, torque, angle and run of the reference drive."""
    line = cs.Drive.reference_87().nominal_line("output" if side == "output" else "input")
    top = 20.0 if side == "input" else 900.0
    up = np.linspace(0.02, 1, 60) * top
    one = np.r_[up, up[::-1], -up, -up[::-1]]
    torque = np.tile(one, runs)
    angle = line.free_play_deg * np.sign(torque) + 1.1 * line.compliance_deg_per_nm * torque
    time = 0.25 * np.arange(len(torque), dtype=np.float64)
    return time, torque, angle, np.repeat(np.arange(1.0, runs + 1), len(one))


def write(path: Path, header: str, *columns: Any, lines: str = "", sep: str = ",") -> Path:
    rows = zip(*columns, strict=True)
    text = "".join(sep.join(f"{value:.9g}" for value in row) + "\n" for row in rows)
    path.write_text(lines + header + "\n" + text)
    return path


def inspected(path: Path, *more: str) -> dict[str, Any]:
    result = run("inspect", str(path), "--json", *more)
    assert result.returncode == 0, result.stderr
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def test_a_foreign_file_to_a_recording(tmp_path: Path) -> None:
    time, torque, angle, trial = loop()
    path = write(
        tmp_path / "loop 1.csv", "Zeit;Drehmoment;Verdrehwinkel;Versuch;Bemerkung",
        time * 1e3, torque / 0.112984829, angle * 60, trial, trial,
        lines="Pruefstand;3\nDatum;11.07.2024\n\n", sep=";",
    )  # fmt: skip
    text = path.read_text().replace("Bemerkung\n", "Bemerkung\n[ms];[lbf in];[arcmin];[-];[-]\n")
    path.write_text(text.replace(".", ",").replace("11,07,2024", "11.07.2024"))
    out = tmp_path / "loop 1.toml"
    result = run("inspect", str(path), "--drive", "reference-87", "--out", str(out), columns=60)
    assert result.returncode == 0, result.stderr
    assert max(map(len, result.stdout.splitlines()[:40])) <= 60 + len(str(path))
    [line] = [each for each in result.stdout.splitlines() if each.startswith("Next: ")]
    assert shlex.split(line)[1:4] == ["cyclosweep", "diagnose", str(path)]
    recording = cs.Recording.read(path)
    np.testing.assert_allclose(recording.torque_nm, torque, rtol=1e-6)
    np.testing.assert_allclose(present(recording.angle_deg), angle, rtol=1e-6)
    np.testing.assert_allclose(present(recording.time_s), time, atol=1e-6)
    assert recording.runs == (1, 2)
    assert recording.side == "input"
    assert recording.drive == "reference-87"


def test_what_exists_is_replaced_only_when_told(tmp_path: Path) -> None:
    path = write(tmp_path / "loop.csv", "torque_nm,angle_deg", *loop()[1:3])
    out = tmp_path / "other.toml"
    out.write_text("mine")
    result = run("inspect", str(path), "--out", str(out))
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1
    assert "--force" in result.stderr
    assert out.read_text() == "mine"
    assert run("inspect", str(path), "--out", str(out), "--force").returncode == 0
    assert "side" in out.read_text()


def test_two_columns_that_could_be_the_torque_are_asked_for(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "Torque 1,Torque 2,Angle [deg]", torque, 1.1 * torque**3,
                 angle)  # fmt: skip
    out = tmp_path / "loop.toml"
    result = run("inspect", str(path), "--out", str(out))
    assert result.returncode == 2
    for word in ("Torque 1", "Torque 2", "--torque"):
        assert word in result.stderr
    assert not out.exists()
    named = run("inspect", str(path), "--out", str(out), "--torque", "Torque 1")
    assert named.returncode == 0, named.stderr
    np.testing.assert_allclose(cs.Recording.read(path).torque_nm, torque, rtol=1e-6)
    assert run("inspect", str(path), "--torque", "nothing").returncode == 2


@pytest.mark.parametrize("side", ["input", "output"])
@pytest.mark.parametrize(("unit", "scale"), [("rad", 57.29578), ("turns", 360.0), ("deg", 1.0)])
def test_the_drive_tells_side_and_unit(tmp_path: Path, side: str, unit: str, scale: float) -> None:
    _, torque, angle, _ = loop(side)
    path = write(tmp_path / "loop.csv", "Torque,Position", torque, angle / scale)
    # The unit is not stated; the side is, or two unknowns would be told from one slope.
    found = inspected(path, "--drive", "reference-87", "--side", side)
    column = found["metadata"]["columns"]["angle_deg"]
    assert (column if unit == "deg" else column["unit"]) == ("Position" if unit == "deg" else unit)
    stated = write(tmp_path / "stated.csv", "Torque [N m],Angle [deg]", torque, angle)
    assert inspected(stated, "--drive", "reference-87")["metadata"]["side"] == side


def test_a_unit_that_fits_nothing_is_asked_for(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "Torque,Position", torque, angle / 19.0)
    result = run("inspect", str(path), "--drive", "reference-87", "--side", "input",
                 "--out", str(tmp_path / "x.toml"))  # fmt: skip
    assert result.returncode == 2
    assert "--angle-unit" in result.stderr
    said = inspected(path, "--side", "input", "--angle-unit", "mrad")
    assert said["metadata"]["columns"]["angle_deg"]["unit"] == "mrad"


def test_an_encoder_s_steps_tell_its_unit(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    turns = np.rint(angle / 360 * 4096 * 16) / 4096 / 16
    path = write(tmp_path / "loop.csv", "Torque,Position", torque, turns)
    found = inspected(path)
    assert found["metadata"]["columns"]["angle_deg"]["unit"] == "turns"
    assert any("power of two" in text for text in found["assumed"])


def test_current_force_and_counts_ask_for_their_constant(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "Iq [A],Encoder [counts]", torque / 0.4, angle / 360 * 8192)
    out = tmp_path / "loop.toml"
    result = run("inspect", str(path), "--out", str(out))
    assert result.returncode == 2
    assert "--nm-per-a" in result.stdout
    assert "--counts-per-turn" in result.stdout
    given = run("inspect", str(path), "--out", str(out), "--nm-per-a", "0.4",
                "--counts-per-turn", "8192")  # fmt: skip
    assert given.returncode == 0, given.stderr
    recording = cs.Recording.read(path)
    assert recording.torque_from == "motor-current"
    np.testing.assert_allclose(recording.torque_nm, torque, rtol=1e-6)
    np.testing.assert_allclose(present(recording.angle_deg), angle, rtol=1e-6)


def test_a_load_without_a_unit_may_be_a_force_or_a_torque(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "load,Angle [deg]", torque, angle)
    asked = run("inspect", str(path), "--out", str(tmp_path / "loop.toml"))
    assert asked.returncode == 2
    assert "N m assumed" not in asked.stdout
    assert asked.stderr.rstrip().endswith("--lever-arm M, or, where it is a torque, "
                                          "--torque-unit 'N m'.")  # fmt: skip
    for options, factor in (
        (("--torque-unit", "N m"), 1.0),
        (("--lever-arm", "0.5"), 0.5),
    ):
        given = run("inspect", str(path), "--out", str(tmp_path / "loop.toml"), *options)
        assert given.returncode == 0, given.stderr
        read = cs.Recording.read(path).torque_nm
        np.testing.assert_allclose(read, factor * torque, rtol=1e-6)
        (tmp_path / "loop.toml").unlink()


def test_a_geared_encoder_that_wraps(tmp_path: Path) -> None:
    torque = 900 * np.sin(np.linspace(0, 12, 1500))
    angle = 3.0 * np.tanh(torque / 300) + 1.5
    path = write(tmp_path / "loop.csv", "Torque [N m],Angle [deg]", torque, angle % (360 / 87))
    found = inspected(path, "--drive", "reference-87", "--side", "output")
    assert found["metadata"]["columns"]["angle_deg"]["modulo"] == pytest.approx(360 / 87, rel=1e-5)


def test_ticks_runs_and_a_motor_at_its_limit(tmp_path: Path) -> None:
    ramp = np.r_[np.linspace(0, 40, 400), np.linspace(40, 0, 400)]
    small = 0.1 * ramp
    command = np.r_[small, ramp, ramp, ramp]
    rng = np.random.default_rng(3)
    torque = np.minimum(command, 25) + 0.05 * rng.normal(size=len(command))
    trial = np.repeat([1.0, 2, 3, 4], 800)
    time = 0.015 * (np.arange(len(command)) // 6)
    path = write(tmp_path / "loop.csv", "TIME,TORQUE,COMMAND_TORQUE,ANGLE [deg],test_nr,I_q [A]",
                 time, torque, command, 0.1 * torque, trial, torque / 2)  # fmt: skip
    meta = inspected(path)["metadata"]
    assert meta["merge"] == {"same_time": True}
    assert meta["select"] == {"test_nr": [2, 3, 4]}
    assert meta["history"] == "continuous"
    assert meta["conditioning_runs"] == [2]
    assert meta["holdout_runs"] == [4]
    assert meta["torque_from"] == "motor-current"
    assert 22 < meta["score"]["abs_max"]["COMMAND_TORQUE"] < 28


def test_facts_are_shown(tmp_path: Path) -> None:
    time, torque, angle, trial = loop()
    torque = torque.copy()
    torque[100:120] = torque[100]
    time = time + np.where(np.arange(len(time)) > 150, 60.0, 0.0)
    path = write(tmp_path / "loop.csv", "time_s,torque_nm,angle_deg,run", time, torque, angle,
                 trial)  # fmt: skip
    path.write_text(path.read_text() + "999,,5,2\n")
    found = inspected(path)
    assert "both directions" in found["facts"]["torque"]
    assert "4 Hz" in found["facts"]["clock"]
    assert found["facts"]["clock"].endswith("1 gap")
    assert found["facts"]["runs"].startswith("2: 1 (240 samples")
    assert found["facts"]["dwells"].startswith("1 at constant torque")
    assert any(column["missing"] == 1 for column in found["columns"])
    assert any("--drive" in text for text in found["assumed"])
    plain = run("inspect", str(path))
    assert plain.returncode == 0
    for word in ("Columns", "Understood", "Assumed", "Proposed metadata file"):
        assert word in plain.stdout


def test_a_column_that_is_not_read_is_named(tmp_path: Path) -> None:
    time, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "Time [s],Torque [N m],Angle [deg],Position", time, torque,
                 angle, 7 * time)  # fmt: skip
    assert inspected(path)["unread_columns"] == ["Position"]
    assert "numbers, not read: Position\n" in run("inspect", str(path)).stdout
    path = write(tmp_path / "all.csv", "Time [s],Torque [N m],Angle [deg]", time, torque, angle)
    assert inspected(path)["unread_columns"] == []
    assert "not read" not in run("inspect", str(path)).stdout


def test_a_row_of_units_under_canonical_names(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "torque_nm,angle_deg\nlbf in,mrad",
                 torque / 0.112984829, angle / 0.0572957795)  # fmt: skip
    found = inspected(path, "--drive", "reference-87")
    assert found["metadata"]["columns"]["torque_nm"]["unit"] == "lbf in"
    (said,) = (text for text in found["assumed"] if text.startswith("Side"))
    assert "1.10 times" in said


def test_dwells_with_noise_are_counted(tmp_path: Path) -> None:
    ramp = np.linspace(0, 20, 100)
    rng = np.random.default_rng(5)
    torque = np.r_[ramp, np.full(80, 20.0), ramp[::-1], np.zeros(80)]
    torque = torque + 0.02 * rng.normal(size=len(torque))
    time = 0.5 * np.arange(len(torque))
    path = write(tmp_path / "loop.csv", "time_s,torque_nm,angle_deg", time, torque, 3 * torque)
    dwells = inspected(path)["facts"]["dwells"]
    assert dwells.startswith("2 at constant torque")
    assert "40" in dwells


def test_what_is_no_table_is_one_line(tmp_path: Path) -> None:
    path = tmp_path / "loop.csv"
    path.write_bytes(bytes(range(256)) * 4)
    result = run("inspect", str(path))
    assert result.returncode == 2
    assert len(result.stderr.splitlines()) == 1
    assert run("inspect", str(tmp_path / "gone.csv")).returncode == 2


@pytest.mark.parametrize("columns", [50, 70])
def test_the_proposal_is_as_narrow_as_the_terminal(tmp_path: Path, columns: int) -> None:
    _, torque, angle, _ = loop()
    path = write(tmp_path / "loop.csv", "M [Nm],phi [deg]", torque, angle)
    result = run("inspect", str(path), "--drive", "reference-87", columns=columns)
    proposed = result.stdout.partition("Proposed metadata file")[2].splitlines()[1:]
    assert max(map(len, proposed)) <= columns
    said = " ".join(line.removeprefix("# ") for line in proposed if line.startswith("# "))
    assert "Assumed: Side not given: input shaft, the compliance is then" in said


def test_tabs_between_cells_are_said_in_words(tmp_path: Path) -> None:
    _, torque, angle, _ = loop()
    rows = "".join(f"{t:g}\t{a:g}\n" for t, a in zip(torque, angle, strict=True))
    path = tmp_path / "loop.tsv"
    path.write_text("Drehmoment [Nm]\tWinkel [deg]\n" + rows.replace(".", ","))
    assert "Cells divided by tabs, decimal commas." in inspected(path)["notes"]
