"""Every effect of the vocabulary: words, shapes, columns, and what makes it untestable."""

from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.simulation import effects
from cyclosweep.simulation.effects import VOCABULARY, Effect, History, Parameter, Shape
from tests.support.arrays import Floats

NAMES = [
    "friction_hysteresis",
    "load_dependent_friction",
    "contact_stiffening",
    "clearance_takeup",
    "overload_softening",
    "datum_drift",
    "creep",
    "phase_dependent_compliance",
    "transmission_error",
    "thermal_drift",
    "viscous_drag",
    "load_asymmetry",
    "dial_eccentricity",
]


def history(**changes: Any) -> History:
    runs = 5
    path = np.concatenate([np.linspace(0.5, 20, 40), np.linspace(20, -20, 80), [-10.0, -0.5]])
    torque = np.tile(path, runs)
    n = len(torque)
    run = np.repeat(np.arange(runs), len(path))
    side = np.where(torque > 0, 1.0, -1.0)
    known = {
        "applied_nm": torque,
        "elastic_nm": torque,
        "angle_deg": 28 * side + 2.7 * torque,
        "side": side,
        "run": run,
        "restart": np.r_[True, np.diff(run) != 0],
        "compliance_deg_per_nm": 2.7,
        "free_play_deg": 28.0,
        "time_s": np.arange(n, dtype=float) + 100.0 * run,
        "crank_deg": 70.0 * run,
        "temperature_c": 20.0 + 0.01 * np.arange(n),
    }
    return History(**(known | changes))


def test_vocabulary_is_complete_and_in_order() -> None:
    assert [effect.name for effect in VOCABULARY] == NAMES


@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_effect_says_what_it_is(effect: Effect) -> None:
    assert effect.physics.count(".") >= 2
    assert effect.source
    assert effect.tell_tale
    assert effect.family
    assert effect.shown_by != Effect.shown_by


@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_columns_match_amplitudes(effect: Effect) -> None:
    h = history()
    assert effect.untestable(h) is None
    shapes = effect.shapes(h)
    assert shapes
    for shape in shapes:
        columns = effect.columns(h, shape)
        assert columns.shape[0] == len(h)
        assert np.all(np.isfinite(columns))
        named = len(effect.amplitudes(shape))
        assert named >= columns.shape[1] if "each_run" in shape else named == columns.shape[1]
    assert any(np.any(effect.columns(h, shape)) for shape in shapes)


NEEDS = {
    "creep": {"time_s"},
    "viscous_drag": {"time_s"},
    "phase_dependent_compliance": {"crank_deg"},
    "transmission_error": {"crank_deg"},
    "thermal_drift": {"temperature_c"},
}


@pytest.mark.parametrize("column", ["time_s", "crank_deg", "temperature_c"])
@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_missing_column_makes_untestable_what_needs_it_and_nothing_else(
    effect: Effect, column: str
) -> None:
    # The mesh hardly travels, so that its positions are those that were recorded.
    hardly = {"angle_deg": np.linspace(0.0, 59.0, 610)}
    reason = effect.untestable(history(**{column: None}, **hardly))
    if column in NEEDS.get(effect.name, set()):
        assert column in str(reason)
    else:
        assert reason is None


SHORT = {"angle_deg": np.linspace(0.0, 59.0, 610)}
WITHOUT_CRANK = ({"crank_deg": None} | SHORT, "crank_deg")
TWO_PLACES = ({"crank_deg": np.repeat([0.0, 90.0], 305)} | SHORT, "fewer than three positions")
WITHOUT_CLOCK = ({"time_s": None}, "time_s")
HIDDEN: dict[str, list[tuple[dict[str, Any], str]]] = {
    "friction_hysteresis": [],
    "load_dependent_friction": [],
    "contact_stiffening": [],
    "clearance_takeup": [],
    "overload_softening": [],
    "datum_drift": [
        ({"resets_datum": True}, "reset"),
        ({"run": np.repeat([0, 1], 305)}, "three runs"),
    ],
    "creep": [WITHOUT_CLOCK],
    "phase_dependent_compliance": [
        WITHOUT_CRANK,
        TWO_PLACES,
    ],
    "transmission_error": [
        WITHOUT_CRANK,
        TWO_PLACES,
    ],
    "thermal_drift": [
        ({"temperature_c": None}, "temperature_c"),
        ({"temperature_c": np.linspace(20.0, 20.1, 610)}, "did not change"),
    ],
    "viscous_drag": [WITHOUT_CLOCK],
    "load_asymmetry": [({"side": np.ones(610)}, "one direction")],
    "dial_eccentricity": [({"angle_deg": np.linspace(0.0, 29.0, 610)}, "30 deg")],
}
"""What hides each effect, and a word of the reason; nothing hides the first five."""


@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_what_hides_an_effect(effect: Effect) -> None:
    everything = {"resets_datum": True} | dict.fromkeys(
        ("time_s", "crank_deg", "temperature_c"), None
    )
    one_run = {
        name: value[:60]
        for name, value in vars(history()).items()
        if isinstance(value, np.ndarray) and value.shape == (610,)
    }
    one_run |= {"side": np.ones(60), "angle_deg": np.linspace(0.0, 29.0, 60)}
    hidden = effect.untestable(history(**(one_run | everything)))
    assert (hidden is not None) == bool(HIDDEN[effect.name])
    for changes, word in HIDDEN[effect.name]:
        assert word in str(effect.untestable(history(**changes)))


PARAMETERS = {
    "friction_hysteresis": {"slip_deg", "scatter", "skew"},
    "load_dependent_friction": {"slip_deg", "scatter", "skew"},
    "contact_stiffening": {"turn_nm", "power", "squeeze_nm", "cubic_nm"},
    "clearance_takeup": {"first_nm", "range_nm", "middle_nm", "spread"},
    "overload_softening": {"onset_nm", "power"},
    "datum_drift": {"memory"},
    "creep": {"time_constant_s"},
    "phase_dependent_compliance": {"travel_order_1"},
    "transmission_error": {"travel_order_1"},
    "thermal_drift": {"delay_s"},
    "viscous_drag": {"power"},
    "load_asymmetry": {"power", "limit_nm"},
    "dial_eccentricity": set(),
}
"""What the fit refines of each effect, of the shapes on the grid."""


@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_grid_lies_within_the_bounds(effect: Effect) -> None:
    seen = set()
    # Orders are fitted where no position of the mesh was recorded, and are whole numbers else.
    grid = [(h, shape) for h in (history(), history(crank_deg=None)) for shape in effect.shapes(h)]
    for h, shape in grid:
        for parameter in effect.shape_parameters:
            if parameter.name in shape:
                bounds = effect.shape_bounds(parameter, h)
                assert bounds.lower <= shape[parameter.name] * (1 + 1e-9)
                if parameter.name != "range_nm":
                    # The widest range of engagement is looked for, but cut to the bound in fits.
                    assert shape[parameter.name] <= bounds.upper * (1 + 1e-9)
                seen.add(parameter.name)
    assert seen == PARAMETERS[effect.name]


@pytest.mark.parametrize("effect", VOCABULARY, ids=lambda e: e.name)
def test_shapes_are_known_in_any_order(effect: Effect) -> None:
    h = history()
    shapes = [v for shape in effect.shapes(h) for v in effect.variants(h, shape)]
    for shape in shapes:
        turned = {name: shape[name] for name in reversed(list(shape))}
        assert effect.known_shape(turned) == shape
        known = effect.amplitudes(effect.known_shape(turned))
        assert [p.name for p in known] == [p.name for p in effect.amplitudes(shape)]
    with pytest.raises(cs.InputError, match="of_a_test"):
        effect.known_shape({**shapes[0], "of_a_test": 1.0})


BOUNDS_NM = {
    ("overload_softening", "onset_nm"): (0.0, 18.4),
    ("clearance_takeup", "first_nm"): (0.0, 9.0),
    ("clearance_takeup", "range_nm"): (0.02, 18.0),
    ("contact_stiffening", "turn_nm"): (0.02, 5.0),
}


@pytest.mark.parametrize(("name", "parameter"), BOUNDS_NM)
def test_loads_are_bound_by_the_largest_of_20_nm(name: str, parameter: str) -> None:
    effect = effects.find(name)
    (own,) = (p for p in effect.shape_parameters if p.name == parameter)
    bounds = effect.shape_bounds(own, history())
    assert (bounds.lower, bounds.upper) == pytest.approx(BOUNDS_NM[name, parameter])


def test_times_are_bound_by_the_step_and_the_recording() -> None:
    h = history()
    creep, thermal = effects.find("creep"), effects.find("thermal_drift")
    assert creep.shape_bounds(creep.shape_parameters[0], h).lower == pytest.approx(3.0)
    delay = thermal.shape_bounds(thermal.shape_parameters[0], h)
    assert delay.upper == pytest.approx(0.25 * (609.0 + 400.0))


def test_friction_is_bound_by_the_torque() -> None:
    h = history()
    shape = {"slip_deg": 0.5, "scatter": 0.5}
    for name, upper in (("friction_hysteresis", 20.0), ("load_dependent_friction", 0.9)):
        (amplitude,) = effects.find(name).amplitude_bounds(h, shape)
        assert (amplitude.lower, amplitude.upper) == pytest.approx((0.0, upper))


def test_loops_usually_show_friction_stiffening_and_asymmetry() -> None:
    begun = {e.name: e.usual_start(history(), 0.05, 0.02) for e in VOCABULARY}
    starts = {name: start for name, start in begun.items() if start is not None}
    assert {name: amplitude for name, (_, amplitude) in starts.items()} == pytest.approx(
        {
            "friction_hysteresis": 1.0,
            "load_dependent_friction": 0.2,
            "contact_stiffening": 0.3 * 2.7,
            "load_asymmetry": 1e-3,
        }
    )
    for name in ("friction_hysteresis", "load_dependent_friction"):
        assert starts[name][0]["slip_deg"] == pytest.approx(0.02 * 20 * 2.7)


def test_friction_takes_from_the_twist_while_loading() -> None:
    h = history()
    column = effects.find("friction_hysteresis").columns(
        h, {"slip_deg": 0.5, "scatter": 0.5, "slack": 0.0}
    )[:, 0]
    assert column[30] == pytest.approx(-2.7)
    assert column[80] == pytest.approx(2.7)


def test_takeup_only_stiffens_beyond_its_first_engagement() -> None:
    h = history()
    column = effects.find("clearance_takeup").columns(h, {"first_nm": 10.0, "range_nm": 2.0})[:, 0]
    assert np.all(column[np.abs(h.applied_nm) < 10] == 0)
    assert column[39] == pytest.approx(-(10 - 1.0))


def test_pins_engage_one_after_another_from_a_low_load_on() -> None:
    h = history()
    top = h.largest_torque_nm
    shapes = effects.find("clearance_takeup").shapes(h)
    ranges = [s for s in shapes if "first_nm" in s]
    assert all(0 < s["first_nm"] <= 0.41 * top and s["range_nm"] >= 0.09 * top for s in ranges)
    scattered = [s for s in shapes if "first_nm" not in s]
    # About 5 % are closed without load at most, and half of them by the middle of the range.
    assert all(0.09 * top < s["middle_nm"] < 0.56 * top for s in scattered)
    assert all(1.0 / (1.0 + np.exp(1.0 / s["spread"])) < 0.055 for s in scattered)
    assert max(s["first_nm"] + s["range_nm"] for s in ranges) > top


def test_free_offsets_are_memory_only_if_one_memory_explains_them() -> None:
    largest = np.array([20.0, 8.0, 14.0, 4.0, 18.0, 10.0, 6.0, 16.0, 12.0, 5.0, 19.0, 9.0])
    torque = np.concatenate([[t, -0.5 * t, 0.7 * t, 0.2] for t in largest])
    run = np.repeat(np.arange(12), 4)
    h = History(
        applied_nm=torque,
        elastic_nm=torque,
        angle_deg=2.7 * torque,
        side=np.sign(torque),
        run=run,
        restart=np.r_[True, np.diff(run) != 0],
        compliance_deg_per_nm=2.7,
        free_play_deg=28.0,
    )
    datum = effects.find("datum_drift")

    def offsets(memory: float, other: float) -> Floats:
        shape = {"push": 1.0, "memory": memory, "push_2": 2.0, "memory_2": other}
        shift = datum.columns(h, shape)[h.run_starts] @ [1.0, 0.5]
        return np.asarray(shift[1:] - shift[0])

        return shift[1:] - shift.mean()

    assert datum.is_recognised(h, {"each_run": 1.0}, offsets(0.4, 0.4))
    # Two pushes with a memory each would leave 0.04 of this random walk.
    wandering = np.array([0.0, 2.0, 2.7, 3.4, 2.8, 1.2, 1.4, 1.5, 0.2, -0.4, -0.5, -1.5])
    assert not datum.is_recognised(h, {"each_run": 1.0}, (wandering - wandering.mean())[1:])


def test_datum_remembers_the_run_before() -> None:
    h = history()
    column = effects.find("datum_drift").columns(h, {"push": 0.0, "memory": 0.5})[:, 0]
    per_run = column[h.run_starts]
    np.testing.assert_allclose(per_run, [0, 1, 1.5, 1.75, 1.875])


def test_balanced_loops_push_the_datum_by_no_rounding() -> None:
    loop = 20.0 * np.r_[np.linspace(0, 1, 31), np.linspace(1, -1, 60), np.linspace(-1, 0, 31)]
    h = history(applied_nm=np.tile(loop, 5), elastic_nm=np.tile(loop, 5))
    mean, balance = 5.0, 3.0
    for shape in effects.find("datum_drift").shapes(h):
        assert not {mean, balance} & {shape.get("push"), shape.get("push_2")}
    # Loops that lie to one side by more and more push by their mean and by their imbalance.
    torque = np.concatenate([loop + bias for bias in (1.0, -2.0, 3.0, 0.0, 2.0)])
    biased = history(applied_nm=torque, elastic_nm=torque)
    pushes = {s.get("push") for s in effects.find("datum_drift").shapes(biased)}
    assert pushes & {mean, balance}


@pytest.mark.parametrize("name", ["friction_hysteresis", "load_dependent_friction"])
def test_loading_alone_bounds_no_friction(name: str) -> None:
    effect = effects.find(name)

    def reason(*turns: float, restart: bool = True) -> str | None:
        """Why three runs through these torques, 61 rows a leg, give no bound of friction."""
        legs = [np.linspace(a, b, 61) for a, b in pairwise(turns)]
        torque = np.tile(np.concatenate(legs), 3)
        run = np.repeat([0, 1, 2], len(torque) // 3)
        return effect.unbounded(
            History(
                applied_nm=torque, elastic_nm=torque, angle_deg=2.7 * torque,
                side=np.where(torque >= 0, 1.0, -1.0), run=run,
                restart=np.r_[True, (np.diff(run) != 0) & restart],
                compliance_deg_per_nm=2.7, free_play_deg=28.0,
            )
        )  # fmt: skip

    assert "unloaded" in str(reason(0.5, 12.0))
    assert "unloaded" in str(reason(-0.5, -12.0))
    assert "unloaded" in str(reason(0.5, 12.0, 11.9)), "next to nothing"
    assert reason(0.5, 12.0, 11.0) is None, "in part"
    assert reason(0.5, 6.0, 4.0, 12.0) is None, "a small loop on the way"
    assert reason(12.0, 0.5) is None, "unloading alone"
    assert reason(0.5, 12.0, restart=False) is None, "unloaded between the runs"


def test_one_direction_hides_asymmetry() -> None:
    h = history(side=np.ones(610))
    assert "one direction" in str(effects.find("load_asymmetry").untestable(h))


def test_pushes_alike_in_all_runs_are_one_law() -> None:
    # Five equal loops push by the same each: the number of runs stands for all of it.
    shapes = effects.find("datum_drift").shapes(history())
    assert {s.get("push", 0.0) for s in shapes} == {0.0}
    assert not any("push_2" in s or "reset" in s for s in shapes)


def test_users_register_their_own() -> None:
    class Wobble(Effect):
        name = "wobble_of_a_test"
        physics = "A table wobbles. It does so with the torque."
        source = "made up"
        tell_tale = "none"
        family = "smooth odd curve"

        def shapes(self, history: History) -> list[Shape]:
            return [{}]

        def columns(self, history: History, shape: Shape) -> Floats:
            return np.sin(history.elastic_nm)[:, None]

        def amplitudes(self, shape: Shape) -> tuple[Parameter, ...]:
            return (Parameter("wobble_deg", "deg", "size of the wobble"),)

    try:
        effects.register(Wobble())
        assert effects.find("wobble_of_a_test") in effects.effects()
        with pytest.raises(ValueError, match="registered already"):
            effects.register(Wobble())
    finally:
        effects._REGISTERED.pop("wobble_of_a_test", None)


def test_unknown_effect_is_named() -> None:
    with pytest.raises(ValueError, match="nonsense"):
        effects.find("nonsense")
