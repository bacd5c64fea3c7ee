"""Order of a staircase: found where steps come at equal distances, and not where they do not."""

import numpy as np
import pytest
from numpy.typing import NDArray

from cyclosweep.diagnosis.whole_loop.step_order import step_order

Reals = NDArray[np.float64]
LENGTH_DEG = 3.0
TOP_NM = 25.0
FRICTION_NM = 2.0


def ramps(
    pulsation: Reals, angle: Reals, rng: np.random.Generator
) -> tuple[Reals, Reals, NDArray[np.int64]]:
    """Torque, angle and run of two ramps whose torque pulsates with the angle.

    A leg shows what the torque has to overcome: while it rises the shaft stands still before each
    crest, while it falls before each trough.
    """
    torques, angles, runs = [], [], []
    elastic = TOP_NM * angle / LENGTH_DEG + pulsation
    for run in (1, 2):
        up = np.maximum.accumulate(elastic + FRICTION_NM)
        down = np.minimum.accumulate((elastic - FRICTION_NM)[::-1])
        torque = np.concatenate([up, down])
        torques.append(torque + rng.normal(0.0, 0.02, torque.size))
        angles.append(np.concatenate([angle, angle[::-1]]))
        runs.append(np.full(torque.size, run))
    return np.concatenate(torques), np.concatenate(angles), np.concatenate(runs)


def angle_of() -> Reals:
    return np.linspace(-LENGTH_DEG, LENGTH_DEG, 1500)


def smooth_noise(rng: np.random.Generator, size: int, width: float) -> Reals:
    kernel = np.exp(-0.5 * (np.arange(-4 * width, 4 * width + 1) / width) ** 2)
    values = np.convolve(rng.normal(size=size + len(kernel)), kernel, "same")[:size]
    return np.asarray(values / values.std())


@pytest.mark.parametrize("cycles_per_deg", [1.2, 1.52, 3.0])
def test_steps_at_equal_distances_have_their_order_among_random_ones(
    cycles_per_deg: float,
) -> None:
    rng = np.random.default_rng(1)
    angle = angle_of()
    phase = 2 * np.pi * cycles_per_deg * angle
    wave = 0.5 * np.cos(phase) + 0.4 * np.cos(2 * phase + 1.0) + 0.3 * np.cos(3 * phase)
    torque, passed, run = ramps(wave + 0.3 * smooth_noise(rng, angle.size, 20), angle, rng)
    found = step_order(torque, passed, run)
    assert found is not None
    assert found.cycles_per_deg == pytest.approx(cycles_per_deg, rel=0.03)
    assert found.chance <= 0.05


def test_a_staircase_that_repeats_at_random_places_has_no_order() -> None:
    # A test at one in twenty: more than four of 24 have a probability of one in a hundred.
    rng = np.random.default_rng(2)
    angle = angle_of()
    stated = 0
    for k in range(24):
        pulsation = smooth_noise(rng, angle.size, (8, 15, 25, 40)[k % 4])
        torque, passed, run = ramps(pulsation, angle, rng)
        stated += step_order(torque, passed, run, seed=k) is not None
    assert stated <= 4


def test_crests_are_those_of_the_torque() -> None:
    rng = np.random.default_rng(3)
    angle = angle_of()
    crest = 0.2
    phase = 2 * np.pi * 1.5 * (angle - crest)
    wave = 0.2 * (np.cos(phase) + 0.8 * np.cos(2 * phase) + 0.6 * np.cos(3 * phase))
    torque, passed, run = ramps(wave, angle, rng)
    found = step_order(torque, passed, run)
    assert found is not None
    for each in found.crest_deg.values():
        away = (each - crest + 0.5 / 1.5) % (1 / 1.5) - 0.5 / 1.5
        assert abs(away) < 0.1
    assert found.crest_deg


def test_too_few_legs_have_no_order() -> None:
    angle = np.linspace(0.0, LENGTH_DEG, 600)
    torque = TOP_NM * angle / LENGTH_DEG + np.cos(2 * np.pi * 1.5 * angle)
    run = np.ones(600, dtype=np.int64)
    assert step_order(torque, angle, run) is None
