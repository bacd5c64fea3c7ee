"""Friction and drag of one drive, solved for the twist, are both named and of the right size."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats

COMPLIANCE = 0.00036
FRICTION_NM = 30.0
SLIP_DEG = 0.002
DRAG_NM_S_PER_DEG = 2200.0
RATES = (2.0, 10.0, 50.0)


def twist_under(torque: Floats, step_s: float) -> Floats:
    """Twist of an elastic part beside a slider on a spring and a dashpot, reading by reading."""
    parts = 20
    twist, held, found = 0.0, 0.0, np.empty(len(torque))
    before = 0.0
    for k, load in enumerate(torque):
        for share in np.linspace(0.0, 1.0, parts + 1)[1:]:
            now = before + share * (load - before)
            dashpot = DRAG_NM_S_PER_DEG * parts / step_s
            spring = FRICTION_NM / SLIP_DEG
            moved = (now - twist / COMPLIANCE - held) / (1.0 / COMPLIANCE + dashpot + spring)
            if abs(held + spring * moved) > FRICTION_NM:
                limit = FRICTION_NM * np.sign(moved)
                moved = (now - twist / COMPLIANCE - limit) / (1.0 / COMPLIANCE + dashpot)
                held = limit
            else:
                held += spring * moved
            twist += moved
        before = load
        found[k] = twist
    return found


def recording() -> cs.Recording:
    """Loops of one drive at three rates, one after the other."""
    loop = 300.0 * np.r_[np.linspace(0.02, 1.0, 90), np.linspace(0.98, 0.02, 89)]
    loop = np.r_[loop, -loop]
    rng = np.random.default_rng(5)
    angles, clocks, runs = [], [], []
    begin = 0.0
    for run, rate in enumerate(RATES):
        step = 3.3 / rate
        clocks.append(begin + step * np.arange(1, len(loop) + 1))
        angles.append(twist_under(loop, step) + 0.001 * rng.normal(size=len(loop)))
        runs.append(np.full(len(loop), run))
        begin = float(clocks[-1][-1]) + 30.0
    return cs.Recording.from_arrays(
        np.tile(loop, len(RATES)),
        np.concatenate(angles),
        time_s=np.concatenate(clocks),
        run=np.concatenate(runs),
        side="output",
    )


def test_friction_is_not_lost_in_a_drag_that_thins() -> None:
    """Found first, the drag took up the friction, at half the power of the rate."""
    found = cs.diagnose(recording(), cs.Drive.reference_87(), full=False)
    assert {effect["name"] for effect in found.effects} == {"viscous_drag", "friction_hysteresis"}
    drag, friction = (
        next(effect["parameters"] for effect in found.effects if effect["name"] == name)
        for name in ("viscous_drag", "friction_hysteresis")
    )
    assert friction["friction_torque_nm"]["estimate"] == pytest.approx(FRICTION_NM, rel=0.05)
    assert drag["power"]["estimate"] == pytest.approx(1.0, abs=0.05)


def test_a_model_of_both_is_solved_for_the_twist() -> None:
    """Friction turns when the twist does, which the drag holds back, and not with the torque."""
    programme = recording()
    truth = np.concatenate(
        [
            twist_under(programme.torque_nm[programme.run == run], 3.3 / rate)
            for run, rate in enumerate(RATES)
        ]
    )
    lag = {"power": 1.0, "lag_s": DRAG_NM_S_PER_DEG * COMPLIANCE}
    friction = EffectValue("friction_hysteresis", {"slip_deg": SLIP_DEG, "scatter": 0.05}, (30.0,))
    errors = []
    for shape in ({**lag, "holds_friction": 1.0}, lag):
        drag = EffectValue("viscous_drag", shape, (DRAG_NM_S_PER_DEG,))
        model = cs.Model(
            compliance_deg_per_nm=COMPLIANCE,
            free_play_deg=0.0,
            side="output",
            effects=(friction, drag),
        )
        found = cs.simulate(model, programme).angle_deg
        assert found is not None
        errors.append(float(np.abs(found - truth).max()))
    assert errors[0] < 2e-4
    assert errors[1] > 5e-3
