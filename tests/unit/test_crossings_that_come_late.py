"""A fit of the flanks is kept where a simulation is better at the crossings alone."""

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import Floats

PLAY_DEG, COMPLIANCE, NOISE_DEG = 20.4, 1.9, 0.08
SLIP_DEG, LIMIT_NM = 2.5, 0.9


def growing_loops(step_nm: float = 0.05) -> Floats:
    """Torque of five loops, each larger than the one before [N m]."""
    corners = [0.1]
    for top in np.linspace(1.3, 6.5, 5):
        corners += [float(top), -float(top)]
    parts = [
        np.linspace(start, end, max(int(abs(end - start) / step_nm), 2), endpoint=False)
        for start, end in zip(corners, [*corners[1:], 0.1], strict=True)
    ]
    return np.concatenate(parts)


def twist(torque: Floats) -> Floats:
    """Twist of a spring with six sliders beside it, behind a play that moves none of them.

    The play is crossed where the spring is without load, which is where no simulation expects it:
    neither of friction before the play, nor of friction behind it.
    """
    reach = SLIP_DEG * np.geomspace(0.2, 2.0, 6)
    grid = np.linspace(-16.0, 16.0, 16_001)
    anchor, found = np.zeros(6), np.empty(len(torque))
    for k, load in enumerate(torque):
        holds = LIMIT_NM / 6 * np.clip((grid[:, None] - anchor) / reach, -1.0, 1.0).sum(axis=1)
        angle = float(np.interp(load, grid / COMPLIANCE + holds, grid))
        anchor = np.clip(anchor, angle - reach, angle + reach)
        found[k] = angle + PLAY_DEG * np.sign(angle)
    return found


@pytest.mark.parametrize("seed", [1, 2])
def test_friction_is_named_though_no_simulation_meets_the_crossings(seed: int) -> None:
    rng = np.random.default_rng(seed)
    torque = growing_loops()
    warm = 21.0 + 0.3 * np.sin(np.arange(len(torque)) / 300.0)
    warm += rng.normal(0.0, 0.03, len(torque))
    recording = cs.Recording.from_arrays(
        torque,
        twist(torque) + rng.normal(0.0, NOISE_DEG, len(torque)),
        time_s=0.3 * np.arange(len(torque)),
        temperature_c=warm,
    )
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert [effect.name for effect in found.answer.effects] == ["friction_hysteresis"]
    rmse = found.answer.repaired.rmse_deg
    assert rmse is not None
    assert rmse < 1.5 * NOISE_DEG
