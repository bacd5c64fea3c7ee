"""Drives side by side: their numbers, their compliance by parts, what to be careful about."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from pathlib import Path

import polars as pl
import pytest

import cyclosweep as cs
from cyclosweep.choose.comparison import DriveFigures

ROOT = Path(__file__).parents[2]
COMPONENTS = ROOT / "examples" / "components-87.toml"


def test_published_budget_sums_to_the_whole_and_names_the_segments() -> None:
    drive = cs.Drive.reference_87()
    [figures] = cs.compare(drive).figures
    total = sum(item.compliance_arcmin_per_nm for item in figures.published)
    arcmin = math.pi / 10_800
    assert total * arcmin == pytest.approx(drive.evaluate()["output_compliance_rad_per_nm"])
    assert sum(item.share for item in figures.published) == pytest.approx(1)
    assert [item.part for item in figures.published][:2] == [
        "shaft segment 1, keyway",
        "shaft segment 2, cylinder",
    ]
    # Eq. (4) by hand for a plain segment: 32 l / (pi G D^4).
    segment = drive.shaft[1]
    shear = drive.youngs_modulus_gpa * 1e9 / (2 * (1 + drive.poisson_ratio))
    by_hand = 32 * segment.length_mm * 1e-3 / (math.pi * shear * (segment.diameter_mm * 1e-3) ** 4)
    assert figures.published[1].compliance_arcmin_per_nm * arcmin == pytest.approx(by_hand)
    assert figures.published[1].stiffness_nm_per_arcmin == pytest.approx(arcmin / by_hand)


def test_budget_of_a_given_stiffness_is_one_item() -> None:
    drive = cs.Drive.reference_87().replace(output_stiffness_nm_per_arcmin=50.0)
    [figures] = cs.compare(drive).figures
    [item] = figures.published
    assert item.stiffness_nm_per_arcmin == pytest.approx(50.0)


def test_component_budget_sums_to_the_loaded_twist() -> None:
    drive = cs.Drive.from_toml(COMPONENTS)
    [figures] = cs.compare([COMPONENTS]).figures
    whole = sum(item.compliance_arcmin_per_nm for item in figures.components)
    twist = figures.results["loaded_twist_arcmin"]
    assert twist is not None
    assert whole * drive.output_torque_nm == pytest.approx(twist, rel=1e-9)
    assert max(figures.components, key=lambda item: item.share).part == "clearances taken up"


def test_table_has_a_column_for_each_drive_and_names_differ() -> None:
    drive = cs.Drive.reference_87()
    found = cs.compare([drive, drive.replace(eccentricity_mm=0.7), COMPONENTS])
    assert found.table.columns == [
        "kind", "key", "unit", "meaning", "reference-87", "reference-87 (2)", "components-87",
    ]  # fmt: skip
    row = found.table.filter(key="eccentricity_mm").row(0, named=True)
    assert (row["unit"], row["reference-87"], row["reference-87 (2)"]) == ("mm", 0.62, 0.7)
    efficiency = found.results.filter(key="efficiency")
    assert efficiency["reference-87"][0] is None
    assert efficiency["components-87"][0] > 0.5
    assert "Comparison of reference-87, reference-87 (2), components-87" in repr(found)
    assert "eccentricity" in found._repr_html_() or "active_pins_mean" in found._repr_html_()
    content = json.loads(found.to_json())
    assert [each["label"] for each in content["drives"]] == found.table.columns[4:]


def remarks(figures: DriveFigures, level: str) -> str:
    return "; ".join(remark.text for remark in figures.remarks if remark.level == level)


def test_an_efficiency_above_one_and_assumed_numbers_are_said() -> None:
    drive = cs.Drive.reference_87()
    [good, greedy, alone] = cs.compare(
        [drive, drive.replace(output_torque_nm=700.0), drive.model_copy(update={"provenance": {}})]
    ).figures
    assert "efficiency above one" not in remarks(good, "warning")
    assert "assumed are 27 of its numbers: eccentricity_mm" in remarks(good, "warning")
    assert "efficiency above one: 700 N m at the output is 1.11 times" in remarks(greedy, "warning")
    assert "none of its numbers has a mark" in remarks(alone, "note")


def test_only_numbers_that_are_there_are_said_to_have_no_mark(tmp_path: Path) -> None:
    reference = cs.Drive.reference_87()
    changed = reference.replace(eccentricity_mm=0.5)
    space = cs.Space.grid(reference, eccentricity_mm=[0.5])
    bare = cs.Drive.from_toml(COMPONENTS).model_dump(exclude_none=True, exclude={"provenance"})
    minimal = cs.Drive(
        **{key: value for key, value in bare.items() if key != "bush_wall_mm"},
        provenance={"ratio": "measured"},
    )
    for drive in (changed, space[0]):
        said = remarks(cs.compare(drive).figures[0], "note")
        assert "without a mark of their origin: eccentricity_mm" in said
        assert said.partition("origin: ")[2].partition(";")[0] == "eccentricity_mm"
    for drive in (reference, changed, minimal, minimal.replace(eccentricity_mm=0.5)):
        file = tmp_path / "drive.toml"
        drive.to_toml(file)
        again = cs.compare(cs.Drive.from_toml(file)).figures[0]
        assert again.remarks == cs.compare(drive).figures[0].remarks
        assert "bush_wall_mm" not in remarks(again, "note").partition("origin: ")[2]


def test_yielding_pins_are_said() -> None:
    weak = cs.Drive.from_toml(COMPONENTS).replace(pin_yield_strength_mpa=100.0)
    [figures] = cs.compare(weak).figures
    assert "output pins yield at their roots: 1.53 times" in remarks(figures, "warning")


def test_what_stands_in_for_numbers_left_out_is_said() -> None:
    drive = cs.Drive.from_toml(COMPONENTS).replace(friction_ring=None, pin_yield_strength_mpa=None)
    said = remarks(cs.compare(drive).figures[0], "note")
    _, found, numbers = said.partition("rest on what stands in for numbers left out: ")
    assert found
    assert "friction_ring 0.05" in numbers
    assert "pin_yield_strength_mpa 750" in numbers
    assert "disc_3_reach_mm" not in numbers
    given = cs.compare(drive.replace(friction_ring=0.04)).figures[0]
    assert "friction_ring" not in remarks(given, "note").partition("left out: ")[2]
    assert "left out" not in remarks(cs.compare(cs.Drive.reference_87()).figures[0], "note")


def test_a_drive_that_cannot_be_built_is_shown_with_the_reason() -> None:
    drive = cs.Drive.reference_87()
    found = cs.compare([drive, drive.replace(output_pin_diameter_mm=60.0)])
    assert "cannot be built: neighbouring holes overlap" in remarks(found.figures[1], "error")
    assert found.results.filter(key="twist_1tn_deg").row(0)[-1] is None


def run(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    import os

    return subprocess.run(
        [sys.executable, "-m", "cyclosweep", *arguments],
        capture_output=True, text=True, check=False, env={**os.environ, **environment},
    )  # fmt: skip


def test_show_prints_numbers_budget_and_warnings(tmp_path: Path) -> None:
    own = tmp_path / "größe 2.toml"
    cs.Drive.reference_87().replace(eccentricity_mm=0.7).to_toml(own)
    found = run("show", "reference-87", str(own), NO_COLOR="1", COLUMNS="60")
    assert found.returncode == 0, found.stderr
    assert "output pins, bending and shear" in found.stdout
    assert "N m/arcmin" in found.stdout
    assert "assumed are 27" in found.stdout
    assert "\x1b" not in found.stdout
    content = json.loads(run("show", str(own), "--json").stdout)
    assert content["schema"] == "cyclosweep.comparison/1"
    for ending in ("csv", "xlsx", "parquet"):
        table = tmp_path / f"table.{ending}"
        assert run("show", "reference-87", "--out", str(table)).returncode == 0
        assert table.exists()
    frame = pl.read_parquet(tmp_path / "table.parquet")
    assert frame.filter(key="output_stiffness_nm_per_arcmin").height == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["reference-88"], "did you mean reference-87"),
        (["none.toml"], "none.toml: No such file"),
        (["reference-87", "--out", "table.doc"], "table.doc: found .doc, expected .csv"),
        ([], "DRIVE"),
    ],
)
def test_bad_input_is_one_line(arguments: list[str], words: str) -> None:
    found = run("show", *arguments)
    assert found.returncode == 2
    assert found.stdout == ""
    [line] = found.stderr.strip().splitlines()
    assert words in line
