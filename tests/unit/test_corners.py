"""Corners of a load programme between two readings."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
import cyclosweep.simulation.effects.history as history_module
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.corners import Corners, find_corners
from cyclosweep.simulation.effects.slip_path import slip_state
from cyclosweep.simulation.model import EffectValue
from cyclosweep.simulation.simulate import history_of, predict_history
from tests.support.arrays import Floats, present

PEAKS_NM = (0.0, 12.6, 4.1, 13.3, -11.7, -3.2, -12.4, 0.0)
RATE_NM_S = 0.9
COMPLIANCE = 1.4
MODEL = cs.Model(compliance_deg_per_nm=COMPLIANCE, free_play_deg=14.0)
FRICTION = EffectValue("friction_hysteresis", {"slip_deg": 0.5, "scatter": 0.4}, (1.2,))
BEHIND = EffectValue(
    "friction_hysteresis", {"slip_deg": 0.5, "scatter": 0.4, "behind_play": 1.0}, (1.2,)
)
LOADED = EffectValue("load_dependent_friction", {"slip_deg": 0.5, "scatter": 0.4}, (0.1,))
DRAG = EffectValue("viscous_drag", {"power": 0.7, "lag_s": 0.8}, (0.9,))


def programme(step_s: float, begun_s: float = 0.37) -> tuple[Floats, Floats]:
    """Clock and torque of even ramps between the peaks, read with this step."""
    peaks = np.array(PEAKS_NM)
    at_peak = np.r_[0.0, np.cumsum(np.abs(np.diff(peaks)) / RATE_NM_S)]
    time = np.arange(begun_s, at_peak[-1], step_s)
    return time, np.interp(time, at_peak, peaks)


def corners_of(time: Floats, torque: Floats) -> Corners:
    return find_corners(torque, time, np.arange(len(time)) == 0)


def test_even_ramps_turn_where_their_lines_meet() -> None:
    time, torque = programme(1.0)
    found = corners_of(time, torque)
    np.testing.assert_allclose(found.torque_nm, PEAKS_NM[1:-1], atol=1e-12)
    at_s = time[found.before] + found.share * np.diff(time)[found.before]
    at_peak = np.cumsum(np.abs(np.diff(PEAKS_NM)) / RATE_NM_S)
    np.testing.assert_allclose(at_s, at_peak[:-1], atol=1e-9)


def test_a_leg_of_two_readings_turns_by_the_rate_of_the_others() -> None:
    peaks = np.array([0.0, 12.6, 10.2, 12.3, 0.4])
    at_s = np.r_[0.0, np.cumsum(np.abs(np.diff(peaks)) / RATE_NM_S)]
    time = np.arange(0.3, at_s[-1], 1.0)
    found = corners_of(time, np.interp(time, at_s, peaks))
    np.testing.assert_allclose(found.torque_nm, peaks[1:-1], atol=1e-12)


def test_rates_that_agree_by_chance_make_no_corner() -> None:
    for seed in range(20):
        torque = 20.0 + np.cumsum(np.random.default_rng(seed).normal(0.0, 1.0, 2000))
        assert not len(corners_of(np.arange(2000.0), torque))


def test_a_ramp_that_is_held_has_a_corner_at_the_load_held() -> None:
    time = np.arange(0.3, 30.0, 1.0)
    found = corners_of(time, np.minimum(0.7 * time, 9.1))
    np.testing.assert_allclose(found.torque_nm, [9.1], atol=1e-12)


@pytest.mark.parametrize(
    "torque",
    [
        np.tile(np.r_[np.arange(1.0, 9.0), np.arange(9.0, 1.0, -1.0)], 3),
        9.0 + 5.0 * np.sin(np.arange(60) / 3.0),
        programme(1.0)[1][:40] + np.random.default_rng(1).normal(0.0, 0.1, 40),
        np.r_[np.arange(-8.3, 8.0), np.arange(7.7, -8.0, -1.0)][4:14],
        np.r_[np.arange(1.0, 11.0), np.arange(10.0, 0.0, -1.0)],
        np.arange(3.0),
    ],
    ids=["turns at readings", "smooth", "noise", "through zero", "held", "too few readings"],
)
def test_what_is_not_known_is_no_corner(torque: Floats) -> None:
    assert not len(corners_of(np.arange(float(len(torque))), torque))


@pytest.mark.parametrize("sag_nm", [0.0, 0.5])
def test_a_load_held_between_two_readings_is_no_corner(sag_nm: float) -> None:
    # Ramps that were drawn through a hold of a minute met at four times the load.
    torque = np.r_[np.arange(1.0, 11.0), np.arange(10.0 - sag_nm, 1.0, -1.0)]
    time = np.arange(float(len(torque))) + 20.0 * (np.arange(len(torque)) > 9)
    assert not len(corners_of(time, torque))


def test_nothing_is_known_between_the_runs_of_a_continuous_history() -> None:
    torque = np.r_[np.arange(1.0, 11.0), np.arange(9.6, 1.0, -1.0)]
    time, run = np.arange(float(len(torque))), np.repeat([1, 2], [10, 9])
    loads = [
        cs.Recording.from_arrays(torque, time_s=time, run=label, history="continuous")
        for label in (run, np.ones_like(run))
    ]
    found = [len(history_of(load, MODEL).corners) for load in loads]
    assert found == [0, 1]


def test_what_was_solved_at_corners_goes_with_the_torque_it_was_solved_for() -> None:
    time, torque = programme(1.0)
    solved = predict_history(
        replace(MODEL, effects=(FRICTION,)), cs.Recording.from_arrays(torque, time_s=time)
    )
    assert solved.corner_deg is not None
    assert len(solved.corner_deg) == len(solved.corners) > 0
    moved = solved.with_state(elastic_nm=solved.applied_nm)
    assert moved.corner_deg is None
    assert moved.corner_nm is None
    assert solved.with_state(side=solved.side).corner_deg is solved.corner_deg
    again = slip_state(solved, FRICTION.shape)
    friction = solved.applied_nm - solved.elastic_nm
    np.testing.assert_allclose(1.2 * again, friction, atol=1e-6)


def test_friction_that_turns_at_the_readings_knows_no_corner() -> None:
    time, torque = programme(1.0)
    load = cs.Recording.from_arrays(torque, time_s=time)
    shape = dict(FRICTION.shape) | {"by_reading": 1.0}
    at_readings = replace(MODEL, effects=(EffectValue("friction_hysteresis", shape, (1.2,)),))
    without = cs.simulate(replace(MODEL, effects=(FRICTION,)), replace(load, time_s=None))
    np.testing.assert_allclose(
        present(cs.simulate(at_readings, load).angle_deg), present(without.angle_deg), atol=1e-9
    )


def test_a_torque_that_is_predicted_has_no_corners() -> None:
    time, torque = programme(1.0)
    model = replace(MODEL, effects=(FRICTION,))
    load = cs.Recording.from_arrays(torque, time_s=time)
    twisted = cs.simulate(model, replace(load, time_s=None))
    back = cs.simulate(model, replace(twisted, time_s=time), predict="torque")
    carried = np.abs(present(twisted.angle_deg)) > 14.5
    np.testing.assert_allclose(back.torque_nm[carried], torque[carried], atol=1e-6)


@pytest.mark.parametrize("rows", [1, 2])
@pytest.mark.parametrize("power", [0.7, 1.0])
def test_drag_of_a_single_reading_is_finite(rows: int, power: float) -> None:
    drag = EffectValue("viscous_drag", {"power": power, "lag_s": 0.8}, (0.9,))
    load = cs.Recording.from_arrays(np.full(rows, 2.0), time_s=np.zeros(rows))
    angle = cs.simulate(replace(MODEL, effects=(drag,)), load).angle_deg
    assert np.all(np.isfinite(present(angle)))


@pytest.mark.parametrize(("name", "value"), [("lag_s", -1.0), ("lag_s", 0.0), ("by_reading", 0.3)])
def test_a_drag_that_is_none_is_refused(name: str, value: float) -> None:
    with pytest.raises(cs.InputError, match=name):
        find("viscous_drag").known_shape({"power": 1.0, "lag_s": 1.0, name: value})


def test_without_a_clock_or_across_a_restart_no_corner_is_known() -> None:
    time, torque = programme(1.0)
    assert not len(find_corners(torque, None, np.arange(len(time)) == 0))
    all_found = corners_of(time, torque)
    restart = np.arange(len(time)) == 0
    restart[all_found.before[0] + 1] = True
    assert len(find_corners(torque, time, restart)) == len(all_found) - 1


@pytest.mark.parametrize(
    "effects",
    [(FRICTION,), (BEHIND,), (LOADED,), (DRAG,), (FRICTION, DRAG)],
    ids=["friction", "behind the play", "load-dependent", "drag", "friction and drag"],
)
def test_a_forecast_does_not_hang_on_how_often_the_torque_is_read(
    effects: tuple[EffectValue, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    model = replace(MODEL, effects=effects)

    def twist(every: int) -> Floats:
        time, torque = programme(0.05)
        load = cs.Recording.from_arrays(torque[::every], time_s=time[::every])
        return np.asarray(cs.simulate(model, load).angle_deg)

    fine = twist(1)[::20]
    missed = np.max(np.abs(twist(20) - fine))
    none = find_corners(np.zeros(0), None, np.zeros(0, dtype=bool))
    monkeypatch.setattr(history_module, "find_corners", lambda *_: none)
    without_corners = np.max(np.abs(twist(20) - fine))
    assert without_corners > 0.3
    assert missed < 0.1
