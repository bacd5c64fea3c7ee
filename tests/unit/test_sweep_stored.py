"""A study on disk opened to choose from: its rows, its summary, the drive of a variant."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import cyclosweep as cs


@pytest.fixture
def space() -> cs.Space:
    return cs.Space.grid(
        cs.Drive.reference_87(),
        eccentricity_mm=cs.linspace(0.5, 0.9, 9),
        output_pin_count=[6, 8, 9],
        shaft_2_diameter_mm=[54.0, 55.0],
    )


def test_summary_and_rows_are_those_of_the_sweep(tmp_path: Path, space: cs.Space) -> None:
    objective = cs.Objective("hole_web_mm", maximise=True)
    swept = cs.sink(space, tmp_path / "größe 1", objective=objective, rows_per_part=7)
    study = cs.open_study(tmp_path / "größe 1")
    assert study.summary == swept
    assert study.complete
    assert study.frame.collect().equals(cs.sweep(space))
    assert study.axes == ("eccentricity_mm", "output_pin_count", "shaft_2_diameter_mm")
    assert study.drive == cs.Drive.reference_87()
    assert (study.model, study.loads_tn) == ("published", (1, 2, 3, 4, 4.5))
    assert "54 variants" in repr(study)


def test_drive_of_a_variant_gives_its_row_again(tmp_path: Path, space: cs.Space) -> None:
    cs.sink(space, tmp_path)
    study = cs.open_study(tmp_path)
    feasible = study.frame.filter(status="ok").collect()["variant"].to_list()
    for variant in feasible[::7]:
        study.drive_of(variant).to_toml(tmp_path / "drive.toml")
        drive = cs.Drive.from_toml(tmp_path / "drive.toml")
        row = study.row(variant)
        for name, value in drive.evaluate().items():
            assert row[name] is value is None or float(row[name]) == value, name
        assert drive.provenance["eccentricity_mm"].startswith(f"derived: variant {variant} of")
        assert drive.provenance["ratio"].startswith("published")


def test_drive_of_a_variant_of_the_component_model(tmp_path: Path) -> None:
    drive = cs.Drive.from_toml(Path(__file__).parents[2] / "examples" / "components-87.toml")
    space = cs.Space.grid(drive, ring_pin_radius_mm=[2.0, 2.2], friction_ring=[0.0, 0.05])
    cs.sink(space, tmp_path, model="components")
    study = cs.open_study(tmp_path)
    assert study.model == "components"
    assert study.drive_of(3).ring_pin_radius_mm == 2.2
    again = cs.Space.grid(study.drive_of(3))
    found = cs.sweep(again, model="components").row(0, named=True)
    row = study.row(3)
    assert {name: row[name] for name in found if name != "variant"} == {
        name: value for name, value in found.items() if name != "variant"
    }


def test_a_study_of_before_has_its_numbers_without_marks(tmp_path: Path) -> None:
    drive = cs.Drive.from_toml(Path(__file__).parents[2] / "examples" / "components-87.toml")
    cs.sink(cs.Space.grid(drive, output_pin_count=[6, 8]), tmp_path, model="components")
    [path] = tmp_path.glob("*manifest.json")
    manifest = json.loads(path.read_text("utf-8"))
    del manifest["drive"], manifest["objective"]
    path.write_text(json.dumps(manifest), encoding="utf-8")
    found = cs.open_study(tmp_path).drive
    assert found.values() == pytest.approx(drive.values(), nan_ok=True)
    assert found.part_definition() == drive.part_definition()


def test_what_is_no_study_is_refused(tmp_path: Path, space: cs.Space) -> None:
    with pytest.raises(cs.InputError, match="no such folder, expected the folder of a study"):
        cs.open_study(tmp_path / "none")
    with pytest.raises(cs.InputError, match="no study there"):
        cs.open_study(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(cs.InputError, match="is a file"):
        cs.open_study(tmp_path / "file")
    cs.sink(space, tmp_path)
    with pytest.raises(cs.InputError, match="no variant 54, expected one from 0 to 53"):
        cs.open_study(tmp_path).row(54)
    [path] = tmp_path.glob("*manifest.json")
    path.write_text('{"drive": {}}', encoding="utf-8")
    with pytest.raises(cs.InputError, match="manifest is damaged"):
        cs.open_study(tmp_path)


@pytest.mark.parametrize(
    ("content", "found"),
    [(None, "missing"), ("{", "holds no JSON object"), ("[1]", "holds no JSON object")],
)
def test_a_study_without_its_manifest_names_the_file(
    tmp_path: Path, content: str | None, found: str
) -> None:
    space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8])
    cs.sink(space, tmp_path)
    manifest = tmp_path / "_manifest.json"
    manifest.unlink()
    if content is not None:
        manifest.write_text(content)
    with pytest.raises(cs.InputError) as caught:
        cs.open_study(tmp_path)
    assert str(caught.value).startswith(f"{manifest}: {found}, expected")
    assert "\n" not in str(caught.value)
    cs.sink(space, tmp_path)
    assert cs.open_study(tmp_path).rows == 2
