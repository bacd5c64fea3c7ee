"""The diagnosis on rigs whose answer is known."""

import json
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import Floats
from tests.support.bench_rig import record

EXAMPLES = Path(__file__).parents[2] / "examples" / "measured-13-to-1"
PRACTICE = {
    0: None,
    1: {"friction_hysteresis"},
    2: {"overload_softening"},
    3: {"datum_drift"},
    4: {"transmission_error"},
    5: set(),
    6: set(),
    7: {"clearance_takeup", "friction_hysteresis"},
    8: {"contact_stiffening"},
}


@pytest.fixture(scope="module")
def measured(shared_recordings: Path) -> Callable[[str], cs.Diagnosis]:
    """Diagnosis of a measured ramp by the end of its name; each is made once."""

    @cache
    def of(stem: str) -> cs.Diagnosis:
        (path,) = (shared_recordings / "cycloidal-13-to-1").glob(f"*{stem}.csv.gz")
        recording = cs.Recording.read(path, EXAMPLES / "recording.toml")
        return cs.diagnose(recording, cs.Drive.from_toml(EXAMPLES / "drive.toml"))

    return of


def diagnose(recording: cs.Recording, **known: Any) -> cs.Diagnosis:
    return cs.diagnose(recording, cs.Drive.reference_87(), **known)


@pytest.mark.shared
@pytest.mark.parametrize("case", sorted(PRACTICE))
def test_practice_recordings(case: int, shared_recordings: Path) -> None:
    folder = shared_recordings / "practice" / f"case-{case:03d}"
    found = cs.diagnose(cs.Recording.read(folder / "recording.csv"))
    truth = PRACTICE[case]
    if truth is None:
        assert found.verdict == "UNKNOWN_PHYSICS"
    elif not truth:
        assert found.verdict == "NOTHING_MISSING"
    else:
        sets = [set(e["effects"]) for e in found.content["explanation_set"]]
        assert truth in sets
        assert {e["name"] for e in found.effects} == truth


@pytest.mark.parametrize("family", ["white", "ar0.8", "t3", "outliers"])
@pytest.mark.parametrize("kind", ["rich", "poor"])
def test_nothing_missing_raises_no_alarm(family: str, kind: str) -> None:
    found = diagnose(record(11, kind=kind, family=family), full=False)
    assert found.verdict in ("NOTHING_MISSING", "INSUFFICIENT_DATA")


@pytest.mark.parametrize("sigma", [0.03, 0.2])
def test_half_degree_dial_raises_no_alarm(sigma: float) -> None:
    found = diagnose(record(12, kind="poor", sigma=sigma, step=0.5), full=False)
    assert found.verdict in ("NOTHING_MISSING", "INSUFFICIENT_DATA")


@pytest.mark.parametrize(
    "name",
    ["friction_hysteresis", "overload_softening", "creep", "viscous_drag", "thermal_drift"],
)
def test_single_effects_are_named_and_repaired(name: str) -> None:
    found = diagnose(record(21, (name,), d=25))
    assert found.verdict == "IDENTIFIED"
    assert [e["name"] for e in found.effects] == [name]
    content = found.content
    assert content["repaired"]["holdout_rmse_deg"] < content["baseline"]["holdout_rmse_deg"]
    assert content["repaired"]["holdout_rmse_deg"] == pytest.approx(0.2, rel=0.08)
    assert content["effects"][0]["e_value"] > 100


def test_a_sensor_at_its_limit_is_no_take_up_though_it_bends_at_two_thirds_of_the_range() -> None:
    found = [
        diagnose(record(seed, ("early_saturation",), d=12), full=False) for seed in range(41, 53)
    ]
    unknown = [f for f in found if f.verdict == "UNKNOWN_PHYSICS" and not f.effects]
    assert len(unknown) >= 11


@pytest.mark.parametrize("name", ["slip_event", "bump"])
def test_unknown_causes_get_no_name(name: str) -> None:
    found = diagnose(record(31, (name,), d=25))
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert found.effects == []
    assert found.content["unknown"]["place"]


def test_result_is_plain_json_and_repeats_itself() -> None:
    recording = record(41, ("contact_stiffening",), d=20, kind="medium")
    first, second = diagnose(recording, seed=3), diagnose(recording, seed=3)
    assert first.to_json() == second.to_json()
    content = json.loads(first.to_json())
    for key in [
        "schema",
        "tolerance_deg",
        "verdict",
        "statement",
        "noise",
        "baseline",
        "mismatch",
        "effects",
        "explanation_set",
        "ruled_out",
        "not_testable",
        "sufficiency",
        "repaired",
        "self_check",
        "next_experiment",
        "model",
    ]:
        assert key in content
    assert content["self_check"]["false_alarm"] <= 0.02


def test_calibration_is_not_missing_physics() -> None:
    rng = np.random.default_rng(5)
    torque = np.tile(np.r_[np.linspace(1, 25, 50), np.linspace(25, 1, 50)], 8)
    torque[400:] *= -1
    angle = 1.5 + 31 * np.sign(torque) + 3.4 * torque + 0.2 * rng.normal(size=len(torque))
    found = diagnose(cs.Recording.from_arrays(torque, angle, run=np.repeat(np.arange(8), 100)))
    assert found.effects == []
    baseline = found.content["baseline"]["parameters"]
    assert baseline["free_play_deg"]["estimate"] == pytest.approx(31, abs=0.1)
    assert baseline["compliance_deg_per_nm"]["estimate"] == pytest.approx(3.4, abs=0.01)


@pytest.mark.parametrize(
    ("factor", "word"), [(57.2958, "57.3"), (1000.0, "1000"), (7569.0, "squared"), (-1.0, "sign")]
)
def test_wrong_units_are_a_data_fault(factor: float, word: str) -> None:
    torque = np.tile([0.5, 2, 4, 6, 8, 10, 14, 18, 14, 10, 6, 2.0], 9)
    angle = factor * (28 + 2.73 * torque)
    found = diagnose(cs.Recording.from_arrays(torque, angle))
    assert found.verdict == "DATA_FAULT"
    assert word in found.statement


def test_a_dozen_hand_read_points() -> None:
    torque = np.array([0.5, 2, 4, 6, 8, 10, 14, 18, 14, 10, 6, 2])
    angle = np.round((28 + 2.73 * torque) * 2) / 2
    found = diagnose(cs.Recording.from_arrays(torque, angle, angle_resolution_deg=0.5))
    assert found.verdict in ("NOTHING_MISSING", "INSUFFICIENT_DATA")
    hidden = {entry["name"] for entry in found.content["not_testable"]}
    assert {"creep", "viscous_drag", "rig_compliance", "torque_offset"} <= hidden


def few_loads(
    loads: Floats,
    cycles: int,
    sigma: float,
    missing: Callable[[Floats, Floats], Floats],
    seed: int = 0,
) -> cs.Diagnosis:
    """Weights and a dial: the same few loads, up and down, on either flank."""
    rng = np.random.default_rng(seed)
    one = np.r_[loads, loads[::-1]]
    torque = np.tile(np.r_[one, -one], cycles).astype(float)
    run = np.repeat(np.arange(cycles), 2 * len(one))
    plain = 28 * np.sign(torque) + 2.73 * torque
    angle = plain + missing(torque, plain) + sigma * rng.normal(size=len(torque))
    return diagnose(cs.Recording.from_arrays(torque, angle, run=run), full=False)


def test_shape_that_few_loads_cannot_tell_costs_nothing() -> None:
    # Between two loads no kink can be placed: onset and range are one parameter.
    def takeup(torque: Floats, _: Floats) -> Floats:
        return -0.15 * np.sign(torque) * np.maximum(np.abs(torque) - 7.0, 0.0)

    found = few_loads(np.arange(2.0, 24.0, 3.0), 6, 0.1, takeup)
    assert found.verdict == "IDENTIFIED"
    assert [e["name"] for e in found.effects] == ["clearance_takeup"]


def test_direction_of_a_dial_that_two_loads_cannot_tell_costs_nothing() -> None:
    def dial(_: Floats, angle: Floats) -> Floats:
        return 1.5 * np.cos(np.radians(angle))

    found = few_loads(np.array([5.0, 20.0]), 10, 0.1, dial)
    sets = [set(e["effects"]) for e in found.content["explanation_set"]]
    assert {"dial_eccentricity"} in sets
    # What may still be the cause is not among what was ruled out.
    ruled_out = {entry["name"] for entry in found.content["ruled_out"]}
    assert not ruled_out & set().union(*sets)


@pytest.mark.shared
@pytest.mark.parametrize(
    ("stem", "limit"),
    [("base_runin1", 0.20), ("base_runin5", 0.12), ("conic_runin1", 0.18), ("cold5", 0.30)],
)
def test_measured_ramp_is_predicted_after_fitting_another(
    stem: str, limit: float, measured: Callable[[str], cs.Diagnosis]
) -> None:
    found = measured(stem)
    (block,) = found.content["repaired"]["blocks"]
    assert block["told_after_deg"] <= limit
    # The free forecast has to find the crossings of the dead zone too.
    assert block["after_deg"] <= 1.005 * limit
    assert block["after_deg"] == pytest.approx(found.content["repaired"]["holdout_rmse_deg"])
    names = {e["name"] for e in found.effects}
    assert "load_dependent_friction" in names


@pytest.mark.shared
def test_warm_drive_gives_no_stiffness(measured: Callable[[str], cs.Diagnosis]) -> None:
    found = measured("base910_unr_runin1")
    assert not found.content["stationary"]
    assert "unfit for a stiffness" in found.statement
    rows = {row["topic"]: row["text"] for row in found.content["findings"]}
    assert rows["stiffness"].startswith("Not reported: the loops drift")


@pytest.mark.shared
@pytest.mark.parametrize(("stem", "steady"), [("base_runin1", True), ("910_unr_runin1", False)])
def test_drift_shows_without_a_run_to_hold_out(
    stem: str, steady: bool, shared_recordings: Path, tmp_path: Path
) -> None:
    meta = (EXAMPLES / "recording.toml").read_text().replace("holdout_runs = [102]", "")
    (tmp_path / "recording.toml").write_text(meta)
    (tmp_path / "drive.toml").write_text((EXAMPLES / "drive.toml").read_text())
    (path,) = (shared_recordings / "cycloidal-13-to-1").glob(f"*{stem}.csv.gz")
    found = cs.diagnose(cs.Recording.read(path, tmp_path / "recording.toml"), full=False)
    assert found.content["stationary"] is steady


@pytest.mark.shared
def test_measured_loop_is_described_as_an_expert_would(
    measured: Callable[[str], cs.Diagnosis],
) -> None:
    found = measured("base_runin5")
    rows = {row["topic"]: row["text"] for row in found.content["findings"]}
    assert list(rows) == [
        "play",
        "friction hysteresis",
        "friction that grows with load",
        "stiffening",
        "stiffness",
        "staircase",
        "model error",
    ]
    assert "N m/arcmin at the output shaft, 95 % interval" in rows["stiffness"]
    hidden = {row["name"] for row in found.content["not_testable"]}
    assert {
        "independent_torque",
        "other_mesh_positions",
        "temperature",
        "loads_beyond_the_limit",
    } <= hidden
    assert "torque_offset" not in hidden
