"""Remarks on a compliance, play or datum far from the drive file."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.mistakes import likely_mistakes
from cyclosweep_challenge import make_case


def recorded(
    torque_factor: float = 1.0,
    angle_factor: float = 1.0,
    *,
    play_deg: float = 27.0,
    compliance: float = 2.8,
    offset_deg: float = 1.0,
) -> cs.Diagnosis:
    """Diagnose a loop of both directions that was read with wrong units."""
    rng = np.random.default_rng(3)
    torque = np.tile(np.r_[1:9:40j, 9:1:40j, -1:-9:40j, -9:-1:40j], 2)
    angle = offset_deg + np.sign(torque) * play_deg + compliance * torque
    angle += 0.1 * rng.normal(size=len(torque))
    recording = cs.Recording.from_arrays(torque * torque_factor, angle * angle_factor)
    return cs.diagnose(recording, cs.Drive.reference_87(), full=False)


def test_a_file_in_lbf_in_is_remarked_on_before_anything_else() -> None:
    found = recorded(torque_factor=8.85)
    assert found.verdict != "DATA_FAULT"
    (doubt,) = found.content["plausibility"]
    assert doubt["quantity"] == "compliance"
    assert doubt["factor"] == pytest.approx(1 / 8.85 * 2.8 / 2.728, rel=0.02)
    assert doubt["suggests"] == ["the torque is in lbf in and was read as N m (factor 8.85)"]
    assert found.statement.startswith("Check first: the compliance is 0.116 times")


def test_another_drives_file_is_remarked_on() -> None:
    drive = cs.Drive.reference_87().replace(free_play_deg=3.0)
    rng = np.random.default_rng(4)
    torque = np.tile(np.r_[1:9:40j, 9:1:40j, -1:-9:40j, -9:-1:40j], 2)
    angle = np.sign(torque) * 27 + 1.83 * 2.728 * torque + 0.1 * rng.normal(size=len(torque))
    found = cs.diagnose(cs.Recording.from_arrays(torque, angle), drive, full=False)
    quantities = {doubt.quantity: doubt for doubt in found.answer.plausibility}
    assert "the file is another drive's" in quantities["free_play"].suggests
    assert "another drive" in found.statement


@pytest.mark.parametrize(
    ("factor", "unit", "not_said"),
    [(17.453, "mrad", "57.3"), (60.0, "arcmin", "57.3"), (1 / 57.2958, "rad", "turns")],
)
def test_the_angle_unit_is_not_mistaken_for_another(
    factor: float, unit: str, not_said: str
) -> None:
    found = recorded(angle_factor=factor)
    assert found.verdict == "DATA_FAULT"
    assert f"the angle is in {unit} " in found.statement
    assert not_said not in found.statement or unit == "rad"


def _exchanged(zero_deg: float) -> cs.Diagnosis:
    """Diagnose a loop about a zero of the angle, its two columns exchanged."""
    rng = np.random.default_rng(6)
    torque = np.tile(np.r_[0:9:60j, 9:0:60j, 0:-9:60j, -9:0:60j], 2)
    angle = zero_deg + 2.8 * torque + 0.05 * rng.normal(size=len(torque))
    return cs.diagnose(cs.Recording.from_arrays(angle, torque), cs.Drive.reference_87(), full=False)


def test_exchanged_columns_are_remarked_on() -> None:
    (doubt, *_) = _exchanged(60.0).answer.plausibility
    assert doubt.suggests[0].startswith("torque and angle were read from each other's column")
    # A zero of the angle within its range looks like a torque that is unloaded.
    assert not any("each other's" in text for text in _exchanged(0.0).statement.split(";"))


def test_whole_turns_of_the_datum_are_remarked_on() -> None:
    found = recorded(offset_deg=3 * 360 + 2.0)
    (doubt,) = found.answer.plausibility
    assert doubt.quantity == "datum"
    assert "3 turns" in doubt.text


@pytest.mark.parametrize(
    ("compliance", "play", "word"),
    [
        (1 / 8.85, 1.0, "lbf in"),
        (1.356, 1.0, "lbf ft"),
        (9.81, 1.0, "kgf m"),
        (60.0, 60.0, "arcmin"),
        (17.45, 17.45, "mrad"),
        (1 / 57.3, 1 / 57.3, "in rad"),
        (1 / 360, 1 / 360, "turns"),
        (1 / 1000, 1.0, "N mm"),
        (1 / 87, 1 / 87, "angle was taken at the output"),
        (1 / 87, 1.0, "torque was taken at the output"),
        (87.0**-2, 1 / 87, "the ratio squared"),
        (57.3, None, "57.3"),
    ],
)
def test_compliance_and_play_together_choose_the_mistake(
    compliance: float, play: float | None, word: str
) -> None:
    assert word in likely_mistakes(compliance * 1.02, play, 87.0)[0] or play is None
    assert any(word in text for text in likely_mistakes(compliance * 1.02, play, 87.0))


def test_the_play_contradicts_a_unit_of_the_angle() -> None:
    assert not any("angle is in" in text for text in likely_mistakes(60.0, 1.0, 87.0))


def test_a_factor_of_nothing_has_no_name() -> None:
    assert likely_mistakes(20.0, 1.0, 87.0) == ()
    assert likely_mistakes(4.0, 1.0, 87.0) == ()


def test_a_drive_softer_than_its_file_is_no_error() -> None:
    found = recorded(compliance=4.0 * 2.728)
    (doubt,) = found.answer.plausibility
    assert doubt.suggests == ()
    assert "softer than calculated, as real drives often are" in doubt.text
    assert found.verdict in ("NOTHING_MISSING", "IDENTIFIED")


@pytest.mark.parametrize("seed", [990_000, 990_003, 990_006, 990_009])
def test_no_remark_on_a_healthy_recording(seed: int, tmp_path: Path) -> None:
    make_case(seed).write(tmp_path)
    recording = cs.Recording.read(tmp_path / "recording.csv")
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.answer.plausibility == ()
    assert not found.statement.startswith("Check")
