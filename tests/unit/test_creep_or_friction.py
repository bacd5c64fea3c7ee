"""Creep of a single loop, which friction of any shape imitates."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.model import EffectValue

ROWS, DURATION_S, TOP_NM = 560, 280.0, 20.0


@pytest.mark.parametrize("time_constant_s", [20.0, 40.0])
def test_creep_that_explains_a_loop_as_well_is_no_friction(time_constant_s: float) -> None:
    """Friction came first and was compared with drag only, so that it was said to be certain."""
    steps = np.arange(ROWS)
    quarter = ROWS // 4
    torque = np.interp(steps, [0, quarter, 3 * quarter, ROWS - 1], [0.0, TOP_NM, -TOP_NM, 0.0])
    load = cs.Recording.from_arrays(torque, time_s=steps * DURATION_S / ROWS)
    creep = EffectValue("creep", {"time_constant_s": time_constant_s}, (0.16,))
    angle = cs.simulate(cs.Model(2.7, 28.0, effects=(creep,)), load).angle_deg
    assert angle is not None
    noise = np.random.default_rng(3).normal(0.0, 0.01, ROWS)
    recording = load.with_angle(angle + noise).take(np.flatnonzero(np.abs(torque) > 0.2))
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert found.verdict == "IDENTIFIED"
    assert [each["name"] for each in found.effects] == ["creep"]
    assert found.content["repaired"]["rmse_deg"] < 0.0105
