"""Forward model: both directions, files, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.simulate import EffectValue
from tests.support.arrays import present

C = 19.8 / 7.2575


def loops(**known: Any) -> cs.Recording:
    path = np.concatenate(
        [np.linspace(0, 20, 60), np.linspace(20, -20, 120), np.linspace(-20, 8, 90)]
    )
    return cs.Recording.from_arrays(path, time_s=np.arange(len(path)) * 1.0, **known)


def full_model() -> cs.Model:
    return cs.Model(
        compliance_deg_per_nm=C,
        free_play_deg=28.0,
        datum_deg=0.4,
        effects=(
            EffectValue(
                "friction_hysteresis", {"slip_deg": 1.0, "scatter": 0.6, "slack": 0.0}, (0.5,)
            ),
            EffectValue("overload_softening", {"onset_nm": 12.0, "power": 2.0}, (0.8,)),
            EffectValue("creep", {"time_constant_s": 20.0}, (0.05,)),
        ),
        drive="reference-87",
    )  # fmt: skip


def test_published_line_with_the_angle_at_the_last_contact() -> None:
    drive = cs.Drive.reference_87()
    line = drive.nominal_line("input")
    angle = cs.simulate(drive, cs.Recording.from_arrays([7.0, 0.0, -7.0, 0.0])).angle_deg
    swing = 7.0 * line.compliance_deg_per_nm
    play = line.free_play_deg
    np.testing.assert_allclose(present(angle), [play + swing, play, -play - swing, -play])


def test_torque_and_angle_are_inverse() -> None:
    programme = loops()
    model = full_model()
    there = cs.simulate(model, programme)
    back = cs.simulate(model, there, predict="torque")
    clear = np.abs(programme.torque_nm) > 2.0
    difference = np.abs(back.torque_nm - programme.torque_nm)[clear]
    assert np.quantile(difference, 0.95) < 0.02


def test_loop_is_as_wide_as_friction_times_compliance() -> None:
    model = cs.Model(
        compliance_deg_per_nm=C,
        free_play_deg=28.0,
        effects=(EffectValue("friction_hysteresis", {"slip_deg": 0.2, "scatter": 0.3}, (0.5,)),),
    )
    programme = loops()
    angle = present(cs.simulate(model, programme).angle_deg)
    up = np.interp(10.0, programme.torque_nm[:60], angle[:60])
    down = np.interp(-10.0, -programme.torque_nm[60:180], angle[60:180])
    assert down - up == pytest.approx(2 * 0.5 * C, rel=1e-3)


def test_model_file_keeps_everything(tmp_path: Path) -> None:
    model = full_model()
    path = tmp_path / "model.json"
    path.write_text(model.to_json())
    again = cs.Model.from_json(path)
    np.testing.assert_allclose(
        present(cs.simulate(again, loops()).angle_deg),
        present(cs.simulate(model, loops()).angle_deg),
    )


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("{", "cannot be read"),
        ("[]", "schema"),
        ('{"schema": "cyclosweep.model/1"}', "not a model"),
        (
            json.dumps(
                {
                    "schema": "cyclosweep.model/1",
                    "baseline": {"compliance_deg_per_nm": 1, "free_play_deg": 1},
                    "effects": [{"name": "witchcraft", "amplitudes": {}}],
                }
            ),
            "witchcraft",
        ),
    ],
)
def test_bad_model_file_is_one_line(tmp_path: Path, text: str, what: str) -> None:
    path = tmp_path / "model.json"
    path.write_text(text)
    with pytest.raises(cs.InputError, match=what) as error:
        cs.Model.from_json(path)
    assert "\n" not in str(error.value)


def test_missing_column_is_named() -> None:
    model = full_model()
    with pytest.raises(cs.InputError, match="time_s"):
        cs.simulate(model, cs.Recording.from_arrays([1.0, 2.0, 3.0]))


def test_wrong_side_is_refused() -> None:
    with pytest.raises(cs.InputError, match="side"):
        cs.simulate(full_model(), loops(side="output"))
