"""Drives: files there and back, and one clear line for whatever is wrong in one."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from tests.drives import random_drives

GOOD = """
name = "mine"
ratio = 29
disc_count = 2
eccentricity_mm = 1.25
ring_pin_circle_radius_mm = 52.5
output_pin_count = 6
output_pin_circle_radius_mm = 34
output_pin_diameter_mm = 8.0
output_pin_length_mm = 20.0
disc_outer_radius_mm = 48.0
disc_bore_radius_mm = 15.0
youngs_modulus_gpa = 206.0
input_power_kw = 0.4
input_speed_rpm = 1000.0
output_torque_nm = 100.0

[[shaft]]
kind = "cylinder"
diameter_mm = 30.0
length_mm = 50.0

[[shaft]]
kind = "frustum"
diameter_mm = 35.0
end_diameter_mm = 50.0
length_mm = 10.0

[provenance]
ratio = "measured: counted by hand"
shaft_1_length_mm = "assumed"
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "drive.toml"
    path.write_text(text, encoding="utf-8")
    return path


def refusal(path: Path) -> str:
    with pytest.raises(cs.InputError) as caught:
        cs.Drive.from_toml(path)
    message = str(caught.value)
    assert "\n" not in message
    assert str(path) in message
    return message


def test_a_drive_file_is_read(tmp_path: Path) -> None:
    drive = cs.Drive.from_toml(written(tmp_path, GOOD))
    assert drive.name == "mine"
    assert drive.shaft[1] == cs.Frustum(diameter_mm=35.0, end_diameter_mm=50.0, length_mm=10.0)
    assert drive.provenance["ratio"] == "measured: counted by hand"
    assert drive.explain() is None
    assert cs.Drive.from_toml(written(tmp_path, "\ufeff" + GOOD)) == drive


def test_there_and_back(tmp_path: Path, reference: cs.Drive) -> None:
    for drive in [reference, *random_drives(7, 30)]:
        drive.to_toml(tmp_path / "copy.toml")
        assert cs.Drive.from_toml(tmp_path / "copy.toml") == drive


def test_the_reference_drive_marks_every_number(reference: cs.Drive) -> None:
    optional = {"output_stiffness_nm_per_arcmin", "criterion"}
    assert set(reference.inputs()) - set(reference.provenance) <= optional
    assert reference.explain() is None


# What is changed in the file, and what the line must name: key, found, expected.
WRONG: list[tuple[str, str, tuple[str, ...]]] = [
    ("ratio = 29", "ratoi = 29", ("ratio", "missing")),
    ("ratio = 29", "ratio = 29\neccentricity = 1", ("eccentricity", "unknown key")),
    ("ratio = 29", "ratio = 29.5", ("ratio", "29.5", "integer")),
    ("ratio = 29", "ratio = 29.0", ("ratio", "29.0", "integer")),
    ("ratio = 29", "ratio = 2", ("ratio", "2", "greater than or equal to 3")),
    ("ratio = 29", "ratio = true", ("ratio", "True", "integer")),
    ("ratio = 29", 'ratio = "29"', ("ratio", "'29'", "integer")),
    ("output_pin_count = 6", "output_pin_count = 65", ("output_pin_count", "65", "64")),
    ("eccentricity_mm = 1.25", 'eccentricity_mm = "1.25"', ("eccentricity_mm", "'1.25'", "number")),
    ("eccentricity_mm = 1.25", "eccentricity_mm = -1.25", ("eccentricity_mm", "-1.25", "than 0")),
    ("eccentricity_mm = 1.25", "eccentricity_mm = nan", ("eccentricity_mm", "nan")),
    ("eccentricity_mm = 1.25", "eccentricity_mm = inf", ("eccentricity_mm", "inf", "finite")),
    ("eccentricity_mm = 1.25", "eccentricity_mm = false", ("eccentricity_mm", "False", "number")),
    ("eccentricity_mm = 1.25", "eccentricity_mm = [1.25]", ("eccentricity_mm", "[1.25]", "number")),
    ("eccentricity_mm = 1.25\n", "", ("eccentricity_mm", "missing")),
    ("name =", "criterion = 'inner'\nname =", ("criterion", "'inner'", "published-map")),
    ('kind = "cylinder"', 'kind = "cone"', ("shaft.1", "cone", "keyway")),
    ('kind = "cylinder"\n', "", ("shaft.1", "kind")),
    ('kind = "cylinder"', 'kind = "keyway"', ("shaft.1", "keyway_depth_mm", "missing")),
    ("diameter_mm = 30.0", "diameter_mm = -30.0", ("shaft.1", "diameter_mm", "-30.0")),
    ("length_mm = 50.0", "length_mm = 50.0\nend_diameter_mm = 3", ("shaft.1", "end_diameter_mm")),
    ("diameter_mm = 35.0", 'diameter_mm = "35"', ("shaft.2", "diameter_mm", "'35'", "number")),
    ('shaft_1_length_mm = "assumed"', 'shaft_3_length_mm = "assumed"', ("shaft_3_length_mm",)),
    ('shaft_1_length_mm = "assumed"', 'shaft_1_length_mm = "guess"', ("guess", "published")),
    ("ratio = 29", "ratio = = 29", ("not valid TOML", "line 3")),
]


@pytest.mark.parametrize(("old", "new", "words"), WRONG)
def test_one_clear_line_for_what_is_wrong(
    tmp_path: Path, old: str, new: str, words: tuple[str, ...]
) -> None:
    assert old in GOOD
    message = refusal(written(tmp_path, GOOD.replace(old, new, 1)))
    for word in words:
        assert word in message, message


def test_neither_shaft_nor_stiffness(tmp_path: Path) -> None:
    scalars = GOOD[: GOOD.index("[[shaft]]")]
    assert "output_stiffness_nm_per_arcmin" in refusal(written(tmp_path, scalars))
    drive = cs.Drive.from_toml(
        written(tmp_path, scalars + "output_stiffness_nm_per_arcmin = 12.5\n")
    )
    assert drive.evaluate()["output_stiffness_nm_per_arcmin"] == pytest.approx(12.5, rel=1e-14)


def test_files_that_are_none(tmp_path: Path) -> None:
    assert "No such file" in refusal(tmp_path / "nowhere.toml")
    (tmp_path / "folder.toml").mkdir()
    assert "directory" in refusal(tmp_path / "folder.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    assert "UTF-8" in refusal(tmp_path / "bytes.toml")


def test_an_unknown_built_in_drive() -> None:
    with pytest.raises(cs.InputError, match="no such built-in drive, expected reference-87"):
        cs.Drive.load("reference-88")


def test_drives_are_frozen(reference: cs.Drive) -> None:
    with pytest.raises((ValueError, dataclasses.FrozenInstanceError)):
        reference.ratio = 3  # type: ignore[misc]


def test_replacing_drops_the_mark_of_what_changed(reference: cs.Drive) -> None:
    changed = reference.replace(eccentricity_mm=0.5, shaft_1_diameter_mm=49.0)
    assert changed.eccentricity_mm == 0.5
    assert changed.shaft[0].diameter_mm == 49.0
    dropped = set(reference.provenance) - set(changed.provenance)
    assert dropped == {"eccentricity_mm", "shaft_1_diameter_mm"}
    assert reference.eccentricity_mm == 0.62
    without = reference.replace(shaft=(), output_stiffness_nm_per_arcmin=9.0)
    assert not any(key.startswith("shaft_") for key in without.provenance)


@pytest.mark.parametrize("name", ["shaft_7_diameter_mm", "shaft_2_keyway_depth_mm", "eccentricity"])
def test_replacing_what_is_not_there(reference: cs.Drive, name: str) -> None:
    with pytest.raises(cs.InputError, match=f"{name}: no such input"):
        reference.replace(**{name: 1.0})


def test_a_drive_that_cannot_be_built_says_why(reference: cs.Drive) -> None:
    crowded = reference.replace(output_pin_count=20)
    assert "neighbouring holes overlap" in (crowded.explain() or "")
    with pytest.raises(cs.DesignError, match="neighbouring holes overlap"):
        crowded.evaluate()
    with pytest.raises(ValueError, match="reference-87"):
        crowded.evaluate()
    far = reference.replace(eccentricity_mm=90.0)
    with pytest.raises(cs.DesignError):
        far.active_pins()


def test_a_drive_s_line_is_its_twist(reference: cs.Drive) -> None:
    for drive in [reference, *random_drives(8, 40)]:
        twist = drive.evaluate((2.5,))["twist_2p5tn_deg"]
        if twist is None:
            assert drive.criterion == "statics"
            assert drive.disc_count > 2
            continue
        line = drive.nominal_line("input")
        torque = 2.5 * drive.nominal_torque_nm
        assert line.free_play_deg + line.compliance_deg_per_nm * torque == pytest.approx(
            twist, rel=1e-9
        )
        output = drive.nominal_line("output")
        assert output.free_play_deg == pytest.approx(line.free_play_deg / drive.ratio)
        assert output.compliance_deg_per_nm * drive.ratio**2 == pytest.approx(
            line.compliance_deg_per_nm
        )


def test_a_drive_alone_is_its_row_of_a_sweep(reference: cs.Drive) -> None:
    row = cs.sweep(cs.Space.grid(reference)).row(0, named=True)
    for name, value in reference.evaluate().items():
        assert row[name] == value or (value is None and row[name] is None)
    assert not any(isinstance(v, float) and math.isnan(v) for v in row.values())


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("ratio", np.int64(87)),
        ("disc_count", np.uint8(2)),
        ("output_pin_count", np.int32(8)),
        ("eccentricity_mm", np.float32(0.5)),
        ("input_inertia_kg_m2", np.float64(0.002)),
        ("free_play_deg", np.int16(28)),
        ("shaft_1_length_mm", np.int64(60)),
    ],
)
def test_numpy_numbers_are_numbers(reference: cs.Drive, name: str, value: np.generic) -> None:
    assert reference.replace(**{name: value}) == reference.replace(**{name: value.item()})


def test_a_drive_of_numpy_numbers_is_written_and_read_back(
    tmp_path: Path, reference: cs.Drive
) -> None:
    table = reference.model_dump()
    table["ratio"], table["eccentricity_mm"] = np.int64(87), np.float64(0.62)
    table["shaft"][0]["diameter_mm"] = np.float64(table["shaft"][0]["diameter_mm"])
    drive = cs.Drive(**table)
    assert type(drive.ratio) is int
    assert type(drive.eccentricity_mm) is float
    drive.to_toml(tmp_path / "copy.toml")
    assert cs.Drive.from_toml(tmp_path / "copy.toml") == reference


@pytest.mark.parametrize("value", [np.float64(87.0), np.bool_(True), np.str_("87"), np.array([87])])
def test_what_is_no_integer_stays_refused(reference: cs.Drive, value: object) -> None:
    with pytest.raises(cs.InputError, match=r"ratio: found .*, expected integer"):
        reference.replace(ratio=value)


@pytest.mark.parametrize("load", [math.nan, math.inf, True, "1", None])
def test_a_load_that_is_no_finite_number_is_one_line(reference: cs.Drive, load: Any) -> None:
    with pytest.raises(cs.InputError, match=r"^loads_tn: found .*, expected .*$"):
        reference.evaluate((1.0, load))
