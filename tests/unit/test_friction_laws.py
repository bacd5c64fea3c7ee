"""Friction by laws of the literature at real sizes, and what beside it took its place or its name.

The recordings are made by the scoreboard's rig, whose laws are not the library's.
"""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep_challenge.scoreboard.made import Recipe, make
from cyclosweep_challenge.scoreboard.made_rig import Law

DRIVE = cs.Drive.reference_87()
NOISE_DEG = 0.05


def diagnosed(recipe: Recipe) -> cs.Diagnosis:
    return cs.diagnose(make(recipe), DRIVE, full=False)


def names(found: cs.Diagnosis) -> list[str]:
    return sorted(effect.name for effect in found.answer.effects)


def left_deg(found: cs.Diagnosis) -> float:
    """What the repaired model leaves, as root mean square over all readings [deg]."""
    assert found.model is not None
    predicted = cs.simulate(found.model, found.recording).angle_deg
    assert predicted is not None
    assert found.recording.angle_deg is not None
    return float(np.sqrt(np.nanmean((predicted - found.recording.angle_deg) ** 2)))


@pytest.mark.parametrize(
    ("law", "remembers"), [("jenkins", True), ("dahl", False), ("bouc-wen", None)]
)
def test_coulomb_friction_of_any_presliding_is_explained_to_the_noise(
    law: Law, remembers: bool | None
) -> None:
    # With Maxwell-slip elements alone Dahl's and Bouc and Wen's laws left twice the noise.
    friction = Recipe(4_410, friction="friction_hysteresis", law=law, friction_rms_deg=0.7)
    found = diagnosed(friction)
    assert found.verdict == "IDENTIFIED"
    assert names(found) == ["friction_hysteresis"]
    assert left_deg(found) < 1.1 * NOISE_DEG
    assert found.model is not None
    forgetting = found.model.effects[0].shape.get("forgetting", 0.0)
    if remembers is not None:
        assert forgetting < 0.2 if remembers else forgetting > 0.8


def test_a_wrong_sign_beside_a_large_friction_does_not_lose_the_friction() -> None:
    # The stiffening that is fitted with it came out negative, and friction was given up, too.
    second = {"datum_drift": 150.0}
    recipe = Recipe(
        4_411, NOISE_DEG, "friction_hysteresis", "dahl", 3.0, friction_part=0.12, added_d=second
    )
    found = diagnosed(recipe)
    assert names(found) == ["datum_drift", "friction_hysteresis"]
    # The zero of a run is no law: its offsets are fitted, and no simulation foretells them.
    assert found.answer.repaired.rmse_deg is not None
    assert found.answer.repaired.rmse_deg < 1.2 * NOISE_DEG


def test_pins_that_engage_one_after_another_are_told_from_stiffening_where_loud() -> None:
    found = diagnosed(Recipe(4_412, added={"clearance_takeup": 0.7}))
    assert found.verdict == "IDENTIFIED"
    assert names(found) == ["clearance_takeup"]


def test_a_small_law_beside_a_loud_one_of_its_class_has_no_name() -> None:
    found = diagnosed(Recipe(4_413, added_d={"contact_stiffening": 400.0}))
    assert names(found) == ["contact_stiffening"]


def test_a_drive_that_changes_is_recognised_without_equal_sweeps() -> None:
    recipe = Recipe(4_414, friction="friction_hysteresis", friction_rms_deg=1.0)
    assert diagnosed(recipe).answer.change is None
    changing = Recipe(
        4_414, friction="friction_hysteresis", friction_rms_deg=1.0, stiffness_loss=0.15
    )
    change = diagnosed(changing).answer.change
    assert change is not None
    assert change.share == pytest.approx(0.15, abs=0.03)
