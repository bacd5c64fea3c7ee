"""Remark on creep and drag that were found in loops at one rate."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.whole_loop.one_rate import is_of_one_rate, remark_on_one_rate

STEP_S = 0.5


def loops(rows: int = 400) -> cs.Recording:
    """Two triangular loops at one rate."""
    torque = 10.0 * np.interp(np.linspace(0.0, 2.0, rows) % 1.0, [0, 0.25, 0.75, 1], [0, 1, -1, 0])
    return cs.Recording.from_arrays(torque, time_s=STEP_S * np.arange(float(rows)))


def quick_and_slow() -> cs.Recording:
    """The same at two rates."""
    load = loops()
    lapse = np.where(np.arange(len(load)) < 200, STEP_S, 0.1 * STEP_S)
    return replace(load, time_s=np.cumsum(lapse))


def held() -> cs.Recording:
    """The same, held for a while at one load."""
    load = loops()
    assert load.time_s is not None
    late = np.where(np.arange(len(load)) > 100, 60.0, 0.0)
    return replace(load, time_s=load.time_s + late)


@pytest.mark.parametrize(
    ("load", "one"),
    [
        (loops(), True),
        (quick_and_slow(), False),
        (held(), False),
        (replace(loops(), time_s=None), False),
    ],
    ids=["one rate", "two rates", "held", "no clock"],
)
def test_loops_are_of_one_rate(load: cs.Recording, one: bool) -> None:
    assert is_of_one_rate(load) == one


@pytest.mark.parametrize(
    ("named", "said"),
    [
        (["creep"], True),
        (["viscous_drag", "contact_stiffening"], True),
        (["creep", "friction_hysteresis"], False),
        (["creep", "load_dependent_friction"], False),
        (["contact_stiffening"], False),
    ],
)
def test_friction_is_said_to_be_possible(named: list[str], said: bool) -> None:
    remarks = remark_on_one_rate(loops(), named)
    assert bool(remarks) == said
    assert all(remark.startswith(f"{named[0]} and friction") for remark in remarks)


def test_the_remark_stands_in_the_answer() -> None:
    creep = cs.simulation.model.EffectValue("creep", {"time_constant_s": 20.0}, (0.6,))
    model = cs.Model(compliance_deg_per_nm=2.7, free_play_deg=2.0, effects=(creep,))
    load = loops()
    angle = cs.simulate(model, load).angle_deg
    assert angle is not None
    noise = np.random.default_rng(3).normal(0.0, 0.05, len(angle))
    found = cs.diagnose(load.with_angle(angle + noise), cs.Drive.reference_87(), full=False)
    assert "creep" in [effect["name"] for effect in found.effects]
    assert set(remark_on_one_rate(load, ["creep"])) <= set(found.content["notes"])
