"""Values that nothing can have are refused in one line: what was found, and what was expected."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.effect_value import EffectValue

NAN, INF = float("nan"), float("inf")
DRIVE = cs.Drive.reference_87()
TRAIN = DRIVE.train(load_inertia_kg_m2=5.0)
SPACE = cs.Space.grid(DRIVE, output_pin_count=[6, 8, 9])
LOAD = cs.Recording.from_arrays([0.0, 5.0, -2.0])
TORQUE = np.array([0.0, 5.0, 0.0, -5.0])


def refusal(call: Callable[[], object]) -> str:
    """Message of the refusal."""
    with pytest.raises(cs.InputError) as caught:
        call()
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("torque", [NAN, INF, -INF])
def test_no_mode_is_around_a_torque_that_is_no_number(torque: float) -> None:
    expected = f"torque_nm: found {torque:g}, expected a finite number"
    assert refusal(lambda: cs.modes(DRIVE, torque_nm=torque)) == expected
    assert refusal(lambda: cs.dimension_sensitivities(DRIVE, torque_nm=torque)) == expected
    assert refusal(lambda: TRAIN.modes(torque)) == expected
    assert refusal(lambda: TRAIN.stiffnesses_at(torque)) == expected


def test_modes_are_around_no_load_and_around_a_load_in_the_other_direction() -> None:
    nominal = cs.modes(DRIVE).frequencies_hz
    for torque in (0.0, -5.0):
        assert cs.modes(DRIVE, torque_nm=torque).frequencies_hz == pytest.approx(nominal)


@pytest.mark.parametrize("wrong", [NAN, INF, -INF])
@pytest.mark.parametrize(
    "name", ["compliance_deg_per_nm", "free_play_deg", "datum_deg", "torque_zero_nm"]
)
def test_a_model_has_finite_numbers(name: str, wrong: float) -> None:
    given = {"compliance_deg_per_nm": 2.7, "free_play_deg": 28.0, name: wrong}
    found = refusal(lambda: cs.Model(**given))  # type: ignore[arg-type]
    assert found == f"{name}: found {wrong}, expected a finite number"


def test_a_model_twists_with_its_torque(tmp_path: Path) -> None:
    for compliance in (0.0, -2.7):
        expected = f"compliance_deg_per_nm: found {compliance:g}, expected a number above zero"
        assert refusal(lambda c=compliance: cs.Model(c, 28.0)) == expected  # type: ignore[misc]
        effect = EffectValue("contact_stiffening", {"turn_nm": 3.0}, (1.0,))
        falls = cs.Model(compliance, 28.0, effects=(effect,))
        assert refusal(lambda m=falls: cs.simulate(m, LOAD)) == expected  # type: ignore[misc]
        (tmp_path / "model.json").write_text(falls.to_json())
        assert expected in refusal(lambda: cs.Model.from_json(tmp_path / "model.json"))
    found = refusal(lambda: cs.Model(2.7, -1.0))
    assert found == "free_play_deg: found -1, expected a number not below zero"
    assert cs.simulate(cs.Model(2.7, 0.0), LOAD).angle_deg is not None


@pytest.mark.parametrize(
    ("known", "expected"),
    [
        ({"angle_resolution_deg": -1}, "found -1, expected a step not below zero"),
        ({"angle_modulo_deg": -360}, "found -360, expected degrees above zero"),
        ({"angle_modulo_deg": 0.0}, "found 0, expected degrees above zero"),
        ({"angle_modulo_deg": NAN}, "found nan, expected a finite number"),
        ({"drive": 5}, "found 5, expected str or Path"),
        ({"reset_between_runs": "no"}, "found 'no', expected bool"),
        ({"holdout_runs": 5}, "found 5, expected a list of numbers of runs"),
        ({"conditioning_runs": ("a",)}, "found ('a',), expected a list of numbers of runs"),
        ({"conditioning_runs": (1.5,)}, "found (1.5,), expected a list of numbers of runs"),
    ],
)
def test_a_recording_is_known_by_what_can_be(known: dict[str, Any], expected: str) -> None:
    ((name, _),) = known.items()
    made = cs.Recording.from_arrays
    assert refusal(lambda: made(TORQUE, TORQUE * 2.7, **known)) == f"{name}: {expected}"


def test_numbers_of_runs_are_a_tuple_and_absent_ones_are_said() -> None:
    run = [0, 0, 1, 1]
    recording = cs.Recording.from_arrays(
        TORQUE, TORQUE * 2.7, run=run, conditioning_runs=np.array([0]), holdout_runs=[5]
    )
    assert recording.conditioning_runs == (0,)
    assert recording.holdout_runs == (5,)
    said = [fault.reason for fault in recording.faults if fault.kind == "run_absent"]
    assert said == ["holdout_runs names run 5, which has no samples."]


@pytest.mark.parametrize("key", ["angle_resolution_deg = -1", "columns.angle_deg.modulo = -360"])
def test_a_sidecar_states_no_less(tmp_path: Path, key: str) -> None:
    (tmp_path / "loop.csv").write_text("torque_nm,angle_deg\n0,0\n5,13\n")
    (tmp_path / "loop.toml").write_text(
        f'{key}\ncolumns.angle_deg.column = "angle_deg"\n' if "modulo" in key else f"{key}\n"
    )
    assert "loop.toml" in refusal(lambda: cs.Recording.read(tmp_path / "loop.csv"))
