"""Laws of the second generator have the properties for which they are known."""

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import integrate

from cyclosweep_challenge.second_generator.laws import catalogue, delay, elastic, strangers
from cyclosweep_challenge.second_generator.laws.balance import solve
from cyclosweep_challenge.second_generator.laws.friction import (
    BoucWen,
    Dahl,
    GeneralisedMaxwell,
    Jenkins,
    LuGre,
    Resistance,
    Stribeck,
)
from cyclosweep_challenge.second_generator.laws.law import Law, State
from cyclosweep_challenge.second_generator.laws.load_friction import (
    LinearDrag,
    LoadedDahl,
    Wedge,
)
from cyclosweep_challenge.second_generator.path import Path, make_path

Array = NDArray[np.float64]
SHAPE = {
    "reach": 0.1,
    "spread": 0.5,
    "power": 2.0,
    "beta": 0.5,
    "weakening": 0.3,
    "stribeck_speed": 0.05,
    "speed": 0.3,
    "attraction": 0.05,
    "lowering": 0.6,
    "top": 3.0,
}


def path_of(load: Array, step_s: float = 1.0, crank_deg: float = 40.0) -> Path:
    count = len(load)
    return Path(
        load,
        step_s * np.arange(1.0, count + 1.0),
        np.ones(count, dtype=np.int64),
        np.full(count, crank_deg),
        np.full(count, 20.0),
    )


def state_of(path: Path) -> State:
    side = np.sign(path.load)
    return State(path, path.load, side, 28.0 * side + 20.0 * path.load, 20.0, 1.0)


def loops(low: float = 1.0, high: float = 3.0, points: int = 400) -> Array:
    """Ramp to the middle and three full cycles."""
    ramp = np.linspace(low, high, points)
    return np.concatenate([np.linspace(0.01, low, 50), *[np.concatenate([ramp, ramp[::-1]])] * 3])


def area(load: Array, twist: Array, points: int = 400) -> float:
    """Work lost in the last cycle [rated torque times rated twist]."""
    last = slice(-2 * points, None)
    return float(np.abs(np.trapezoid(load[last], twist[last])))


def test_without_friction_the_twist_is_the_load() -> None:
    load = loops()
    twist, side = solve(path_of(load), [], 1.0)
    assert np.array_equal(twist, load)
    assert np.array_equal(side, np.where(load < 0.06, 0.0, 1.0))


@pytest.mark.parametrize("limit", [0.02, 0.1, 0.3])
def test_loop_area_of_coulomb_friction(limit: float) -> None:
    """A slider of limit F behind a spring of reach r loses 2 F (X - 2 r) over a stroke X."""
    load = loops()
    twist, _ = solve(path_of(load), [Jenkins(limit, SHAPE | {"spread": 0.0})], 0.1)
    stroke = twist[-800:].max() - twist[-800:].min()
    assert area(load, twist) == pytest.approx(2.0 * limit * (stroke - 0.2), rel=0.01)


@pytest.mark.parametrize("law", [Jenkins, Dahl, BoucWen, LuGre, GeneralisedMaxwell, Stribeck])
def test_steady_friction_is_the_limit_whatever_the_family(law: type[Resistance]) -> None:
    """Fast sliding far beyond presliding: the loop's width is twice the limit."""
    load = loops()
    path = path_of(load, step_s=0.002)
    twist, _ = solve(path, [law(0.1, SHAPE | {"power": 1.0})], 0.1)
    up, down = twist[-800:-400], twist[-400:]
    width = np.interp(2.0, up, load[-800:-400]) - np.interp(2.0, down[::-1], load[-400:][::-1])
    assert width == pytest.approx(0.2, rel=0.02)


@pytest.mark.parametrize("law", [LuGre, GeneralisedMaxwell, Stribeck])
def test_velocity_weakening_widens_the_slow_loop(law: type[Resistance]) -> None:
    """Limit and presliding travel are those of high speed times 1.3 where the motion is slow."""
    load = loops()
    shape = SHAPE | {"spread": 0.0}
    for step_s, factor in ((20.0, 1.3), (0.002, 1.0)):
        twist, _ = solve(path_of(load, step_s), [law(0.1, shape)], 0.1)
        stroke = twist[-800:].max() - twist[-800:].min()
        bound = 2.0 * 0.1 * factor * (stroke - 2.0 * 0.1 * factor)
        assert area(load, twist) == pytest.approx(bound, rel=0.02)


@pytest.mark.parametrize("power", [0.5, 1.0, 1.5, 2.0])
def test_dahl_follows_its_differential_equation(power: float) -> None:
    law = Dahl(0.2, SHAPE | {"power": power})
    path = [*np.linspace(0.0, 0.3, 31)[1:], *np.linspace(0.3, 0.0, 31)[1:]]
    before = 0.0
    for twist in path:
        law.keep(float(twist), float(twist) - before, 1.0)
        before = float(twist)

    def after(way: float, torque: float) -> float:
        def slope(_: float, values: Array) -> Array:
            base: Array = np.maximum(1.0 - way * values / 0.2, 0.0)
            return np.asarray(way * 2.0 * base**power)

        run = integrate.solve_ivp(slope, (0.0, 0.3), [torque], rtol=1e-9, atol=1e-12)
        return float(run.y[0, -1])

    down = after(-1.0, after(1.0, 0.0))
    assert law.torque == pytest.approx(down, rel=1e-4)


@pytest.mark.parametrize("power", [0.5, 1.0, 1.4, 2.0])
def test_a_twist_does_not_grow_while_the_load_falls(power: float) -> None:
    """At a reversal the slope of friction jumps; Newton's steps can go round in a circle there."""
    load = loops(points=60)
    twist, side = solve(path_of(load), [Dahl(0.12, SHAPE | {"reach": 0.07, "power": power})], 0.07)
    in_contact = (side[1:] != 0.0) & (side[1:] == side[:-1])
    moved = np.diff(twist) * np.sign(np.diff(load))
    assert moved[in_contact].min() > -1e-9


def test_friction_of_a_load_opens_the_loop_in_proportion() -> None:
    load = loops()
    twist, _ = solve(path_of(load), [LoadedDahl(0.05, SHAPE)], 0.1)
    up, down = twist[-800:-400], twist[-400:][::-1]
    back = load[-400:][::-1]
    low, high = (np.interp(x, up, load[-800:-400]) - np.interp(x, down, back) for x in (1.7, 2.5))
    assert low / 1.7 == pytest.approx(high / 2.5, rel=0.02)


def test_a_wedge_loses_less_in_lowering() -> None:
    load = loops()
    twist, _ = solve(path_of(load), [Wedge(0.05, SHAPE | {"reach": 0.02})], 0.02)
    raising, lowering = load[-500] - twist[-500], load[-300] - twist[-300]
    assert raising == pytest.approx(0.05 * twist[-500], rel=1e-6)
    assert lowering == pytest.approx(-0.6 * 0.05 * twist[-300], rel=1e-6)


def test_linear_drag_relaxes_in_a_dwell_with_its_own_time() -> None:
    """Elastic torque and drag in series: the lag is drag over stiffness."""
    load = np.concatenate([np.linspace(0.1, 2.0, 200), np.full(2000, 2.0)])
    path = path_of(load, step_s=0.01)
    twist, _ = solve(path, [LinearDrag(0.3, SHAPE)], 0.1)
    left = 2.0 - twist[200:]
    time = 0.3 / SHAPE["speed"]
    assert left[100] / left[0] == pytest.approx(np.exp(-1.0 / time), rel=0.01)


def test_flanks_stay_in_contact_until_friction_is_overcome() -> None:
    load = np.concatenate([np.linspace(0.1, 2.0, 100), np.linspace(2.0, -2.0, 400)])
    twist, side = solve(path_of(load), [Jenkins(0.3, SHAPE)], 0.1)
    held = (side > 0.0) & (load < 0.0)
    assert load[held].min() == pytest.approx(-0.3, abs=0.02)
    assert np.all(twist[side < 0.0] < 0.0)
    assert load[side < 0.0].max() == pytest.approx(-0.3, abs=0.02)


def test_standard_solid_relaxes_in_a_dwell_with_its_own_time() -> None:
    load = np.concatenate([np.full(1, 1e-9), np.full(4000, 3.0)])
    state = state_of(path_of(load, step_s=0.01))
    course = delay.standard_solid(state, {"slow": 7.0, "top": 3.0})
    since = state.path.time_s - state.path.time_s[1]
    assert np.allclose(1.0 - course[1:], (1.0 - course[1]) * np.exp(-since[1:] / 7.0))


def test_logarithmic_creep_moves_alike_in_every_decade() -> None:
    load = np.full(4000, 3.0)
    path = path_of(load, step_s=0.5)
    course = delay.logarithmic(state_of(path), {"fast": 0.01, "slow": 100.0, "top": 3.0})
    moved = np.diff(np.interp([5.0, 50.0, 500.0], path.time_s, course))
    assert moved[0] == pytest.approx(moved[1], rel=0.1)


def test_burgers_goes_on_flowing_where_a_solid_has_come_to_rest() -> None:
    load = np.full(3000, 3.0)
    path = path_of(load)
    course = delay.burgers(state_of(path), {"slow": 10.0, "flow": 0.05, "top": 3.0})
    assert course[-1] - course[-1001] == pytest.approx(0.05 * 1000.0 / 10.0, rel=1e-3)


def shown(law: Law, seed: int = 3) -> tuple[Array, Array]:
    """Load from the largest negative to the largest positive, and what a law adds."""
    load = np.linspace(-3.0, 3.0, 1201)
    shape = law.draw(np.random.default_rng(seed), 3.0, 1000.0)
    assert law.adds is not None
    return load, law.adds(state_of(path_of(load)), shape)


@pytest.mark.parametrize("law", catalogue.laws_of("contact_stiffening"), ids=lambda w: w.name)
def test_contacts_stiffen_alike_in_both_directions(law: Law) -> None:
    load, added = shown(law)
    assert np.allclose(added, -added[::-1])
    positive = np.diff(added[load >= 0.05])
    assert np.all(np.diff(positive) < 1e-9)


@pytest.mark.parametrize("law", catalogue.laws_of("clearance_takeup"), ids=lambda w: w.name)
def test_slope_drops_as_teeth_come_into_contact(law: Law) -> None:
    load, added = shown(law)
    assert np.allclose(added, -added[::-1])
    slope = np.diff(added[load > 0.0])
    assert slope[0] > 0.0 > slope[-1]


@pytest.mark.parametrize("law", catalogue.laws_of("overload_softening"), ids=lambda w: w.name)
def test_slope_rises_beyond_a_load(law: Law) -> None:
    load = np.linspace(0.01, 3.0, 600)
    shape = law.draw(np.random.default_rng(3), 3.0, 1000.0)
    assert law.adds is not None
    slope = np.diff(law.adds(state_of(path_of(load)), shape))
    assert slope[-1] > 10.0 * abs(slope[60])


@pytest.mark.parametrize("law", catalogue.laws_of("load_asymmetry"), ids=lambda w: w.name)
def test_asymmetry_has_an_even_part(law: Law) -> None:
    _, added = shown(law)
    even = 0.5 * (added + added[::-1])
    assert even[0] > 0.3
    if law.name != "two-stiffnesses":
        assert np.allclose(even, added)


def test_point_contact_follows_hertz() -> None:
    law = next(w for w in elastic.LAWS if w.name == "hertz-point")
    load, added = shown(law)
    chord = added + load / 3.0
    eighth = np.interp(3.0 / 8.0, load, chord)
    assert eighth == pytest.approx(0.25, rel=1e-3)


@pytest.mark.parametrize("law", catalogue.laws_of("datum_drift"), ids=lambda w: w.name)
def test_datum_moves_between_runs_alone(law: Law) -> None:
    rng = np.random.default_rng(4)
    path = make_path("rich", rng, 1200, 3.0, np.array([10.0, 200.0]))
    shape = law.draw(rng, 3.0, 1000.0)
    assert law.adds is not None
    added = law.adds(state_of(path), shape)
    levels = [set(added[path.run == run].round(12)) for run in np.unique(path.run)]
    assert all(len(level) == 1 for level in levels)
    assert len(set.union(*levels)) > 3


def test_only_a_travelling_error_depends_on_the_angle() -> None:
    for law in catalogue.laws_of("transmission_error"):
        _, added = shown(law)
        assert (np.ptp(added) > 1e-6) == (law.name == "travelling-orders")


def test_every_effect_of_the_vocabulary_has_two_published_laws() -> None:
    vocabulary = {
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
    }
    assert set(catalogue.VOCABULARY) == vocabulary
    for effect in vocabulary:
        laws = catalogue.laws_of(effect)
        assert len({law.name for law in laws}) == len(laws) >= 2
        assert all(any(c.isdigit() for c in law.source) for law in laws)


def test_strangers_are_not_those_of_the_first_generator() -> None:
    from cyclosweep_challenge.rig.aliens import ALIENS

    assert len(set(strangers.STRANGERS)) >= 10
    assert not set(strangers.STRANGERS) & (set(ALIENS) | set(catalogue.VOCABULARY))


@pytest.mark.parametrize("law", strangers.LAWS, ids=lambda w: w.effect)
def test_every_stranger_moves_the_angle_by_no_more_than_a_few_sizes(law: Law) -> None:
    rng = np.random.default_rng(4)
    path = make_path("rich", rng, 2000, 3.0, np.array([10.0, 200.0]))
    assert law.adds is not None
    added = law.adds(state_of(path), law.draw(rng, 3.0, float(path.time_s[-1])))
    assert np.isfinite(added).all()
    assert 0.05 < np.abs(added).max() < 20.0
