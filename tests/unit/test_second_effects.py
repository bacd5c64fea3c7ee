"""Effects beside a large friction, friction of a long presliding, and what changes between runs."""

from pathlib import Path

import numpy as np

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.behaviour_classes import RUN_PLAY
from cyclosweep.simulation.simulate import EffectValue
from cyclosweep_challenge.campaign.making import make_item
from cyclosweep_challenge.campaign.parts import parts
from tests.support.long_recording import COMPLIANCE, long_recording

DRIVE = cs.Drive.reference_87()


def concealed(part: str, number: int, folder: Path, seed: int = 7_100_000) -> cs.Recording:
    """Recording of a campaign that is no record; the seed was used in writing what is tested."""
    kinds = {each.name: each for each in parts()}
    case = make_item(kinds[part].plan(seed, number + 1, 3000)[number])
    return cs.Recording.read(case.write(folder, program=False) / "recording.csv")


def names(found: cs.Diagnosis) -> list[str]:
    return sorted(effect.name for effect in found.answer.effects)


def test_creep_of_a_thirtieth_of_the_friction_is_no_error_of_its_law(tmp_path: Path) -> None:
    # By size alone it was taken for that, although nothing but noise is left with it.
    found = cs.diagnose(concealed("loud", 3, tmp_path), DRIVE, full=False)
    assert names(found) == ["creep", "load_dependent_friction"]


def test_compliance_that_follows_the_temperature_is_thermal_drift() -> None:
    warm = EffectValue("thermal_drift", {"compliance": 1.0}, (5e-4 * COMPLIANCE,))
    found = cs.diagnose(long_recording(3000, [warm]), DRIVE, full=False)
    assert found.verdict == "IDENTIFIED"
    (effect,) = found.answer.effects
    assert effect.name == "thermal_drift"
    amplitude = effect.parameters["compliance_per_k"]
    assert abs(amplitude.estimate / (5e-4 * COMPLIANCE) - 1.0) < 0.1


def test_play_that_changes_from_run_to_run_has_its_class_and_no_name() -> None:
    recording = long_recording(3000)
    assert recording.angle_deg is not None
    widened = np.array([0.0, 0.3, -0.2, 0.5, 0.1, -0.4, 0.35, -0.1])[recording.run - 1]
    worn = recording.with_angle(recording.angle_deg + np.sign(recording.angle_deg) * widened)
    found = cs.diagnose(worn, DRIVE, full=False)
    assert found.verdict == "UNKNOWN_PHYSICS"
    assert names(found) == []
    assert RUN_PLAY in [shown.behaviour for shown in found.answer.classes]


def test_friction_that_the_flexible_model_does_not_hold_is_not_taken_for_slow_noise(
    tmp_path: Path,
) -> None:
    # Noise of 0.016 deg was said to be 0.34 deg, and nothing was named.
    found = cs.diagnose(concealed("foreign-loud", 5, tmp_path), DRIVE, full=False)
    assert "load_dependent_friction" in names(found)
    assert found.answer.noise.sigma_deg is not None
    assert found.answer.noise.sigma_deg < 0.03


def test_a_large_error_of_the_mesh_has_its_name_where_its_orders_are_several(
    tmp_path: Path,
) -> None:
    # Nothing was named: free offsets of the positions explained more than waves that were shrunk.
    found = cs.diagnose(concealed("foreign-loud", 29, tmp_path, 25_000_800), DRIVE, full=False)
    assert names(found) == ["transmission_error"]
    assert found.verdict == "MOSTLY_EXPLAINED"
