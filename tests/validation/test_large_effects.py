"""Effects far above the noise: the right law, slightly off, is named beside what it misses."""

import json
from pathlib import Path
from typing import Any

import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.stages.stage import FAINT, error_factor
from cyclosweep_challenge import make_case


def diagnosed(folder: Path, seed: int, effects: tuple[str, ...], d: tuple[float, ...]) -> Any:
    """Content of the diagnosis of a recording of the challenge's rig, without proof."""
    case = make_case(seed, effects, d, "rich", sigma_deg=0.05, samples=2000)
    case.write(folder)
    recording = cs.Recording.read(folder / "recording.csv")
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.model is not None
    content = json.loads(found.to_json())
    content["model"] = [value.name for value in found.model.effects]
    return content


@pytest.fixture(scope="module")
def drag(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """A drag of d = 2000; against the noise alone it was unknown, without a name or a repair."""
    return diagnosed(tmp_path_factory.mktemp("drag"), 9021, ("viscous_drag",), (2000.0,))


def test_model_error_vanishes_where_the_mismatch_is_faint() -> None:
    assert error_factor(0.0) == 1.0
    assert error_factor(FAINT) == 1.0
    # However loud, a stage sees its mismatch at about the ratio at which naming is proved.
    assert 1000.0 / error_factor(1000.0) == pytest.approx(21.0, abs=0.5)


def test_a_large_effect_is_named_and_repaired(drag: Any) -> None:
    assert [each["name"] for each in drag["effects"]] == ["viscous_drag"]
    assert drag["model"] == ["viscous_drag"]
    assert drag["repaired"]["rmse_deg"] < 0.15 * drag["baseline"]["rmse_deg"]


def test_most_is_explained_says_how_much_and_what_is_left(drag: Any) -> None:
    assert drag["verdict"] == "MOSTLY_EXPLAINED"
    low, high = drag["explained"]["ci95"]
    assert 0.9 <= low <= drag["explained"]["share"] <= high <= 1.0
    assert drag["unknown"]["size_deg"] > drag["noise"]["sigma_deg"] / 10
    assert "viscous drag" in drag["statement"]


def test_what_rides_on_a_large_friction_is_found_in_the_next_stage(tmp_path: Path) -> None:
    # Against the noise alone: thermal drift alone, and the error larger with it than without.
    effects = ("load_dependent_friction", "thermal_drift")
    found = diagnosed(tmp_path, 9507, effects, (800.0, 60.0))
    assert found["verdict"] in ("IDENTIFIED", "MOSTLY_EXPLAINED")
    assert {each["name"] for each in found["effects"]} == set(effects)
    assert found["repaired"]["rmse_deg"] < 0.06
