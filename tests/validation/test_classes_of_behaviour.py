"""A law is named where it stands for its class of behaviour; else the answer says the class."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    EVEN_CURVE,
    LOOP,
    ODD_CURVE,
    OPENING_LOOP,
    RELAXATION,
    class_columns,
    smooth_columns,
)
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.simulation.effects.history import History
from cyclosweep_challenge.second_generator.case import make_numbered


def diagnosed(folder: Path, tier: str, number: int) -> dict[str, Any]:
    """Content of the diagnosis of a recording of the second generator, made with seed 3101.

    With the model's effects and notes, and the true effects.
    """
    case = make_numbered(tier, number, 3101, 3000)
    case.write(folder)
    without = [case.truth["removed"]] if case.truth.get("removed") else []
    found = cs.diagnose(cs.Recording.read(folder / "recording.csv"), full=False, without=without)
    assert found.model is not None
    content: dict[str, Any] = json.loads(found.to_json())
    content["in the model"] = [value.name for value in found.model.effects]
    content["at work"] = case.truth["effects"]
    return content


def test_a_look_alike_of_a_deleted_cause_is_not_named(tmp_path: Path) -> None:
    # Load asymmetry is not in the library; the dial takes its place at less than an even curve.
    found = diagnosed(tmp_path, "deleted", 6)
    assert found["at work"] == ["load_asymmetry"]
    assert found["verdict"] == "UNKNOWN_PHYSICS"
    assert found["effects"] == []
    assert [each["behaviour"] for each in found["classes"]] == [EVEN_CURVE]
    assert found["classes"][0]["laws"] == []
    assert found["classes"][0]["stand_ins"] == ["dial_eccentricity"]
    assert found["unknown"]["shape"] == EVEN_CURVE
    assert f"an {EVEN_CURVE}" in found["statement"]
    # The model predicts better with the stand-in, and says that it is one.
    assert found["in the model"] == ["dial_eccentricity"]
    assert "stand-in" in " ".join(found["notes"])
    assert found["repaired"]["rmse_deg"] < found["baseline"]["rmse_deg"]
    undecided = {bound["name"] for bound in (*found["undecided"], *found["ruled_out"])}
    assert "dial_eccentricity" in undecided


def test_three_look_alikes_of_a_loud_curve_are_not_named(tmp_path: Path) -> None:
    # Without load asymmetry a dial and two effects of the position of the mesh leave only noise.
    found = diagnosed(tmp_path, "deleted", 19)
    assert found["verdict"] == "UNKNOWN_PHYSICS"
    assert found["effects"] == []
    assert EVEN_CURVE in [each["behaviour"] for each in found["classes"]]


def test_a_law_that_holds_is_named_with_its_class(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, "single", 5)
    assert [each["name"] for each in found["effects"]] == found["at work"] == ["overload_softening"]
    assert found["verdict"] == "IDENTIFIED"
    (shown,) = found["classes"]
    assert (shown["behaviour"], shown["laws"]) == (ODD_CURVE, ["overload_softening"])
    assert shown["missed_share"] < 0.05


@pytest.mark.parametrize("number", [4, 8])
def test_few_readings_that_fit_several_laws_are_insufficient(tmp_path: Path, number: int) -> None:
    # Take-up and stiffening were two nats apart, and the named one was the wrong one.
    # In the second a shape without a name is half a nat ahead of both.
    found = diagnosed(tmp_path, "C9", number)
    assert found["verdict"] == "INSUFFICIENT_DATA"
    assert found["effects"] == found["in the model"] == []
    listed = {name for each in found["explanation_set"] for name in each["effects"]}
    assert set(found["at work"]) <= listed <= {"contact_stiffening", "clearance_takeup"}
    (shown,) = found["classes"]
    assert shown["behaviour"] == ODD_CURVE
    assert "so few readings cannot tell" in found["statement"]


def test_few_readings_that_fit_one_law_name_it(tmp_path: Path) -> None:
    found = diagnosed(tmp_path, "C9", 5)
    assert [each["name"] for each in found["effects"]] == found["at work"] == ["overload_softening"]


def test_smooth_columns_have_the_covariance_of_a_cubic_spline() -> None:
    share = np.linspace(0.0, 1.0, 25) ** 1.5
    columns = smooth_columns(share)
    low, high = np.minimum.outer(share, share), np.maximum.outer(share, share)
    assert columns @ columns.T == pytest.approx(low**2 * (3 * high - low) / 2, abs=1e-6)


def test_columns_of_a_class_are_what_its_name_says() -> None:
    rise = np.linspace(1.0, 20.0, 60)
    torque = np.r_[rise, rise[::-1], -rise, -rise[::-1]]
    count = len(torque)
    history = History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=torque,
        side=np.sign(torque),
        run=np.zeros(count, dtype=np.int64),
        restart=np.arange(count) == 0,
        compliance_deg_per_nm=1.0,
        free_play_deg=0.0,
    )
    columns = class_columns(history)
    assert RELAXATION not in columns
    up, down = slice(0, 60), slice(60, 120)
    other = slice(120, 180)
    for name, sign in ((ODD_CURVE, -1.0), (EVEN_CURVE, 1.0)):
        assert columns[name][up] == pytest.approx(columns[name][down][::-1], abs=1e-12)
        assert columns[name][other] == pytest.approx(sign * columns[name][up], abs=1e-12)
    opened = columns[OPENING_LOOP][:, -1]
    width = opened[up] - opened[down][::-1]
    # At the peak itself the torque still rises.
    assert width[:-1] == pytest.approx(2 * rise[:-1] / 20.0)
    constant = columns[LOOP][:, -1]
    assert np.ptp((constant[up] - constant[down][::-1])[:-1]) == pytest.approx(0.0)


def test_evidence_of_a_class_is_that_of_its_marginal_likelihood() -> None:
    rng = np.random.default_rng(5)
    columns, residual = rng.normal(size=(200, 3)), rng.normal(size=200)
    residual = residual + 2.0 * columns[:, 0]
    known = np.linalg.qr(rng.normal(size=(200, 2)))[0]
    residual = residual - known @ (known.T @ residual)
    found = ClassColumns({"any": columns}, 1e9).evidence("any", known, residual)
    inner = columns - known @ (known.T @ columns)

    def log_likelihood(variance: float) -> float:
        covariance = np.eye(200) + variance * inner @ inner.T
        return -0.5 * float(
            np.linalg.slogdet(covariance)[1] + residual @ np.linalg.solve(covariance, residual)
        )

    best = max(log_likelihood(v) for v in np.geomspace(1e-3, 1e3, 400)) - log_likelihood(0.0)
    assert found.evidence == pytest.approx(best, abs=0.05)
    nothing = ClassColumns({"any": columns}, 1e9).evidence("any", known, 0.0 * residual)
    assert nothing.evidence == 0.0
