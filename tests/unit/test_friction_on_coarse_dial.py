"""Friction far beyond the noise on a coarse dial: named, by no chance, and nothing else left."""

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.dry_friction import twist_with_friction


def loops(step_deg: float, friction_nm: float, seed: int = 4) -> cs.Recording:
    """Three loops of a drive with Coulomb friction, read on a dial of such steps."""
    rng = np.random.default_rng(seed)
    once = np.r_[np.linspace(0, 30, 100), np.linspace(30, -30, 200), np.linspace(-30, 0, 100)]
    torque = np.tile(once, 3)
    angle = twist_with_friction(torque, friction_nm, 2.7255) + 0.2 * rng.normal(size=len(torque))
    run = np.repeat([1, 2, 3], len(once))
    return cs.Recording.from_arrays(torque, step_deg * np.round(angle / step_deg), run=run,
                                    angle_resolution_deg=step_deg)  # fmt: skip


@pytest.mark.parametrize("step_deg", [1.0, 2.0, 5.0])
def test_friction_is_all_that_a_coarse_dial_hides(step_deg: float) -> None:
    found = cs.diagnose(loops(step_deg, 1.5), cs.Drive.reference_87(), full=False)
    assert [effect.name for effect in found.answer.effects] == ["friction_hysteresis"]
    assert found.verdict == "IDENTIFIED"
    p_value = found.answer.effects[0].p_value
    assert p_value is not None
    assert p_value <= 0.002
