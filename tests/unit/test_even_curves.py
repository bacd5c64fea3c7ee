"""A curve that is even in the torque is a side load's, whatever its law."""

from collections.abc import Callable

import numpy as np
import pytest

import cyclosweep as cs
from tests.support.arrays import Floats

CURVES: dict[str, Callable[[Floats], Floats]] = {
    "softer one way from four tenths of the load": lambda load: np.maximum(load - 0.4, 0.0),
    "hyperbola": lambda load: load / (load + 0.2),
}


def names(curve: Callable[[Floats], Floats]) -> list[str]:
    """Names in the diagnosis of a drive with this even twist, far above the noise."""
    up = np.linspace(-10.0, 10.0, 101)
    torque = np.tile(np.r_[up, up[-2:0:-1]], 3)[:560]
    noise = 0.03 * np.random.default_rng(1).normal(size=len(torque))
    angle = 2.7 * torque + 1.5 * curve(np.abs(torque) / 10.0) + noise
    time_s = 2.0 * np.arange(len(torque))
    recording = cs.Recording.from_arrays(torque, angle, side="input", time_s=time_s)
    found = cs.diagnose(recording, cs.Drive.reference_87(), full=False)
    return [str(each["name"]) for each in found.effects]


@pytest.mark.parametrize("curve", CURVES)
def test_an_even_curve_of_another_law_is_named(curve: str) -> None:
    assert names(CURVES[curve]) == ["load_asymmetry"]


def test_a_step_of_the_even_twist_is_no_side_load() -> None:
    assert names(lambda load: np.asarray(1.0 / (1.0 + np.exp((0.5 - load) / 0.05)))) == []
