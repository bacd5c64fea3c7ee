"""Order that the steps of several recordings share, where each of them passes too few steps."""

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cyclosweep.diagnosis.series_steps import own_order, steps_in_common
from cyclosweep.diagnosis.whole_loop.step_spectrum import legs_in
from cyclosweep.report.series_page import write_series_page

Reals = NDArray[np.float64]
RATIO = 13.0
LENGTH_DEG, TOP_NM = 2.5, 25.0
ORDER = 42.0
"""Cycles a turn of the input."""


def smooth_noise(rng: np.random.Generator, size: int, width: float) -> Reals:
    """Random steps as wide as `width` readings, of standard deviation one."""
    kernel = np.exp(-0.5 * (np.arange(-4 * width, 4 * width + 1) / width) ** 2)
    values = np.convolve(rng.normal(size=size + len(kernel)), kernel, "same")[:size]
    return np.asarray(values / values.std())


def recording(rng: np.random.Generator, wave: float, start_deg: float) -> dict[str, Any]:
    """Legs of a ramp up and down whose torque has steps, of which a share is a wave.

    Parameters
    ----------
    rng : Generator
    wave : float
        Amplitude of the wave and its multiples [N m].
    start_deg : float
        Angle in the middle of the recording [deg].
    """
    angle = start_deg + np.linspace(-LENGTH_DEG, LENGTH_DEG, 1500)
    torques, angles, runs = [], [], []
    # Legs to and fro, and of either side, have steps of their own.
    for run in (1, 2):
        for direction in (1, -1):
            phase = 2 * np.pi * ORDER * RATIO / 360.0 * angle + rng.uniform(0.0, 2.0)
            steps = wave * (np.cos(phase) + 0.7 * np.cos(2 * phase) + 0.5 * np.cos(3 * phase))
            steps += 0.3 * smooth_noise(rng, angle.size, 35)
            torque = TOP_NM * (angle - start_deg) / LENGTH_DEG + 2.0 * direction + steps
            torques.append(torque[::direction])
            angles.append(angle[::direction])
            runs.append(np.full(angle.size, run))
    legs = legs_in(np.concatenate(torques), np.concatenate(angles), np.concatenate(runs))
    return {
        "turns_of_input": RATIO,
        "legs": [
            {"angle_deg": leg.angle_deg.tolist(), "torque_nm": leg.torque_nm.tolist(),
             "rising": leg.rising, "side": leg.side}
            for leg in legs
        ],
    }  # fmt: skip


def test_recordings_that_show_no_order_alone_share_one() -> None:
    rng = np.random.default_rng(5)
    steps = {f"r{k}": recording(rng, 0.05, 11.0 * k) for k in range(8)}
    found = steps_in_common(steps)
    assert found is not None
    assert found.certain
    assert found.order == pytest.approx(ORDER, rel=0.03)
    # By itself hardly any of them has an order that can be stated.
    assert sum(own.chance <= 0.05 for own in found.own.values()) <= 2
    assert "order 4" in found.text
    assert own_order(found, "r3") == {
        "step_order": found.own["r3"].order,
        "step_order_chance": found.own["r3"].chance,
    }
    assert own_order(found, "none") == {}


def test_random_steps_have_no_order_in_common() -> None:
    # A test at one in a hundred: two of 20 have a probability of less than one in fifty.
    rng = np.random.default_rng(6)
    stated = 0
    for seed in range(20):
        found = steps_in_common({f"r{k}": recording(rng, 0.0, 11.0 * k) for k in range(3)}, seed)
        assert found is not None
        stated += found.certain
    assert stated <= 1


def test_the_same_place_recorded_again_is_no_further_evidence() -> None:
    rng = np.random.default_rng(7)
    stated = 0
    for seed in range(12):
        once = recording(rng, 0.0, 0.0)
        found = steps_in_common({f"r{k}": once for k in range(6)}, seed)
        assert found is not None
        # All orders of one recording are those of six copies of it.
        assert {round(own.order, 6) for own in found.own.values()} == {round(found.order, 6)}
        stated += found.certain
    assert stated <= 1


def test_one_recording_and_legs_of_another_length_say_nothing(tmp_path: Any) -> None:
    rng = np.random.default_rng(8)
    one = recording(rng, 0.5, 0.0)
    assert steps_in_common({}) is None
    assert steps_in_common({"one": one}) is None
    far = {"turns_of_input": 10 * RATIO, "legs": one["legs"]}
    assert steps_in_common({"one": one, "far": far}) is None
    found = steps_in_common({"one": one, "two": recording(rng, 0.5, 7.0), "far": far})
    assert found is not None
    assert set(found.own) == {"one", "two"}
    page = tmp_path / "index.html"
    write_series_page(page, [{"recording": "one", "status": "ok", "side": "output"}], (), (), found)
    assert "Steps of the torque" in page.read_text()
    assert found.text.split(":")[0] in page.read_text()
