"""A drive whose elasticity is a curve: what friction adds, and the compliance against nominal."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs

FRICTION_NM = 0.3
COMPLIANCE, SOFT = 1.6, 1.5
"""Slope of the line [deg/(N m)], and factor of the curve beside it, of which a power is taken."""


def elastic_twist(torque_nm: float) -> float:
    """Twist of a drive that stiffens with the load [deg]."""
    return float(COMPLIANCE * torque_nm + np.sign(torque_nm) * SOFT * np.abs(torque_nm) ** 0.7)


@pytest.fixture(scope="module")
def found() -> cs.Diagnosis:
    """Three loops of 12 N m with Coulomb friction."""
    leg = np.linspace(-12.0, 12.0, 300)
    torque, sense = np.r_[leg, leg[::-1]], np.repeat([1.0, -1.0], 300)
    passed = torque - FRICTION_NM * sense
    twist = np.array([elastic_twist(each) for each in passed]) + 28.0 * np.sign(passed)
    noise = np.random.default_rng(4).normal(0.0, 0.02, 3 * torque.size)
    recording = cs.Recording.from_arrays(
        np.tile(torque, 3), np.tile(twist, 3) + noise, run=np.repeat([1, 2, 3], torque.size)
    )
    return cs.diagnose(recording, cs.Drive.reference_87(), full=False)


def test_size_of_friction_is_what_its_simulation_adds(found: cs.Diagnosis) -> None:
    effects = {effect["name"]: effect for effect in found.content["effects"]}
    assert {"friction_hysteresis", "contact_stiffening"} <= effects.keys()
    model = found.model
    assert model is not None
    without = [each for each in model.effects if each.name != "friction_hysteresis"]
    smooth = replace(model, effects=tuple(without), model_error=None)
    with_friction = replace(model, model_error=None)
    leg = np.linspace(-12.0, 12.0, 300)
    loop = cs.Recording.from_arrays(np.r_[leg, leg[::-1]])
    twists = [cs.simulate(each, loop).angle_deg for each in (with_friction, smooth)]
    assert twists[0] is not None
    assert twists[1] is not None
    loaded = np.abs(loop.torque_nm) > 1.0
    added = np.abs(twists[0] - twists[1])[loaded]
    size = effects["friction_hysteresis"]
    assert size["rms_deg"] == pytest.approx(float(np.sqrt(np.mean(added**2))), rel=0.1)
    assert added.mean() < size["size_deg"]["estimate"] < 2.0 * added.mean()


def test_compliance_against_nominal_contains_the_curve(found: cs.Diagnosis) -> None:
    nominal = cs.Drive.reference_87().nominal_line("input").compliance_deg_per_nm
    true = (elastic_twist(12.0) - elastic_twist(6.0)) / 6.0
    scale = found.content["repaired"]["parameters"]["compliance_scale"]
    assert scale["estimate"] == pytest.approx(true / nominal, rel=0.02)
    assert scale["std_error"] < 0.05
    change = 100.0 * (scale["estimate"] - 1.0)
    assert f"compliance {change:+.1f} % against nominal (between half" in found.statement
