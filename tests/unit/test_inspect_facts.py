"""What `inspect` says of directions, dwells and lengths."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.facts import facts_of
from cyclosweep.recording.inspection import inspect
from cyclosweep.recording.proposed import Known


def slack(offset_nm: float = -0.05) -> cs.Recording:
    """A strap that is pulled at constant speed and goes slack on the way back."""
    rng = np.random.default_rng(3)
    angle = np.r_[0:4:100j, 4:0:100j]
    torque = np.where(np.arange(200) < 100, 2.2 * angle, 3.0 * (angle - 1.1))
    torque = np.maximum(torque, offset_nm) + 0.02 * rng.normal(size=200)
    return cs.Recording.from_arrays(torque, angle, time_s=0.1 * np.arange(200), side="output")


@pytest.mark.parametrize(
    ("offset_nm", "words"), [(-0.05, "one direction"), (-3.0, "both directions")]
)
def test_an_offset_of_the_sensor_is_no_second_direction(offset_nm: float, words: str) -> None:
    assert words in facts_of(slack(offset_nm))["torque"]


def test_a_torque_that_stays_while_the_angle_goes_on_is_no_dwell() -> None:
    assert facts_of(slack())["dwells"] == "none"


def test_a_dwell_in_which_the_drive_creeps_stays_one() -> None:
    ramp = np.linspace(0.0, 8.0, 60)
    torque = np.r_[ramp, np.full(60, 8.0)] + 0.02 * np.random.default_rng(3).normal(size=120)
    creep = np.r_[np.zeros(60), 0.6 * (1 - np.exp(-np.arange(60) / 20.0))]
    angle = 0.5 * np.r_[ramp, np.full(60, 8.0)] + creep
    held = cs.Recording.from_arrays(torque, angle, time_s=np.arange(120.0), side="output")
    assert "at constant torque" in facts_of(held)["dwells"]


@pytest.mark.parametrize(
    ("header", "column", "unit", "scale"),
    [
        ("Torque [N m],Way [mm]", "Way [mm]", "mm", "0.573"),
        ("Torque,Way\nN m,cm", "Way", "cm", "5.73"),
        ("torque_nm,disp_mm", "disp_mm", "mm", "0.573"),
        # Names of an angle, too.
        ("Torque [N m],displacement [mm]", "displacement [mm]", "mm", "0.573"),
        ("Torque [N m],Position (mm)", "Position (mm)", "mm", "0.573"),
        ("Torque,Deflection\nN m,cm", "Deflection", "cm", "5.73"),
        ("torque_nm,displacement_mm", "displacement_mm", "mm", "0.573"),
    ],
)
def test_a_length_is_said_to_be_no_angle(
    tmp_path: Path, header: str, column: str, unit: str, scale: str
) -> None:
    path = tmp_path / "rig.csv"
    rows = "".join(f"{load:.3f},{0.3 * load:.4f}\n" for load in np.r_[0:10:40j, 10:0:40j])
    path.write_text(f"{header}\n{rows}")
    assumed = inspect(path, Known(), {}).proposal.assumed
    (said,) = (text for text in assumed if "holds a length" in text)
    assert said.startswith(f"{column} holds a length ({unit}), no angle")
    setting = f'angle_deg = {{ column = "{column}", scale = {scale} }}'
    assert setting in said
    # What it says is what reads the file.
    path.with_suffix(".toml").write_text(
        f'[columns]\ntorque_nm = "{header.split(",")[0]}"\n{setting}\n'
    )
    angle = cs.Recording.read(path).angle_deg
    assert angle is not None
    assert angle.max() == pytest.approx(float(scale) * 3.0)


def test_an_angle_is_found_beside_a_displacement(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    rows = "".join(f"{load},{0.3 * load},{load}\n" for load in range(20))
    path.write_text(f"Torque [N m],displacement [mm],position (in)\n{rows}")
    meta = inspect(path, Known(), {}).proposal.meta
    assert "position (in)" in str(meta["columns"]["angle_deg"])  # a word on the column, no inches


def test_a_length_beside_an_angle_is_no_matter(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    rows = "".join(f"{load},{0.1 * load},{load}\n" for load in range(20))
    path.write_text(f"torque_nm,angle_deg,way_mm\n{rows}")
    assert not any("length" in text for text in inspect(path, Known(), {}).proposal.assumed)
