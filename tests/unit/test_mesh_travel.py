"""Position of the mesh while the shaft twists: what it is, and what stands on it."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.whole_loop.forecast import Forecast
from cyclosweep.diagnosis.whole_loop.staircase_found import named_staircase
from cyclosweep.simulation.effects import find
from cyclosweep.simulation.effects.mesh_range import (
    LEAST_PHASE_DEG,
    LEAST_TRAVEL_DEG,
    mesh_positions,
    position_count,
)
from cyclosweep.simulation.effects.order_names import orders_of
from cyclosweep.simulation.effects.orders import (
    CYCLE_STEP,
    HIGHEST_LOW_ORDER,
    travel_deg,
    travel_shapes,
)
from cyclosweep.simulation.model import EffectValue, linear_twist
from cyclosweep.simulation.simulate import history_of
from tests.support.travelling_mesh import COMPLIANCE, PLAY, ramp, recording, staircase, twist
from tests.unit.test_effects import history

WAVE = (7.0, 1.5, 20.0)
"""Order, amplitude [deg] and crest [deg]."""


def model(scale: float = 1.0, friction_nm: float = 0.0, size: float = WAVE[1]) -> cs.Model:
    """Model with the staircase, measured at the input or, with a scale, at the output."""
    order, _, crest = WAVE
    wave = (
        scale
        * size
        * np.array([np.cos(np.radians(order * crest)), np.sin(np.radians(order * crest))])
    )
    effects = [
        EffectValue(
            "transmission_error",
            {"travel_ratio": 1.0 / scale, "travel_order_1": order},
            tuple(wave),
        )
    ]
    if friction_nm:
        shape = {"slip_deg": 1.7 * scale, "scatter": 0.8}
        effects.insert(0, EffectValue("friction_hysteresis", shape, (friction_nm,)))
    return cs.Model(
        compliance_deg_per_nm=COMPLIANCE * scale,
        free_play_deg=PLAY * scale,
        side="input" if scale == 1.0 else "output",
        effects=tuple(effects),
    )


@pytest.mark.parametrize("scale", [1.0, 1.0 / 13.0])
def test_simulation_finds_the_position_that_bisection_finds(scale: float) -> None:
    torque = ramp((0.5, 30.0, -30.0, 0.5), 0.25)
    programme = cs.Recording.from_arrays(torque, side="input" if scale == 1.0 else "output")
    found = cs.simulate(model(scale), programme).angle_deg
    assert found is not None
    # Without torque the shaft stands anywhere in its play.
    loaded = np.abs(torque) > 1e-6
    expected = twist(torque, [WAVE], scale=scale)
    assert found[loaded] == pytest.approx(expected[loaded], abs=1e-6 * scale)


def test_simulation_is_a_fixed_point_where_the_staircase_is_nearly_as_steep_as_the_travel() -> None:
    steep = model(size=0.97 / np.radians(WAVE[0]))
    programme = cs.Recording.from_arrays(ramp((0.5, 30.0, 0.5), 0.1))
    angle = cs.simulate(steep, programme).angle_deg
    assert angle is not None
    at = history_of(programme, steep).with_state(angle_deg=angle)
    straight = PLAY + COMPLIANCE * programme.torque_nm
    assert angle == pytest.approx(straight + linear_twist(steep.effects, at), abs=1e-8)


def test_friction_and_staircase_settle_on_each_other() -> None:
    rough = model(friction_nm=1.0)
    programme = cs.Recording.from_arrays(ramp((0.5, 30.0, -30.0, 0.5), 0.25))
    angle = cs.simulate(rough, programme).angle_deg
    assert angle is not None
    # Less the staircase at its own angle, the path is that of friction alone, pushed by it.
    plain = np.asarray(angle - staircase(angle, [WAVE]))
    smooth = cs.simulate(
        cs.Model(**{**vars(rough), "effects": rough.effects[:1]}), programme
    ).angle_deg
    assert smooth is not None
    loaded = np.abs(programme.torque_nm) > 2.0
    assert np.max(np.abs((plain - smooth)[loaded])) < 0.35 * WAVE[1]
    assert np.max(np.abs((angle - smooth)[loaded])) > 0.8 * WAVE[1]


def test_position_is_where_it_was_locked_and_the_travel_since() -> None:
    known = history(crank_deg=np.full(610, 30.0))
    at_output = known.mesh_deg(13.0)
    assert at_output == pytest.approx(30.0 + 13.0 * known.angle_deg)
    assert history(crank_deg=None).mesh_deg(1.0) == pytest.approx(known.angle_deg)
    measured = known.with_state(measured_deg=known.angle_deg + 1.0)
    assert measured.mesh_deg(13.0) == pytest.approx(at_output + 13.0)


def test_orders_go_with_the_locking_position_and_with_the_travel_where_it_is_far() -> None:
    effect = find("transmission_error")
    stayed = history(angle_deg=np.linspace(0.0, 0.9 * LEAST_PHASE_DEG / HIGHEST_LOW_ORDER, 610))
    locked = effect.shapes(stayed)
    assert all("travel_ratio" not in shape for shape in locked)
    travelled = effect.shapes(history())
    assert travelled[: len(locked)] == locked
    assert [list(shape.values()) for shape in travelled[len(locked) :]] == [
        [1.0, *shape.values()] for shape in locked if max(shape.values()) <= HIGHEST_LOW_ORDER
    ]


def test_a_high_order_goes_through_more_of_its_cycle_on_the_same_way() -> None:
    """Left out, its travel looked like a compliance that pulsates with the position."""
    short = history(angle_deg=np.linspace(0.0, 0.8 * LEAST_PHASE_DEG, 610))
    shapes = find("transmission_error").shapes(short)
    highest = {max(orders_of(shape)) for shape in shapes if "travel_ratio" in shape}
    assert highest == {2.0, 3.0}


def test_a_law_of_several_positions_is_described_whatever_the_number_of_loads() -> None:
    few = history(applied_nm=np.where(history().side > 0, 10.0, -10.0))
    assert travel_deg(few) == 0.0
    shape = {"travel_ratio": 1.0, "order_1": 2.0}
    words = find("transmission_error").found_law(few, shape, np.array([0.0, 1.0]))
    assert "order 2 (crest at 45 deg)" in words
    assert "since" in words
    for other in ({"order_1": 1.0}, {"travel_ratio": 1.0, "travel_order_1": 7.0}):
        assert find("transmission_error").combined(shape, other) is None
        assert find("transmission_error").combined(other, shape) is None
    joined = {"travel_ratio": 1.0, "order_1": 1.0, "order_2": 2.0, "order_3": 3.0}
    low = {"travel_ratio": 1.0, "order_1": 1.0, "order_2": 3.0}
    assert find("transmission_error").combined(shape, low) == joined


@pytest.mark.parametrize(
    "hidden",
    [
        {"angle_deg": np.linspace(0.0, 0.9 * LEAST_PHASE_DEG / HIGHEST_LOW_ORDER, 610)},
        {"crank_deg": np.tile([0.0, 0.5, 59.0, 359.5], 153)[:610]},
        {"applied_nm": np.tile([-20.0, -10.0, 10.0, 15.0, 20.0], 122)},
    ],
    ids=["little travel", "neighbouring positions", "few loads"],
)
def test_low_orders_of_a_travel_are_not_looked_for_where_another_cause_is_the_same(
    hidden: dict[str, np.ndarray],
) -> None:
    assert all(
        "travel_ratio" not in shape
        for shape in find("transmission_error").shapes(history(**hidden))
    )


def test_whole_orders_are_not_fitted_and_have_a_usual_size() -> None:
    effect = find("transmission_error")
    travelling = {"travel_ratio": 1.0, "order_1": 1.0, "order_2": 2.0}
    known = history()
    size = effect.expected(known, travelling)
    assert size == pytest.approx(effect.expected(known, {"order_1": 1.0, "order_2": 2.0}))
    assert not {p.name for p in effect.shape_parameters} & set(travelling)
    assert effect.expected(known, {"travel_ratio": 1.0, "travel_order_1": 2.0}) is None
    # A turn of the locking position is the same position.
    assert known.crank_deg is not None
    turned = known.with_state(crank_deg=known.crank_deg + 360.0)
    assert effect.columns(turned, travelling) == pytest.approx(effect.columns(known, travelling))


def test_a_travelling_mesh_is_looked_for_where_no_position_was_recorded() -> None:
    effect = find("transmission_error")
    fixed = history(crank_deg=None)
    assert all("travel_ratio" in shape for shape in effect.shapes(fixed))
    angle = np.linspace(0.0, LEAST_TRAVEL_DEG - 1.0, 610)
    short = history(crank_deg=None, angle_deg=angle, free_play_deg=0.0)
    assert "59 deg" in str(effect.untestable(short))
    assert effect.untestable(short.with_state(mesh_ratio=13.0)) is None


def test_the_play_is_no_travel_under_load() -> None:
    side = np.repeat([-1.0, 1.0], 305)
    torque = np.linspace(-20.0, 20.0, 610)
    both = history(
        crank_deg=None, applied_nm=torque, side=side, angle_deg=20.0 * side + torque,
        free_play_deg=20.0,
    )  # fmt: skip
    assert travel_deg(both) == pytest.approx(40.0)
    assert "40 deg" in str(find("transmission_error").untestable(both))
    orders = [shape["travel_order_1"] for shape in travel_shapes(both)]
    assert orders[0] == pytest.approx(3.0 * 360.0 / 40.0)
    assert np.diff(orders) == pytest.approx(CYCLE_STEP * 360.0 / 80.0)
    # A reading without load on the other flank is no travel through the play.
    light = both.with_state(side=np.where(np.abs(torque) < 0.5, -1.0, 1.0))
    assert travel_deg(light) == pytest.approx(80.0)
    one = both.with_state(side=np.ones(610))
    assert travel_deg(one) == pytest.approx(80.0)
    assert min(s["travel_order_1"] for s in travel_shapes(one)) == pytest.approx(3.0 * 360.0 / 80.0)


def test_one_cycle_and_two_a_turn_of_the_shaft_are_left_to_the_dial() -> None:
    turning = history(crank_deg=None, angle_deg=np.linspace(0.0, 360.0 * 5.0, 610))
    cycles = [s["travel_order_1"] * 5.0 for s in travel_shapes(turning)]
    assert min(abs(each - 5.0) for each in cycles) > CYCLE_STEP
    assert min(abs(each - 10.0) for each in cycles) > CYCLE_STEP
    assert find("dial_eccentricity").untestable(turning) is None


def test_a_staircase_goes_through_a_model_file(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    path.write_text(model(1.0 / 13.0).to_json())
    assert cs.Model.from_json(path) == model(1.0 / 13.0)


def test_a_programme_needs_the_locking_position_where_orders_are_counted_from_it() -> None:
    load = cs.Recording.from_arrays([1.0, 5.0])
    assert len(cs.simulate(model(), load)) == 2
    for shape in ({"order_1": 1.0}, {"travel_ratio": 1.0, "order_1": 1.0}):
        recorded = cs.Model(
            1.0, 2.0, effects=(EffectValue("transmission_error", shape, (0.1, 0.2)),)
        )
        with pytest.raises(cs.InputError, match="crank_deg"):
            cs.simulate(recorded, load)


def test_a_staircase_steeper_than_the_travel_is_said() -> None:
    effect, shape = find("transmission_error"), {"travel_ratio": 1.0, "travel_order_1": 7.0}
    steep = 1.05 / np.radians(7.0)
    assert "jumps" in effect.notes(history(), shape, np.array([0.0, steep]))[0]
    assert effect.notes(history(), shape, np.array([0.0, 0.9 * steep])) == ()


def test_a_second_order_is_a_harmonic_where_it_is_near_one_and_else_its_own() -> None:
    effect = find("transmission_error")

    def both(first: float, second: float) -> list[float] | None:
        shapes = [{"travel_ratio": 1.0, "travel_order_1": each} for each in (first, second)]
        found = effect.combined(*shapes)
        return None if found is None else list(found.values())[1:]

    assert both(7.0, 14.6) == [7.0, 14.0]
    assert both(7.0, 11.0) == [7.0, 11.0]
    assert both(7.0, 8.0) is None


def test_made_recording_has_no_locking_position() -> None:
    assert recording([(0.5, 5.0, 0.5)], [WAVE]).crank_deg is None


@pytest.mark.parametrize(
    ("shape", "steps"),
    [
        ({"travel_ratio": 1.0, "travel_order_1": 7.0}, True),
        ({"travel_ratio": 1.0, "order_1": 1.0}, False),
    ],
)
def test_a_low_order_of_recorded_positions_is_no_staircase(
    shape: dict[str, float], steps: bool
) -> None:
    value = EffectValue("transmission_error", shape, (0.1, 0.2))
    forecast = SimpleNamespace(
        terms=(Term(find("transmission_error"), shape),),
        model=cs.Model(1.0, 2.0, effects=(value,)),
        history=history(),
    )
    assert (named_staircase(cast(Forecast, forecast)) is not None) == steps


def test_a_full_turn_is_the_position_that_it_started_from() -> None:
    crank = np.array([0.0, 359.97, 0.02, 360.0, 719.99, 359.9, 370.0, 10.0])
    np.testing.assert_array_equal(mesh_positions(crank), [0, 0, 0, 0, 0, 359.9, 10, 10])
    assert position_count(replace(history(), crank_deg=np.resize(crank, len(history())))) == 3
