"""From a study to a drive: the best variants, a drive file of one, files to begin with."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest

import cyclosweep as cs

STUDY = """
drive = "reference-87"
[sample]
method = "sobol"
count = 2000
seed = 3
[axes]
eccentricity_mm = { from = 0.4, to = 0.9 }
output_pin_count = { from = 6, to = 12 }
output_pin_diameter_mm = { from = 12, to = 24 }
[limits]
hole_web_mm = { min = 2.0 }
[objective]
maximise = "output_stiffness_nm_per_arcmin"
"""


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        capture_output=True, text=True, check=False, cwd=cwd,
    )  # fmt: skip


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a blank and an umlaut in its name, and a study in it."""
    folder = tmp_path_factory.mktemp("Wahl für Öl") / "ein Ordner"
    folder.mkdir()
    (folder / "study.toml").write_text(STUDY)
    cs.sink(cs.Study.from_toml(folder / "study.toml"), folder / "studie ü", rows_per_part=300)
    return folder


def feasible(made: Path) -> pl.DataFrame:
    return cs.scan_dataset(made / "studie ü").filter(status="ok").collect()


def test_best_variants_are_those_of_a_sort(made: Path) -> None:
    column = "output_stiffness_nm_per_arcmin"
    found = cs.best_variants(made / "studie ü", f"max {column}", rows=25)
    by_sort = feasible(made).sort([column, "variant"], descending=[True, False]).head(25)
    assert found.table.equals(by_sort)
    assert found.within == feasible(made).height
    assert "25 of" in repr(found)


def test_best_by_an_expression_within_limits(made: Path) -> None:
    text = "twist_1tn_deg * output_pin_count"
    found = cs.best_variants(made / "studie ü", text, ["hole_web_mm > 6", "active_pins_min > 3"])
    value = pl.col("twist_1tn_deg") * pl.col("output_pin_count")
    kept = feasible(made).filter(pl.col("hole_web_mm") > 6, pl.col("active_pins_min") > 3)
    assert found.within == kept.height
    wanted = kept.sort(value, "variant").head(10)["variant"]
    assert found.table["variant"].to_list() == wanted.to_list()
    assert text in found.table.columns


def test_ties_are_counted(made: Path) -> None:
    found = cs.best_variants(made / "studie ü", "output_pin_count", rows=2)
    assert found.ties == feasible(made).filter(output_pin_count=6).height > 2
    assert "share the best value" in repr(found)
    printed = run("best", "studie ü", "--minimise", "output_pin_count", cwd=made).stdout
    assert f"{found.ties} share the best value" in printed


def test_command_lists_writes_and_prints_json(made: Path, tmp_path: Path) -> None:
    plain = run("best", "studie ü", "--rows", "3", "--out", str(tmp_path / "a.xlsx"), cwd=made)
    assert plain.returncode == 0, plain.stderr
    assert "within the limits" in plain.stdout
    assert (tmp_path / "a.xlsx").exists()
    goals = "max output_stiffness_nm_per_arcmin, -least(hole_web_mm, 100)"
    command = ["best", "studie ü", "--json", "--rows", "1000", "--pareto", goals]
    front = json.loads(run(*command, "--limit", "eccentricity_mm < 0.8", cwd=made).stdout)
    table = cs.pareto_front(
        made / "studie ü",
        {"output_stiffness_nm_per_arcmin": "max", "hole_web_mm": "max"},
        "eccentricity_mm < 0.8",
    )
    assert sorted(row["variant"] for row in front["variants"]) == sorted(table["variant"])
    assert front["count"] == table.height


def test_picked_drive_evaluates_to_its_row(made: Path, tmp_path: Path) -> None:
    variant = int(feasible(made)["variant"][5])
    out = tmp_path / "gewählt.toml"
    result = run("pick", "studie ü", str(variant), "--out", str(out), "--name", "new", cwd=made)
    assert result.returncode == 0, result.stderr
    drive = cs.Drive.from_toml(out)
    assert drive.name == "new"
    row = cs.open_study(made / "studie ü").row(variant)
    for name, value in drive.evaluate().items():
        assert row[name] is value is None or float(row[name]) == value, name
    assert json.loads(run("show", str(out), "--json", cwd=made).stdout)["drives"][0]["results"]


def test_a_drive_that_was_edited_by_hand_is_not_overwritten(made: Path, tmp_path: Path) -> None:
    out = tmp_path / "mine.toml"
    out.write_text("# mine\n")
    refused = run("pick", "studie ü", "0", "--out", str(out), cwd=made)
    assert refused.returncode == 2
    assert f"{out} exists; --force replaces it" in refused.stderr
    assert out.read_text() == "# mine\n"
    assert run("pick", "studie ü", "0", "--out", str(out), "--force", cwd=made).returncode == 0
    cs.Drive.from_toml(out)


def test_an_infeasible_variant_is_written_with_its_status_said(made: Path, tmp_path: Path) -> None:
    frame = cs.scan_dataset(made / "studie ü").filter(pl.col("status") != "ok").collect()
    row = frame.row(0, named=True)
    result = run(
        "pick", "studie ü", str(row["variant"]), "--out", str(tmp_path / "x.toml"), cwd=made
    )
    assert result.returncode == 0
    assert row["status"] in result.stderr


def test_a_variant_below_zero_is_no_unknown_option(made: Path, tmp_path: Path) -> None:
    refused = run("pick", "studie ü", "-12", "--out", str(tmp_path / "x.toml"), cwd=made)
    assert refused.returncode == 2
    assert "found -12, expected a number that is not below zero" in refused.stderr
    assert refused.stderr.count("\n") == 1


@pytest.mark.parametrize("kind", ["drive", "study", "recording", "event"])
def test_templates_run_as_they_are(kind: str, tmp_path: Path) -> None:
    made = run("new", kind, "--out", f"{kind}.toml", cwd=tmp_path)
    assert made.returncode == 0, made.stderr
    assert (tmp_path / f"{kind}.toml").read_text("utf-8") == run("new", kind, cwd=tmp_path).stdout
    again = run("new", kind, "--out", f"{kind}.toml", cwd=tmp_path)
    assert (again.returncode, again.stdout) == (2, "")
    assert "exists already" in again.stderr
    commands = {
        "drive": ["show", "drive.toml"],
        "study": ["sweep", "study.toml", "--out", "out", "--rows", "100"],
        "recording": ["inspect", "recording.csv"],
        "event": ["shock", "reference-87", "event.toml", "--out", "out"],
    }
    if kind == "recording":
        torque = [10 * math.sin(k / 50) for k in range(1000)]
        angle = [28 * math.copysign(1, t) + 2.7 * t for t in torque]
        frame = pl.DataFrame({"torque_nm": torque, "angle_deg": angle})
        frame.write_csv(tmp_path / "recording.csv")
    result = run(*commands[kind], cwd=tmp_path)
    assert result.returncode == 0, result.stderr


def test_every_commented_key_of_the_drive_template_is_one(tmp_path: Path) -> None:
    text = run("new", "drive", cwd=tmp_path).stdout
    keys = re.findall(r"^# ([a-z0-9_]+ = [0-9].*)$", text, re.MULTILINE)
    assert len(keys) > 8
    for key in keys:
        (tmp_path / "drive.toml").write_text(text.replace("# " + key, key))
        assert cs.Drive.from_toml(tmp_path / "drive.toml").ratio == 39


BAD = {
    "no folder": (["best", "none"], "none: no such folder"),
    "no study": (["best", "."], "no study there"),
    "unknown objective": (["best", "S", "--minimise", "twist_1tn"], "did you mean twist_1tn_deg"),
    "two kinds": (["best", "S", "--minimise", "a", "--maximise", "b"], "expected one"),
    "one objective": (["best", "S", "--pareto", "hole_web_mm"], "expected two or more"),
    "unknown limit": (["best", "S", "--limit", "hole_web > 2"], "did you mean hole_web_mm"),
    "no condition": (["best", "S", "--limit", "hole_web_mm + 2"], "expected a comparison"),
    "ending": (["best", "S", "--out", "t.doc"], "found .doc, expected .csv"),
    "variant": (["pick", "S", "2000", "--out", "d.toml"], "no variant 2000, expected one from 0"),
    "negative": (["pick", "S", "-1", "--out", "d.toml"], "-1"),
    "no drive": (["pick", "S", "1", "--out", "z.txt"], "found z.txt, expected a drive file ending"),
    "new drive": (["new", "drive", "--out", "z.txt"], "found z.txt, expected a drive file ending"),
    "kind": (["new", "house"], "house"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line(case: str, made: Path) -> None:
    arguments, words = BAD[case]
    before = sorted(made.iterdir())
    found = run(*("studie ü" if text == "S" else text for text in arguments), cwd=made)
    assert (found.returncode, found.stdout) == (2, ""), found.stderr
    [line] = found.stderr.strip().splitlines()
    assert words in line
    assert sorted(made.iterdir()) == before


def test_a_reader_that_ends_early_is_no_error(made: Path) -> None:
    bash = shutil.which("bash")
    assert bash is not None
    command = f"'{sys.executable}' -m cyclosweep show reference-87 | head -1"
    found = subprocess.run([bash, "-c", command], capture_output=True, text=True, check=False)
    assert "Traceback" not in found.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="permissions of POSIX")
def test_a_folder_that_cannot_be_written_to(made: Path) -> None:
    target = "/proc/drive.toml"
    found = run("pick", "studie ü", "3", "--out", target, cwd=made)
    assert found.returncode == 2
    [line] = found.stderr.strip().splitlines()
    assert "/proc" in line
