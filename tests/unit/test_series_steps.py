"""Order that the steps of several recordings share, where each of them passes too few steps."""

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cyclosweep.diagnosis.series_steps import own_order, steps_in_common
from cyclosweep.diagnosis.whole_loop.step_spectrum import Leg, legs_in, orders_in, step_spectrum
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


def recording(
    rng: np.random.Generator, wave: float, start_deg: float, width: float = 35.0
) -> dict[str, Any]:
    """Legs of two ramps up and down whose torque has steps, of which a share is a wave.

    Both runs pass the same steps; those to and fro are others.

    Parameters
    ----------
    rng : Generator
    wave : float
        Amplitude of the wave and its multiples [N m].
    start_deg : float
        Angle in the middle of the recording [deg].
    width : float
        Width of the random steps, in readings.
    """
    angle = start_deg + np.linspace(-LENGTH_DEG, LENGTH_DEG, 1500)
    torques, angles, runs = [], [], []
    of_direction = {}
    for direction in (1, -1):
        phase = 2 * np.pi * ORDER * RATIO / 360.0 * angle + rng.uniform(0.0, 2.0)
        steps = wave * (np.cos(phase) + 0.7 * np.cos(2 * phase) + 0.5 * np.cos(3 * phase))
        of_direction[direction] = steps + 0.3 * smooth_noise(rng, angle.size, width)
    for run in (1, 2):
        for direction, steps in of_direction.items():
            torque = TOP_NM * (angle - start_deg) / LENGTH_DEG + 2.0 * direction + steps
            torque = torque + rng.normal(0.0, 0.02, angle.size)
            torques.append(torque[::direction])
            angles.append(angle[::direction])
            runs.append(np.full(angle.size, run))
    return as_data(legs_in(np.concatenate(torques), np.concatenate(angles), np.concatenate(runs)))


def as_data(legs: Iterable[Leg]) -> dict[str, Any]:
    """What a recording keeps of its legs."""
    return {
        "turns_of_input": RATIO,
        "legs": [
            {"angle_deg": leg.angle_deg.tolist(), "torque_nm": leg.torque_nm.tolist(),
             "rising": leg.rising, "side": leg.side}
            for leg in legs
        ],
    }  # fmt: skip


def moved(steps: dict[str, Any], by_deg: float, *, backwards: bool = False) -> dict[str, Any]:
    """Put the zero of the angle elsewhere, and the legs in another order."""
    legs = [
        leg | {"angle_deg": (np.array(leg["angle_deg"]) + by_deg).tolist()} for leg in steps["legs"]
    ]
    return steps | {"legs": legs[::-1] if backwards else legs}


def test_recordings_share_the_order_of_their_motor() -> None:
    rng = np.random.default_rng(5)
    steps = {f"r{k}": recording(rng, 0.09, 11.0 * k) for k in range(8)}
    found = steps_in_common(steps)
    assert found is not None
    assert found.certain
    assert found.order == pytest.approx(ORDER, rel=0.03)
    # By itself hardly any of them shows it so surely.
    assert np.median([own.chance for own in found.own.values()]) > found.chance
    assert all(abs(own.order_of_others / ORDER - 1.0) < 0.03 for own in found.own.values())
    assert "order 4" in found.text
    assert own_order(found, "r3") == {
        "step_order": found.own["r3"].order,
        "step_order_chance": found.own["r3"].chance,
    }
    assert own_order(found, "none") == {}


def chances(cases: Iterable[list[dict[str, Any]]]) -> Reals:
    """Chance that is stated of each case, under its own seed."""
    found = []
    for seed, case in enumerate(cases):
        steps = steps_in_common({f"r{k}": each for k, each in enumerate(case)}, seed)
        assert steps is not None
        found.append(steps.chance)
    return np.array(found)


def test_random_steps_have_no_order_in_common() -> None:
    rng = np.random.default_rng(6)
    cases = [
        [recording(rng, 0.0, 11.0 * k, width=(8.0, 15.0, 25.0)[n % 3]) for k in range(3)]
        for n in range(9)
    ]
    # No smaller than chance: of nine at one in twenty, three have a probability of 0.01.
    assert np.count_nonzero(chances(cases) <= 0.05) <= 2


@pytest.mark.parametrize("zeros_deg", [(0.0, 0.0, 0.0), (0.0, 7.0, -13.0)])
def test_the_same_place_recorded_again_is_no_further_evidence(
    zeros_deg: tuple[float, ...],
) -> None:
    # With the zero of the angle moved too, and the legs in another order. If each recording passed
    # a staircase of its own, eight of nine would have a chance of one in twenty or less.
    rng = np.random.default_rng(7)
    cases = []
    for n in range(9):
        once = recording(rng, 0.0, 0.0, width=(8.0, 15.0, 25.0)[n % 3])
        cases.append([moved(once, z, backwards=k % 2 == 1) for k, z in enumerate(zeros_deg)])
    assert np.count_nonzero(chances(cases) <= 0.05) <= 2


def test_equal_generators_draw_one_staircase_whichever_legs_there_are() -> None:
    legs = legs_of_data(recording(np.random.default_rng(9), 0.2, 0.0))
    cycles = orders_in(LENGTH_DEG)

    def drawn(some: list[Leg], seed: int = 0) -> Reals:
        return step_spectrum(some, cycles, np.random.default_rng(seed)).drawn.ravel()

    whole = drawn(legs)
    one_side = [leg for leg in legs if leg.side > 0]
    assert np.corrcoef(whole, drawn(legs[::-1]))[0, 1] > 0.9
    assert np.corrcoef(whole, drawn(one_side))[0, 1] > 0.4
    assert np.corrcoef(whole, drawn(legs, seed=1))[0, 1] < 0.2


def legs_of_data(steps: dict[str, Any]) -> list[Leg]:
    """Legs of what a recording keeps."""
    return [
        Leg(np.array(e["angle_deg"]), np.array(e["torque_nm"]), e["rising"], e["side"])
        for e in steps["legs"]
    ]


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
    assert found.left_out == ("far",)
    assert "1 more have" in found.text
    page = tmp_path / "index.html"
    write_series_page(page, [{"recording": "one", "status": "ok", "side": "output"}], (), (), found)
    assert "Steps of the torque" in page.read_text()
    assert found.text.split(":")[0] in page.read_text()
