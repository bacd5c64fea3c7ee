"""Load programmes of the rigs: scaled, laid out as a sheet, read back with their angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.recording.nominal import slope_of
from cyclosweep.recording.programme import beyond_rating, scaled_programme, sheet_of
from tests.support.arrays import present
from tests.unit.test_inspect import run

RIGS = Path(__file__).parents[2] / "examples" / "rigs"
WEIGHTS = RIGS / "weights-and-protractor.csv"


def test_a_programme_is_scaled_to_the_largest_load(tmp_path: Path) -> None:
    out = tmp_path / "expected.csv"
    command = ["simulate", "reference-87", str(WEIGHTS), "--out", str(out)]
    given = run(*command)
    assert given.returncode == 0
    assert "12 N m at the input shaft, 1.65 times" in given.stderr
    assert "--largest-load-nm 7.257" in given.stderr
    scaled = run(*command, "--largest-load-nm", "4")
    assert scaled.returncode == 0
    assert not scaled.stderr
    torque = pl.read_csv(out)["torque_nm"].to_numpy()
    own = cs.Recording.read(WEIGHTS).torque_nm
    np.testing.assert_allclose(torque, own / 3, rtol=1e-9)
    for wrong in ("0", "-1", "nan"):
        refused = run(*command, "--largest-load-nm", wrong)
        assert refused.returncode == 2
        assert "above zero" in refused.stderr


def test_the_rating_is_that_of_the_measured_shaft() -> None:
    drive = cs.Drive.reference_87()
    at_output = cs.Recording.from_arrays([0.0, 500.0], side="output")
    assert beyond_rating(at_output, drive) is None
    assert "500 N m at the input shaft" in str(beyond_rating(
        cs.Recording.from_arrays([0.0, 500.0]), drive))  # fmt: skip
    with pytest.raises(cs.InputError, match="no load"):
        scaled_programme(cs.Recording.from_arrays([0.0, 0.0]), 3.0)


def test_a_programme_beyond_the_recording_of_a_repaired_model_is_said(tmp_path: Path) -> None:
    loop = np.r_[np.linspace(0.5, 20, 40), np.linspace(20, -20, 80), np.linspace(-20, -0.5, 40)]
    twist = 28.0 * np.sign(loop) + 2.73 * loop + 4e-4 * loop**3
    angle = twist + 0.05 * np.random.default_rng(4).normal(size=len(loop))
    recording = cs.Recording.from_arrays(np.tile(loop, 2), np.tile(angle, 2))
    found = cs.diagnose(recording, cs.Drive.reference_87())
    assert found.model is not None
    assert found.model.fitted_torque_nm == (-20.0, 20.0)
    model = tmp_path / "model.json"
    model.write_text(found.model.to_json())
    assert cs.Model.from_json(model).fitted_torque_nm == (-20.0, 20.0)
    program, out = tmp_path / "program.csv", tmp_path / "out.csv"
    for largest, said in ((20.5, False), (40.0, True), (-40.0, True)):
        program.write_text(f"torque_nm\n0\n{largest}\n0\n")
        done = run("simulate", str(model), str(program), "--out", str(out))
        assert done.returncode == 0, done.stderr
        assert ("is extrapolated" in done.stderr) == said


@pytest.mark.parametrize("ends", [(1.0,), (5.0, -5.0), (np.nan, 1.0)])
def test_a_model_refuses_ends_that_are_none(ends: tuple[float, ...]) -> None:
    with pytest.raises(cs.InputError, match="fitted_torque_nm"):
        cs.Model(2.7, 28.0, fitted_torque_nm=ends)  # type: ignore[arg-type]


def test_rows_of_a_programme_without_a_torque_are_said(tmp_path: Path) -> None:
    program, out = tmp_path / "program.csv", tmp_path / "out.csv"
    program.write_text("torque_nm,run\n0,1\nnan,1\n5,1\n")
    done = run("simulate", "reference-87", str(program), "--out", str(out))
    assert done.returncode == 0
    assert "1 of 3 samples without a finite value dropped" in done.stderr
    program.write_text("torque_nm,run\nnan,1\nnan,1\n")
    done = run("simulate", "reference-87", str(program), "--out", str(out))
    assert done.returncode == 2
    assert "no row has all of its values" in done.stderr


def test_a_sheet_filled_in_by_hand_is_a_recording(tmp_path: Path) -> None:
    out, sheet = tmp_path / "expected.csv", tmp_path / "my readings.csv"
    first = run("simulate", "reference-87", str(WEIGHTS), "--out", str(out), "--largest-load-nm",
                "6", "--sheet", str(sheet), "--lever-arm", "0.25")  # fmt: skip
    assert first.returncode == 0, first.stderr
    table = pl.read_csv(sheet)
    assert table.columns == ["No.", "run", "crank_deg", "Weight (kg)", "Angle (deg)"]
    assert table["Weight (kg)"].max() == pytest.approx(6 / 9.80665 / 0.25, abs=5e-4)
    assert table["Angle (deg)"].null_count() == table.height
    expected = pl.read_csv(out)
    table.with_columns(expected["angle_deg"].round(0).alias("Angle (deg)")).write_csv(sheet)
    settings = sheet.with_suffix(".toml")
    asked = f"--drive reference-87 --lever-arm 0.25 --out '{settings}'"
    assert asked in first.stdout
    second = run("inspect", str(sheet), "--drive", "reference-87", "--lever-arm", "0.25",
                 "--out", str(settings))  # fmt: skip
    assert second.returncode == 0, second.stdout + second.stderr
    recording = cs.Recording.read(sheet)
    assert recording.side == "input"
    np.testing.assert_allclose(recording.torque_nm, expected["torque_nm"], atol=2e-3)
    np.testing.assert_allclose(present(recording.angle_deg), expected["angle_deg"], atol=0.51)
    assert present(recording.crank_deg).max() == 155
    again = run("simulate", "reference-87", str(WEIGHTS), "--out", str(out), "--sheet", str(sheet))
    assert again.returncode == 2
    assert "may hold readings" in again.stderr


def test_a_lever_arm_needs_a_sheet_and_is_above_zero(tmp_path: Path) -> None:
    command = ["simulate", "reference-87", str(WEIGHTS), "--out", str(tmp_path / "o.csv")]
    assert "without --sheet" in run(*command, "--lever-arm", "0.2").stderr
    wrong = run(*command, "--lever-arm", "0", "--sheet", str(tmp_path / "s.csv"))
    assert wrong.returncode == 2
    assert "lever arm" in wrong.stderr
    assert not (tmp_path / "o.csv").exists()


def test_a_sheet_has_the_columns_of_its_programme() -> None:
    programme = cs.Recording.read(RIGS / "torque-sensor-and-encoder.csv")
    assert sheet_of(programme).columns == [
        "No.", "run", "crank_deg", "time_s", "temperature_c", "Torque (N m)", "Angle (deg)"
    ]  # fmt: skip


@pytest.mark.parametrize("rig", ["weights-and-protractor", "torque-sensor-and-encoder",
                                 "back-to-back"])  # fmt: skip
def test_programmes_begin_unloaded_at_positions_that_show_every_low_order(rig: str) -> None:
    programme = cs.Recording.read(RIGS / f"{rig}.csv")
    crank = np.radians(np.unique(present(programme.crank_deg)))
    for order in range(1, 6):
        waves = np.column_stack([np.ones_like(crank), np.cos(order * crank),
                                 np.sin(order * crank)])  # fmt: skip
        assert np.linalg.svd(waves, compute_uv=False)[-1] > 0.3, order
    for k in programme.runs:
        torque = programme.torque_nm[programme.run == k]
        assert torque[0] == 0
        assert not np.any(torque[1:] * torque[:-1] < 0)  # zero stands between the signs


def test_readings_without_load_do_not_move_the_slope() -> None:
    torque = np.array([0.0, 2, 4, 6, 4, 2, 0, -2, -4, -6, -4, -2, 0, 2, 4, 6])
    model = cs.Model.of_drive(cs.Drive.reference_87(), "input")
    angle = present(cs.simulate(model, cs.Recording.from_arrays(torque)).angle_deg)
    slope = slope_of(torque, angle)
    assert slope == pytest.approx(model.compliance_deg_per_nm, rel=1e-9)
