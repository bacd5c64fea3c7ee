"""A drive written from a catalogue: read, evaluated, its budget read, swept."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.reference.validation import report_json, summary

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def drive() -> cs.Drive:
    return cs.Drive.from_toml(EXAMPLES / "catalogue-29.toml")


def test_it_is_evaluated_and_its_budget_sums_to_the_twist(drive: cs.Drive) -> None:
    assert drive.explain() is None
    state = drive.loaded()
    assert state.converged
    assert state.budget["twist_arcmin"].sum() == pytest.approx(state.twist_arcmin, rel=1e-9)
    shares = dict(zip(state.budget["component"], state.budget["share"], strict=True))
    # What docs/components.md reads off it.
    assert max(shares, key=lambda name: shares[name]) == "clearance"
    assert shares["clearance"] == pytest.approx(0.42, abs=0.01)
    assert shares["output shaft"] == pytest.approx(0.26, abs=0.01)
    assert state.twist_arcmin == pytest.approx(7.9, abs=0.05)
    tight = drive.replace(ring_clearance_mm=0.0, hole_clearance_mm=0.0).loaded()
    assert tight.twist_arcmin < state.twist_arcmin - 3


def test_what_the_file_leaves_out_is_marked(drive: cs.Drive) -> None:
    marks = drive.part_table().filter(pl.col("mark").str.starts_with("assumed: default"))
    assert "friction_ring" in marks["key"].to_list()
    assert "ring_pin_radius_mm" not in marks["key"].to_list()


def test_the_study_runs(tmp_path: Path) -> None:
    study = EXAMPLES / "catalogue-29-study.toml"
    run = subprocess.run(
        [sys.executable, "-m", "cyclosweep", "sweep", str(study), "--out", str(tmp_path / "out")],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
    found = cs.scan_dataset(tmp_path / "out").collect()
    assert found.height == 875
    counts = dict(found["status"].value_counts().iter_rows())
    assert counts == {"ok": 378, "limit_lost_motion_3pct_arcmin": 497}
    kept = found.filter(pl.col("status") == "ok")
    gaps = kept.select(pl.col("hole_clearance_mm") + pl.col("ring_clearance_mm"))
    assert gaps.to_series().to_numpy().max() == pytest.approx(0.0125)
    assert kept["solver_status"].unique().to_list() == ["quadratic"]


def test_what_the_paper_prints_of_its_own_drive_is_not_asked_of_it(drive: cs.Drive) -> None:
    table = cs.validate(drive)
    assert not table.filter(
        pl.col("counted") & ~pl.col("ok") & (pl.col("explanation") == "")
    ).height
    assert "nominal input torque T_N" not in table["fact"].to_list()
    assert not table.filter(kind="input").height
    report = report_json(drive)
    assert report["ok"]
    assert summary(report["counts"], drive).endswith("was not asked of catalogue-29.")
    # A drive of 87:1 is asked all of it, whatever its dimensions.
    other = cs.Drive.reference_87().replace(eccentricity_mm=0.6, free_play_deg=20.0)
    assert cs.validate(other)["fact"].to_list() == cs.validate()["fact"].to_list()


def test_every_missing_key_is_named(tmp_path: Path) -> None:
    table = tomllib.loads((EXAMPLES / "catalogue-29.toml").read_text("utf-8"))
    needed = ["eccentricity_mm", "output_pin_length_mm", "youngs_modulus_gpa"]
    lines = (EXAMPLES / "catalogue-29.toml").read_text("utf-8").splitlines()
    kept = [line for line in lines if line.split(" =")[0] not in needed]
    assert len(lines) - len(kept) == 3
    assert set(needed) <= set(table)
    (tmp_path / "drive.toml").write_text("\n".join(kept))
    with pytest.raises(cs.InputError) as refused:
        cs.Drive.from_toml(tmp_path / "drive.toml")
    assert str(refused.value).endswith(f"drive.toml: {', '.join(needed)}: missing")
