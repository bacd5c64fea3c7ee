"""Drag of the lubricant beside elastic effects, its thinning, and the approach to a run."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.model import EffectValue
from tests.support.arrays import Floats, present
from tests.support.searches import search_of_recording

COMPLIANCE, PLAY_DEG, DRAG_NM = 1.4, 14.0, 0.5
STEP_S = 0.5
DRAG = EffectValue("viscous_drag", {"power": 1.0, "lag_s": DRAG_NM * COMPLIANCE}, (DRAG_NM,))
STIFFENING = EffectValue("contact_stiffening", {"cubic_nm": 6.0}, (0.4,))
FRICTION = EffectValue("friction_hysteresis", {"slip_deg": 0.5, "scatter": 0.4}, (0.8,))


SOFTENING = EffectValue("overload_softening", {"onset_nm": 2.0, "power": 1.5}, (10.0,))


def programme(runs: int = 3) -> cs.Recording:
    """Ramps at several rates, each run begun at 1 N m."""
    parts = []
    for k in range(1, runs + 1):
        peaks = np.array([1.0, 12.0, 4.0, 9.0, 0.6]) * (1.0 if k % 2 else -1.0)
        at_s = np.r_[0.0, np.cumsum(np.abs(np.diff(peaks)) / (0.3 * k))]
        time = np.arange(0.0, at_s[-1], STEP_S)
        parts.append((np.interp(time, at_s, peaks), time + 1e3 * k, np.full(len(time), k)))
    torque, time, run = map(np.concatenate, zip(*parts, strict=True))
    return cs.Recording.from_arrays(torque, time_s=time, run=run)


def model(*effects: EffectValue) -> cs.Model:
    return cs.Model(compliance_deg_per_nm=COMPLIANCE, free_play_deg=PLAY_DEG, effects=effects)


def twist(*effects: EffectValue) -> Floats:
    return present(cs.simulate(model(*effects), programme()).angle_deg)


def through_zero() -> cs.Recording:
    """Ramps to either side, so that drag presses the flank that the torque has left."""
    time = np.arange(0.0, 80.0, 0.25)
    torque = np.interp(
        time, [0.0, 10.0, 30.0, 50.0, 70.0, 80.0], [0.0, 10.0, -10.0, 10.0, -10.0, 0]
    )
    return cs.Recording.from_arrays(torque, time_s=time)


@pytest.mark.parametrize("law", [STIFFENING, SOFTENING], ids=["stiffening", "softening"])
@pytest.mark.parametrize("load", [programme(), through_zero()], ids=["ramps", "through zero"])
def test_elastic_effects_carry_what_drag_leaves(law: EffectValue, load: cs.Recording) -> None:
    def twist_of(load: cs.Recording, *effects: EffectValue) -> Floats:
        whole = replace(model(*effects), free_play_deg=0.0)
        return present(cs.simulate(whole, load).angle_deg)

    carried = twist_of(load, DRAG) / COMPLIANCE
    expected = twist_of(replace(load, torque_nm=carried), law)
    found = twist_of(load, DRAG, law)
    np.testing.assert_allclose(found, expected, atol=2e-4)
    # Drag beside a law of the whole torque.
    apart = twist_of(load, DRAG) + twist_of(load, law) - twist_of(load)
    assert np.max(np.abs(found - apart)) > 0.1


def test_a_line_and_an_elastic_effect_are_one_spring_under_drag_and_friction() -> None:
    # Half of the compliance as an effect: a softening from zero on is a line.
    half = EffectValue("overload_softening", {"onset_nm": 0.0, "power": 1.0}, (7.0,))
    drag = replace(DRAG, amplitudes=(2.0 * DRAG_NM,))
    friction = replace(FRICTION, amplitudes=(2.0,))
    cut = replace(model(drag, half, friction), compliance_deg_per_nm=0.5 * COMPLIANCE)
    whole = replace(model(DRAG, friction))
    found, expected = (present(cs.simulate(m, programme()).angle_deg) for m in (cut, whole))
    np.testing.assert_allclose(found, expected, atol=1e-3)


def test_an_effect_in_series_carries_the_whole_torque() -> None:
    in_series = replace(STIFFENING, in_series=True)
    found = twist(DRAG, in_series)
    np.testing.assert_allclose(found, twist(DRAG) + twist(STIFFENING) - twist(), atol=1e-6)


@pytest.mark.parametrize("others", [(), (FRICTION,)], ids=["alone", "with friction"])
def test_torque_and_angle_are_inverse(others: tuple[EffectValue, ...]) -> None:
    # Between the readings the angle does not say how the torque went: by readings.
    by_reading = [
        replace(each, shape={**each.shape, "by_reading": 1.0}) for each in (DRAG, *others)
    ]
    whole = model(*by_reading, STIFFENING)
    there = cs.simulate(whole, programme())
    back = cs.simulate(whole, there, predict="torque")
    np.testing.assert_allclose(back.torque_nm, programme().torque_nm, atol=0.02)


def test_a_run_that_is_reached_slowly_begins_without_lag() -> None:
    begins = np.flatnonzero(np.diff(programme().run, prepend=0))
    lag = {}
    for name, shape in {
        "rate": {},
        "slow": {"approach_s": 1e6},
        "fast": {"approach_s": 0.1},
    }.items():
        value = replace(DRAG, shape={**DRAG.shape, **shape})
        lag[name] = np.abs(twist(value) - twist())[begins]
    assert np.all(lag["slow"] < 1e-6)
    assert np.all(lag["rate"] > 0.05)
    assert np.all(lag["fast"] > 1.5 * lag["rate"])


def test_thinning_is_within_a_hundredth_of_eyrings_law() -> None:
    rate = np.geomspace(0.2, 20.0, 200)
    eyring = np.arcsinh(rate)

    def missed(at: Floats) -> float:
        power, thinning = np.clip(at[0], 0.1, 1.0), np.exp(at[1])
        shape = {"thinned_power": float(power), "thinning_deg_per_s": float(thinning)}
        law = np.array([resistance(shape, each) for each in rate])
        law *= law @ eyring / (law @ law)
        return float(np.sqrt(np.mean((law - eyring) ** 2) / np.mean(eyring**2)))

    found = minimize(missed, [0.3, 0.0], method="Nelder-Mead")
    assert found.fun < 0.01
    assert missed(np.array([0.5, -9.0])) > 0.05


def resistance(shape: dict[str, float], rate_deg_per_s: float) -> float:
    """Drag in a slow ramp of a drive that twists at this rate, over that at 1 deg/s."""
    seconds = np.arange(1.0, 200.0)
    torque = seconds * rate_deg_per_s / COMPLIANCE
    load = cs.Recording.from_arrays(torque, time_s=seconds)
    drag = 0.01
    value = EffectValue("viscous_drag", {**shape, "lag_s": drag}, (drag,))
    lag = cs.simulate(model(), load), cs.simulate(model(value), load)
    return float(present(lag[0].angle_deg)[-1] - present(lag[1].angle_deg)[-1]) / drag / COMPLIANCE


@pytest.mark.parametrize(
    "shape",
    [
        {"thinned_power": 0.4, "lag_s": 1.0},
        {"power": 1.0, "thinning_deg_per_s": 1.0, "lag_s": 1.0},
        {"thinned_power": 0.4, "thinning_deg_per_s": 0.0, "lag_s": 1.0},
        {"power": 1.0, "lag_s": 1.0, "approach_s": 0.0},
    ],
)
def test_a_shape_that_is_none_is_refused(shape: dict[str, float]) -> None:
    content = {"name": "viscous_drag", "shape": shape, "amplitudes": {"drag_nm": 1.0}}
    with pytest.raises(cs.InputError, match="viscous_drag"):
        EffectValue.from_dict(content)


def noisy() -> cs.Recording:
    """Recording of drag beside a stiffening, with noise of 0.01 deg."""
    angle = twist(DRAG, STIFFENING)
    return programme().with_angle(angle + np.random.default_rng(2).normal(0.0, 0.01, len(angle)))


def test_drag_and_stiffening_are_found_together() -> None:
    diagnosis = cs.diagnose(noisy(), cs.Drive.reference_87(), full=False)
    assert diagnosis.verdict == "IDENTIFIED"
    assert {each["name"] for each in diagnosis.effects} == {"viscous_drag", "contact_stiffening"}
    # With a stiffening of the whole torque 0.02 is left.
    assert diagnosis.content["repaired"]["rmse_deg"] < 0.0105


def test_a_fit_without_drag_forgets_that_of_the_fit_before() -> None:
    search = search_of_recording(noisy())
    terms = (
        Term(find("viscous_drag"), {"power": 1.0, "lag_s": 0.7}),
        Term(find("contact_stiffening"), {"cubic_nm": 6.0}),
    )
    both = fit(search.problem, search.noise, terms, search.baseline.fit)
    assert both.history.drag_compliance is not None
    alone = fit(search.problem, search.noise, terms[1:], both)
    assert alone.history.drag_compliance is None
