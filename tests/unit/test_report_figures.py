"""The numbers behind the pictures: loop figures, bands, thinning, ticks."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.report.charts import nice_ticks, tick_text
from cyclosweep.report.loops import loop_figures
from cyclosweep.report.profiles import by_group, profile, residual_map
from cyclosweep.report.thin import thin

C, GAP, HALF_WIDTH = 2.0, 28.0, 0.5


def parallelogram(smallest: float = 0.01) -> cs.Recording:
    """A loop with play, a straight spring and Coulomb friction of known width."""
    up = np.linspace(smallest, 10, 400)
    torque = np.r_[up, up[::-1], -up, -up[::-1]]
    loading = np.r_[np.ones(400), -np.ones(400), np.ones(400), -np.ones(400)]
    angle = np.sign(torque) * (GAP + C * np.abs(torque) - HALF_WIDTH * loading)
    return cs.Recording.from_arrays(torque, angle)


def test_loop_figures_of_a_known_loop() -> None:
    recording = parallelogram()
    assert recording.angle_deg is not None
    figures = loop_figures(recording, recording.angle_deg, 10.0)
    assert figures.lost_motion_deg == pytest.approx(2 * (GAP + C * 0.3))
    assert figures.hysteresis_loss_deg == pytest.approx(2 * HALF_WIDTH)
    assert figures.stiffness_nm_per_deg == pytest.approx(1 / C)
    # two parallelograms of height 10 N m and width 2 * HALF_WIDTH
    assert figures.energy_j[1] == pytest.approx(2 * 10 * np.radians(2 * HALF_WIDTH), rel=0.01)
    assert not figures.extrapolated


def test_a_dead_zone_that_was_not_recorded_costs_no_energy() -> None:
    up = np.linspace(0.8, 10, 60)
    torque = np.r_[up, up[::-1], -up[3:], -up[::-1]]
    recording = cs.Recording.from_arrays(torque)
    elastic = GAP * np.sign(torque) + C * torque
    assert loop_figures(recording, elastic, 10.0).energy_j[1] == pytest.approx(0, abs=1e-9)
    with_friction = parallelogram(smallest=0.8)
    assert with_friction.angle_deg is not None
    energy = loop_figures(with_friction, with_friction.angle_deg, 10.0).energy_j[1]
    assert energy == pytest.approx(2 * 10 * np.radians(2 * HALF_WIDTH), rel=0.02)


def test_lost_motion_is_extended_where_no_sample_is_near() -> None:
    recording = parallelogram(smallest=0.8)
    assert recording.angle_deg is not None
    figures = loop_figures(recording, recording.angle_deg, 10.0)
    assert figures.extrapolated
    assert figures.lost_motion_deg == pytest.approx(2 * (GAP + C * 0.3))


def test_a_one_sided_recording_shows_no_lost_motion() -> None:
    torque = np.linspace(0.1, 10, 50)
    figures = loop_figures(cs.Recording.from_arrays(torque), C * torque, None)
    assert figures.lost_motion_deg is None
    assert figures.hysteresis_loss_deg is None
    assert figures.energy_j == {}
    assert figures.stiffness_nm_per_deg == pytest.approx(1 / C)


@pytest.mark.parametrize("rho", [0.0, 0.6])
def test_noise_alone_stays_inside_the_band(rho: float) -> None:
    rng = np.random.default_rng(5)
    x = np.linspace(0, 1, 600)
    alarms = 0
    for _ in range(400):
        noise = rng.normal(size=600)
        for k in range(1, 600 if rho else 0):
            noise[k] = rho * noise[k - 1] + np.sqrt(1 - rho**2) * noise[k]
        alarms += int(profile(x, noise, 1.0, rho).outside.any())
    assert alarms <= 12  # 4 expected


def test_a_bump_leaves_the_band_where_it_is() -> None:
    x = np.linspace(0, 1, 600)
    bump = profile(x, np.where((x > 0.4) & (x < 0.5), 1.0, 0.0), 0.5, 0.0)
    assert bump.outside.any()
    assert (bump.x[bump.outside] > 0.35).all()
    assert (bump.x[bump.outside] < 0.55).all()


def test_runs_and_map_find_the_odd_one() -> None:
    run = np.repeat(np.arange(5), 100)
    residual = np.where(run == 3, 0.4, 0.0)
    np.testing.assert_array_equal(by_group(run, residual, 0.5, 0.0).outside, np.arange(5) == 3)
    torque = np.tile(np.linspace(-9, 9, 100), 5)
    cells = residual_map(torque, run, ("a", "b", "c", "d", "e"), 3 * residual, 0.5, 0.0, columns=4)
    np.testing.assert_array_equal(cells.outside.all(axis=1), np.arange(5) == 3)
    assert not cells.outside[:3].any()


def test_thinning_keeps_the_extremes() -> None:
    key = np.random.default_rng(1).normal(size=100_000)
    kept = thin(len(key), key, limit=5000)
    assert len(kept) <= 5000
    assert (np.diff(kept) > 0).all()
    assert {int(key.argmax()), int(key.argmin())} <= set(kept.tolist())
    np.testing.assert_array_equal(thin(100, key[:100]), np.arange(100))


@pytest.mark.parametrize(("low", "high"), [(0, 1), (-3e-5, 2e-5), (17.2, 17.4), (-120, 4000)])
def test_ticks_are_few_round_and_inside(low: float, high: float) -> None:
    ticks = nice_ticks(low, high)
    assert 3 <= len(ticks) <= 8
    assert ticks[0] >= low - 1e-9
    assert ticks[-1] <= high + 1e-9
    texts = [tick_text(float(tick), ticks) for tick in ticks]
    assert len(set(texts)) == len(texts)
