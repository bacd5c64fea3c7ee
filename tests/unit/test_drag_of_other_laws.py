"""A loop that opens with the rate is a drag's, whatever its law."""

import numpy as np
import pytest

import cyclosweep as cs


@pytest.mark.parametrize("seed", [1, 2])
def test_sheared_oil_by_eyring_is_named(seed: int) -> None:
    """Its law misses a tenth of its class, and it is the only effect of that class."""
    rng = np.random.default_rng(seed)
    run, share = np.repeat(np.arange(6), 240), np.tile((np.arange(240) + 0.5) / 240, 6)
    rate = np.array([8.0, 60.0, 200.0] * 2)[run]
    time_s = share * 3600.0 / rate + 1000.0 * run
    torque = np.interp(share, [0.0, 0.25, 0.75, 1.0], [0.0, 900.0, -900.0, 0.0])
    rising = np.where((share < 0.25) | (share > 0.75), 1.0, -1.0)
    drag = 0.0024 * np.arcsinh(rising * rate / 25.0)
    recording = cs.Recording.from_arrays(
        torque_nm=torque + 2.0 * rng.normal(size=len(run)),
        angle_deg=0.00036 * torque
        + 0.05 * np.sign(torque)
        - drag
        + 0.0015 * rng.normal(size=len(run)),
        time_s=time_s,
        run=run,
        side="output",
    )
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    assert [str(each["name"]) for each in found.effects] == ["viscous_drag"]
