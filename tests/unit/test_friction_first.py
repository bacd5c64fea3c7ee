"""Friction alone is tried beside a joint fit, and begun with only where that is better."""

import cyclosweep as cs
from tests.support.long_recording import friction, long_recording


def test_a_friction_that_no_joint_fit_precedes_is_named_by_its_own_law() -> None:
    # Without a joint fit the stages find it better than friction alone does, whose parameters
    # then stay where one start has led.
    recording = long_recording(20_000, [friction(0.4)])
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.verdict == "IDENTIFIED"
    assert [effect.name for effect in found.answer.effects] == ["friction_hysteresis"]
