"""The rig against what its parts must do, each in a limit that can be worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from cyclosweep_challenge import ALIENS, PROGRAMMES, VOCABULARY
from cyclosweep_challenge.rig.nominal import RATED_INPUT_TORQUE_NM
from cyclosweep_challenge.rig.programme import Programme, make_programme
from cyclosweep_challenge.rig.rig import measure
from cyclosweep_challenge.rig.specimen import Specimen


def specimen(seed: int = 1) -> Specimen:
    return Specimen.draw(np.random.default_rng(seed))


def programme(name: str = "rich", seed: int = 2, samples: int = 800) -> Programme:
    return make_programme(name, np.random.default_rng(seed), samples)


def ramp(levels: list[float], seconds: float = 1.0) -> Programme:
    torque = np.array(levels, dtype=np.float64)
    n = torque.size
    return Programme(
        np.linspace(0.0, (n - 1) * seconds, n),
        torque,
        np.ones(n, dtype=np.int64),
        np.full(n, 30.0),
        np.full(n, 20.0),
    )


def line(drive: Specimen, path: Programme) -> np.ndarray:
    side = np.sign(path.torque_nm)
    return (
        drive.datum_deg + side * drive.free_play_deg + drive.compliance_deg_per_nm * path.torque_nm
    )


@pytest.mark.parametrize("name", PROGRAMMES)
def test_without_effects_it_is_dead_zone_and_line(name: str) -> None:
    drive, path = specimen(), programme(name)
    response = measure(drive, path, {})
    np.testing.assert_allclose(response.angle_deg, line(drive, path), atol=1e-11)
    assert response.recorded.all()


@pytest.mark.parametrize("name", VOCABULARY + ALIENS)
def test_every_cause_changes_something_and_vanishes_with_its_amplitude(name: str) -> None:
    drive, path = specimen(), programme()
    base = measure(drive, path, {}).angle_deg
    some = measure(drive, path, {name: 0.01}).angle_deg - base
    less = measure(drive, path, {name: 1e-7}).angle_deg - base
    assert np.abs(some).max() > 1e-4
    assert np.abs(less).max() < 1e-4


def test_saturated_friction_shifts_both_branches_by_compliance_times_friction() -> None:
    drive = specimen()
    up = np.linspace(0.5, 25.0, 120)
    path = ramp(np.concatenate([up, up[::-1]]).tolist())
    friction = 0.2
    response = measure(drive, path, {"friction_hysteresis": friction})
    gap = response.angle_deg - line(drive, path)
    shift = drive.compliance_deg_per_nm * friction
    np.testing.assert_allclose(gap[:119], -shift, atol=1e-6)
    np.testing.assert_allclose(gap[150:], shift, atol=1e-6)


@pytest.mark.parametrize(
    "amplitudes",
    [
        {"friction_hysteresis": 0.3},
        {"load_dependent_friction": 0.05},
        {"viscous_drag": 0.02},
        {"creep": 1.0},
        {"friction_hysteresis": 0.3, "contact_stiffening": 1.0, "creep": 0.5},
    ],
)
def test_a_closed_cycle_dissipates(amplitudes: dict[str, float]) -> None:
    drive = specimen()
    one = np.concatenate([np.linspace(2.0, 20.0, 60), np.linspace(20.0, 2.0, 60)[1:]])
    path = ramp(np.tile(one, 3).tolist())
    response = measure(drive, path, amplitudes)
    first = one.size
    angle = response.angle_deg[first : 2 * first + 1]
    torque = path.torque_nm[first : 2 * first + 1]
    assert np.sum(0.5 * (torque[1:] + torque[:-1]) * np.diff(angle)) > 0.0


def test_drag_goes_with_the_rate() -> None:
    drive = specimen()
    up = np.linspace(1.0, 20.0, 200).tolist()
    shift = {}
    for seconds in (1.0, 4.0):
        path = ramp(up, seconds)
        response = measure(drive, path, {"viscous_drag": 0.02})
        shift[seconds] = (response.angle_deg - line(drive, path))[100]
    assert shift[1.0] < 0.0
    assert shift[1.0] / shift[4.0] == pytest.approx(4.0, rel=0.02)


def test_creep_settles_at_its_final_twist_and_recovers() -> None:
    drive = specimen()
    held = [RATED_INPUT_TORQUE_NM] * 4000 + [0.5] * 8000
    path = ramp(held, 5.0)
    shift = measure(drive, path, {"creep": 2.0}).angle_deg - line(drive, path)
    assert shift[3999] == pytest.approx(2.0, rel=1e-3)
    assert shift[-1] == pytest.approx(2.0 * 0.5 / RATED_INPUT_TORQUE_NM, rel=2e-2)
    assert np.all(np.diff(shift[:4000]) > -1e-12)


def test_creep_and_play_start_afresh_but_the_datum_remembers() -> None:
    drive, path = specimen(), programme("poor")
    second, third = path.run == 2, path.run == 3
    crept = measure(drive, path, {"creep": 1.0}).angle_deg - line(drive, path)
    n = min(second.sum(), third.sum())
    np.testing.assert_allclose(crept[second][:n], crept[third][:n], atol=1e-9)
    moved = measure(drive, path, {"datum_drift": 1.0}).angle_deg - line(drive, path)
    assert np.abs(moved[path.run == 1]).max() < 1e-12
    assert np.ptp(moved[second]) < 1e-12
    assert abs(moved[second][0]) > 0.1


def test_balance_holds_at_every_reading() -> None:
    """Elastic law, bristles and drag add up to the applied torque, solved independently."""
    drive = specimen(4)
    drive = replace(drive, friction=replace(drive.friction, share=np.full(40, 1 / 40)))
    up = np.concatenate([np.linspace(1.0, 20.0, 40), np.linspace(20.0, 6.0, 30)])
    path = ramp(up.tolist())
    amplitude = 0.4
    response = measure(drive, path, {"friction_hysteresis": amplitude})
    position, force = 0.0, np.zeros(40)
    for torque, angle in zip(up, response.angle_deg, strict=True):
        x = angle - drive.datum_deg
        limit = amplitude / 40
        force = np.clip(
            force + limit / drive.friction.slip_distance_deg * (x - position), -limit, limit
        )
        carried = (x - drive.free_play_deg) / drive.compliance_deg_per_nm
        assert carried + force.sum() == pytest.approx(torque, abs=1e-7)
        position = x


def test_even_and_odd_effects_keep_their_symmetry() -> None:
    drive = specimen()
    up = np.linspace(1.0, 25.0, 50)
    there = measure(drive, ramp(up.tolist()), {"contact_stiffening": 1.0})
    back = measure(drive, ramp((-up).tolist()), {"contact_stiffening": 1.0})
    np.testing.assert_allclose(
        there.angle_deg - drive.datum_deg, -(back.angle_deg - drive.datum_deg), atol=1e-9
    )
    there = measure(drive, ramp(up.tolist()), {"load_asymmetry": 1.0})
    back = measure(drive, ramp((-up).tolist()), {"load_asymmetry": 1.0})
    even = there.angle_deg - line(drive, ramp(up.tolist()))
    np.testing.assert_allclose(even, back.angle_deg - line(drive, ramp((-up).tolist())), atol=1e-9)


def test_stiffening_and_softening_bend_the_line_the_right_way() -> None:
    drive = specimen()
    path = ramp(np.linspace(0.5, 30.0, 300).tolist())
    for name, sign in (
        ("contact_stiffening", -1.0),
        ("clearance_takeup", -1.0),
        ("overload_softening", 1.0),
    ):
        slope = np.gradient(measure(drive, path, {name: 0.5}).angle_deg, path.torque_nm)
        assert sign * (slope[-5] - slope[5]) > 0.01, name


def test_friction_larger_than_the_torque_leaves_nothing_to_read() -> None:
    drive = specimen()
    path = ramp(np.linspace(0.5, 6.0, 40).tolist())
    response = measure(drive, path, {"friction_hysteresis": 2.0})
    assert not response.recorded[path.torque_nm < 1.9].any()
    assert response.recorded[path.torque_nm > 2.1].all()


def test_unknown_cause_is_refused() -> None:
    with pytest.raises(ValueError, match="gremlins"):
        measure(specimen(), programme(), {"gremlins": 1.0})
