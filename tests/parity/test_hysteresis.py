"""History operators of the core against their slow twins."""

import itertools

import numpy as np
import pytest

import cyclosweep._core as core
from tests.parity import slow_hysteresis as slow


@pytest.mark.parametrize(("play", "load"), [(0.0, 0.0), (3.0, 0.0), (3.0, 0.25)])
def test_slip_in_the_angle(play: float, load: float) -> None:
    rng = np.random.default_rng(4)
    turn = rng.uniform(-20, 20, 6)
    torque = np.concatenate([np.linspace(a, b, 25) for a, b in itertools.pairwise(turn)])
    n = len(torque)
    offset = 0.2 * np.sin(np.arange(n) / 9)
    restart = np.zeros(n, dtype=bool)
    restart[60] = True
    start = np.full(n, play)
    slip, share = np.array([0.05, 0.4, 2.0]), np.array([0.5, 0.3, 0.2])
    angle, friction = core.solve_slip(
        torque, offset, restart, start, slip, share,
        free_play=play, compliance=2.0, limit=0.8, load_factor=load,
    )  # fmt: skip
    expected, force = slow.solve_slip(
        torque, offset, restart, start, slip, share, play, 2.0, 0.8, load
    )
    np.testing.assert_allclose(angle, expected, atol=1e-6)
    np.testing.assert_allclose(friction, force, atol=1e-6)


def test_creep() -> None:
    rng = np.random.default_rng(5)
    time = np.cumsum(rng.uniform(0.2, 3.0, 60))
    load = np.cumsum(rng.normal(size=60))
    restart = np.zeros(60, dtype=bool)
    restart[30] = True
    fast = core.creep_state(load, time, restart, 7.0)
    np.testing.assert_allclose(fast, slow.creep_state(load, time, restart, 7.0), atol=2e-3)


def test_drag() -> None:
    rng = np.random.default_rng(6)
    lapse = rng.uniform(0.2, 3.0, 60)
    load = np.cumsum(rng.normal(size=60))
    restart = np.zeros(60, dtype=bool)
    restart[30] = True
    fast = core.dragged(load, lapse, restart, 0.7)
    expected = slow.dragged(load, lapse, restart, 0.7)
    np.testing.assert_allclose(fast, expected, rtol=1e-12, atol=1e-12)


def test_lengths_must_agree() -> None:
    one, two = np.zeros(1), np.zeros(2)
    with pytest.raises(ValueError, match="length"):
        core.creep_state(one, two, np.zeros(1, dtype=bool), 1.0)


def test_play_keeps_within_its_gap() -> None:
    x = 5 * np.sin(np.arange(100) / 7)
    y = core.play(x, 1.0, np.zeros(100, dtype=bool), np.zeros(100))
    assert np.all(np.abs(x - y) <= 1.0 + 1e-12)
    assert np.ptp(y) == pytest.approx(np.ptp(x) - 2.0, abs=0.05)
