"""Bristles obey what any rate-free friction must, whatever the path."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from cyclosweep_challenge.rig.programme import Programme
from cyclosweep_challenge.rig.rig import measure
from cyclosweep_challenge.rig.specimen import Specimen

levels = st.lists(st.floats(3.0, 25.0), min_size=3, max_size=25)


def path(torque: list[float], seconds: float) -> Programme:
    n = len(torque)
    return Programme(
        np.linspace(0.0, (n - 1) * seconds, n),
        np.array(torque, dtype=np.float64),
        np.ones(n, dtype=np.int64),
        np.zeros(n),
        np.full(n, 20.0),
    )


@settings(max_examples=40, deadline=None)
@given(levels, st.integers(0, 50), st.floats(0.05, 0.5))
def test_friction_knows_no_clock_and_stays_within_its_limit(
    torque: list[float], seed: int, friction: float
) -> None:
    drive = Specimen.draw(np.random.default_rng(seed))
    slow = measure(drive, path(torque, 10.0), {"friction_hysteresis": friction})
    fast = measure(drive, path(torque, 0.1), {"friction_hysteresis": friction})
    np.testing.assert_allclose(slow.angle_deg, fast.angle_deg, atol=1e-7)
    line = drive.datum_deg + drive.free_play_deg + drive.compliance_deg_per_nm * np.array(torque)
    bound = drive.compliance_deg_per_nm * friction * (1 + 1e-6) + 1e-9
    assert np.all(np.abs(slow.angle_deg - line) <= bound)


@settings(max_examples=40, deadline=None)
@given(levels, st.integers(0, 50), st.floats(0.02, 0.3))
def test_friction_is_odd_in_torque(torque: list[float], seed: int, friction: float) -> None:
    drive = Specimen.draw(np.random.default_rng(seed))
    there = measure(drive, path(torque, 1.0), {"friction_hysteresis": friction})
    back = measure(drive, path([-t for t in torque], 1.0), {"friction_hysteresis": friction})
    np.testing.assert_allclose(
        there.angle_deg - drive.datum_deg, -(back.angle_deg - drive.datum_deg), atol=1e-7
    )


@settings(max_examples=40, deadline=None)
@given(levels, st.integers(0, 50))
def test_closed_torque_cycles_never_give_energy_back(torque: list[float], seed: int) -> None:
    drive = Specimen.draw(np.random.default_rng(seed))
    cycle = [*torque, torque[0]]
    run = path(cycle * 3, 1.0)
    amplitudes = {"friction_hysteresis": 0.2, "load_dependent_friction": 0.03, "viscous_drag": 0.01}
    angle = measure(drive, run, amplitudes).angle_deg[len(cycle) :]
    load = run.torque_nm[len(cycle) :]
    work = np.sum(0.5 * (load[1:] + load[:-1]) * np.diff(angle))
    assert work >= -1e-6 - abs(load[-1]) * abs(angle[-1] - angle[0])
