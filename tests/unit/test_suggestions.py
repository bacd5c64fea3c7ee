"""A misspelt name is answered with the one that was meant, wherever names are given."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import cyclosweep as cs
from cyclosweep.errors import did_you_mean, one_of
from cyclosweep.recording.metadata import Metadata
from cyclosweep.simulation import effects

DRIVE = cs.Drive.reference_87()
SPACE = cs.Space.grid(DRIVE, output_pin_count=[8])


@pytest.mark.parametrize(
    ("found", "meant"),
    [
        ("eccentricty_mm", "eccentricity_mm"),
        ("Eccentricity-MM", "eccentricity_mm"),
        ("frequency", "natural_frequency_hz"),
        ("output pin count", "output_pin_count"),
    ],
)
def test_the_closest_name_is_suggested(found: str, meant: str) -> None:
    known = ["ratio", "eccentricity_mm", "natural_frequency_hz", "output_pin_count"]
    assert did_you_mean(found, known) == f", did you mean {meant}?"


@pytest.mark.parametrize(
    ("found", "meant"),
    [("E halvd", "E halved"), ("e halvd", "e halved"), ("E-HALVED", "E halved")],
)
def test_capitals_tell_names_apart_that_differ_in_nothing_else(found: str, meant: str) -> None:
    for known in (["E halved", "e halved"], ["e halved", "E halved"]):
        assert did_you_mean(found, known) == f", did you mean {meant}?"
    with pytest.raises(cs.InputError, match=rf"did you mean {meant}\?"):
        cs.validate(broken=found)


@pytest.mark.parametrize("found", ["", "xyz", "min", 7, None])
def test_nothing_is_suggested_for_what_is_far_from_every_name(found: object) -> None:
    assert did_you_mean(found, ["eccentricity_mm", "disc_minimum_mm"]) == ""


def test_no_known_names_give_no_suggestion() -> None:
    assert did_you_mean("ratio", []) == ""


def test_one_of_several_names_passes_through() -> None:
    assert one_of("side", "input", ("input", "output")) == "input"
    with pytest.raises(cs.InputError, match=r"side: found \['input'\], expected one of"):
        one_of("side", ["input"], {"input": 1, "output": 2})


def changed(**given: object) -> Callable[[], object]:
    """A call that changes the reference drive."""
    return lambda: DRIVE.replace(**given)


MISSPELT: dict[str, tuple[Callable[[], object], str]] = {
    "key": (changed(eccentricty_mm=1.0), "eccentricity_mm"),
    "segment": (changed(shaft_2_diamter_mm=1.0), "shaft_2_diameter_mm"),
    "criterion": (changed(criterion="statcs"), "statics"),
    "provenance": (changed(provenance={"ecentricity_mm": "assumed"}), "eccentricity_mm"),
    "mark": (changed(provenance={"eccentricity_mm": "asumed: x"}), "assumed"),
    "segment kind": (changed(shaft=[{"kind": "cylindr"}]), "cylinder"),
    "built-in drive": (lambda: cs.Drive.built_in("reference87"), "reference-87"),
    "drive file key": (
        lambda: cs.Drive.from_json({**DRIVE.model_dump(), "output_pincount": 8}),
        "output_pin_count",
    ),
    "side": (lambda: DRIVE.nominal_line("inptu"), "input"),  # type: ignore[arg-type]
    "engine": (lambda: DRIVE.loaded(engine="ful"), "full"),  # type: ignore[arg-type]
    "part of a train": (lambda: DRIVE.train(load_inertia=1.0), "load_inertia_kg_m2"),
    "node": (lambda: DRIVE.train(load_inertia_kg_m2=1.0).node("laod"), "load"),
    "axis": (lambda: cs.Space.grid(DRIVE, ecentricity_mm=[1.0]), "eccentricity_mm"),
    "axis value": (lambda: cs.Space.grid(DRIVE, criterion=["insde"]), "inside"),
    "model": (lambda: cs.Study.of(SPACE, model="component"), "components"),  # type: ignore[arg-type]
    "solver": (lambda: cs.scan(SPACE, solver="fulll"), "full"),  # type: ignore[arg-type]
    "limit": (lambda: cs.scan(SPACE, limits={"hole_wb_mm": (1.0, None)}), "hole_web_mm"),
    "objective": (
        lambda: cs.Study.of(SPACE, objective=cs.Objective("twist_1tn")),
        "twist_1tn_deg",
    ),
    "effect": (lambda: effects.find("crep"), "creep"),
    "keyword": (lambda: cs.Cylinder(diameter_mm=1.0, lenght_mm=1.0), "length_mm"),  # type: ignore[call-arg]
}


@pytest.mark.parametrize("place", MISSPELT)
def test_a_misspelt_name_is_answered_with_the_one_that_was_meant(place: str) -> None:
    call, meant = MISSPELT[place]
    with pytest.raises(cs.InputError) as caught:
        call()
    line = str(caught.value)
    assert "\n" not in line
    assert f"did you mean {meant}?" in line


def test_a_misspelt_attribute_of_a_drive_is_answered_too() -> None:
    with pytest.raises(AttributeError, match=r"eccentricty_mm: .*, did you mean eccentricity_mm\?"):
        DRIVE.eccentricty_mm  # type: ignore[attr-defined]  # noqa: B018


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("[axs]\n", "axes"),
        ("[sample]\nmethd = 'grid'\n", "method"),
        ("[sample]\nmethod = 'sobl'\n", "sobol"),
        ("[axes]\nratio = { values = [87] }\n[objective]\nminimize = 'x'\n", "minimise"),
        ("[limits]\nhole_web_mm = { mn = 2.0 }\n", "min"),
        ("[axes]\neccentricity_mm = { frm = 0.3, to = 0.8, steps = 5 }\n", "from"),
        ("[axes]\neccentricity_mm = { vals = [0.3] }\n", "values"),
    ],
)
def test_misspelt_keys_of_a_study_file(tmp_path: Path, text: str, meant: str) -> None:
    path = tmp_path / "study.toml"
    path.write_text(text)
    with pytest.raises(cs.InputError, match=rf"{meant}\?"):
        cs.Study.from_toml(path)


def test_misspelt_keys_of_other_files(tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text("angle_resolutoin_deg = 0.5\n")
    with pytest.raises(cs.InputError, match=r"did you mean angle_resolution_deg\?"):
        Metadata.read(path)
    path.write_text("kind = 'emergency-stop'\ndurations_s = 0.5\n")
    with pytest.raises(cs.InputError, match=r"did you mean duration_s\?"):
        cs.Event.from_toml(path)
