"""Where friction sits: before or behind the play, and beside or in series with elastic effects."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.stages.friction_first import PARAMETER_CHARGE, from_better_start
from cyclosweep.diagnosis.identify.structures.placement import best_placed
from cyclosweep.simulation.effects import effects
from cyclosweep.simulation.effects.slip_start import STATES, in_other_state, state_of
from cyclosweep.simulation.model import EffectValue
from cyclosweep.simulation.simulate import predict_history
from cyclosweep_challenge.scoreboard.made import Recipe, make
from tests.support.searches import search_of_recording

DRIVE = cs.Drive.reference_87()
COMPLIANCE, PLAY_DEG = 2.5, 28.0
SLIP = {"slip_deg": 4.0, "scatter": 0.5, "skew": 0.0}
SOFT = EffectValue("overload_softening", {"onset_nm": 10.0, "power": 2.0}, (2.0,))


def friction(**state: float) -> EffectValue:
    return EffectValue("friction_hysteresis", {**SLIP, **state}, (0.8,))


def growing() -> cs.Recording:
    """Runs of loops that grow from little more than friction, begun on either flank."""
    ends = (2.5, -2.5, 4.0, -4.0, 6.0, -6.0, 10.0, -10.0, 16.0, -16.0, 12.0, 0.5)
    parts = [np.linspace(a, b, 40)[1:] for a, b in pairwise((0.2, *ends))]
    up = np.concatenate(parts)
    torque = np.concatenate([up, -up, up])
    return cs.Recording.from_arrays(
        torque, time_s=np.arange(torque.size) * 1.0, run=np.repeat([1, 2, 3], up.size)
    )


def recording(*values: EffectValue) -> cs.Recording:
    """Growing loops with noise."""
    programme = growing()
    model = cs.Model(COMPLIANCE, PLAY_DEG, 0.3, effects=values)
    angle = cs.simulate(model, programme).angle_deg
    assert angle is not None
    noise = np.random.default_rng(5).normal(0.0, 0.05, angle.size)
    return programme.with_angle(angle + noise).take(np.abs(programme.torque_nm) > 0.9)


def term(value: EffectValue) -> Term:
    effect = next(each for each in effects() if each.name == value.name)
    return Term(effect, value.shape, None, value.amplitudes[0] if effect.slips else 0.0)


def test_friction_behind_the_play_stands_while_it_is_crossed() -> None:
    torque = np.r_[np.linspace(0.0, 1.0, 50), np.linspace(1.0, -1.0, 100)]
    programme = cs.Recording.from_arrays(torque)
    swing = COMPLIANCE * 1.0
    long = {"slip_deg": 10.0 * swing, "scatter": 0.05}
    crossing, held = (
        cs.Model(COMPLIANCE, PLAY_DEG, effects=(EffectValue("friction_hysteresis", s, (0.5,)),))
        for s in ({**long, "slack": 0.0}, {**long, "behind_play": 1.0})
    )
    slid, stood = (predict_history(model, programme) for model in (crossing, held))
    # Elements that are longer than the whole swing act as a spring; crossing the play they slip.
    friction_nm = stood.applied_nm - stood.elastic_nm
    spring = 0.5 * (stood.held_deg - stood.side * PLAY_DEG) / (10.0 * swing)
    np.testing.assert_allclose(friction_nm, spring, atol=1e-3)
    assert (slid.applied_nm - slid.elastic_nm)[-1] == pytest.approx(-0.5, abs=1e-3)


def test_friction_behind_the_play_leaves_it_the_whole_torque() -> None:
    torque = np.r_[np.linspace(0.0, 6.0, 60), np.linspace(6.0, -6.0, 121)]
    model = cs.Model(COMPLIANCE, PLAY_DEG, effects=(friction(behind_play=1.0),))
    there = predict_history(model, cs.Recording.from_arrays(torque))
    loaded = torque != 0.0
    np.testing.assert_array_equal(there.side[loaded], np.sign(torque)[loaded])
    # What friction keeps of the twist at zero torque stays while the play is crossed.
    assert there.held_deg[180] - PLAY_DEG * there.side[180] < 0.0
    kept = np.interp(0.0, -torque[60:], there.held_deg[60:] - PLAY_DEG * there.side[60:])
    assert kept > 0.5


def test_torque_at_an_angle_within_the_play_is_zero_behind_it() -> None:
    model = cs.Model(COMPLIANCE, PLAY_DEG, effects=(friction(behind_play=1.0),))
    torque = np.r_[
        np.linspace(0.5, 8.0, 60), np.linspace(8.0, -8.0, 161), np.linspace(-8.0, 8.0, 161)
    ]
    there = cs.simulate(model, cs.Recording.from_arrays(torque[torque != 0.0]))
    angle = np.array(there.angle_deg)
    jumps = np.flatnonzero(np.abs(np.diff(angle)) > PLAY_DEG)
    between = [np.linspace(angle[k], angle[k + 1], 30)[1:-1] for k in jumps]
    first, second = jumps + 1
    parts = (angle[:first], between[0], angle[first:second], between[1], angle[second:])
    dense = np.concatenate(parts)
    within = np.zeros(dense.size, dtype=bool)
    within[first : first + 28] = within[second + 28 : second + 56] = True
    programme = cs.Recording.from_arrays(np.zeros(dense.size), dense)
    back = cs.simulate(model, programme, predict="torque").torque_nm
    assert np.count_nonzero(back[within] == 0.0) > 50
    # Near zero the angle alone does not tell how far the part behind the play had come back.
    clear = np.abs(there.torque_nm) > 2.0
    np.testing.assert_allclose(back[~within][clear], there.torque_nm[clear], atol=0.01)


def test_a_part_in_series_follows_the_applied_torque() -> None:
    programme = make(Recipe(4_420))
    line = cs.Model(COMPLIANCE, PLAY_DEG, effects=(friction(slack=0.0),))
    alone = cs.simulate(line, programme).angle_deg
    beside = replace(line, effects=(*line.effects, replace(SOFT, in_series=True)))
    together = cs.simulate(beside, programme).angle_deg
    assert alone is not None
    assert together is not None
    over = np.maximum(np.abs(programme.torque_nm) - 10.0, 0.0) / 10.0
    side = np.sign(programme.torque_nm)
    loaded = np.abs(programme.torque_nm) > 2.0
    np.testing.assert_allclose((together - alone)[loaded], (2.0 * side * over**2)[loaded])


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("in_series", [False, True])
def test_torque_and_angle_are_inverse(state: dict[str, float], in_series: bool) -> None:
    values = (friction(**state), replace(SOFT, in_series=in_series))
    model = cs.Model(COMPLIANCE, PLAY_DEG, 0.3, effects=values)
    programme = make(Recipe(4_420))
    there = cs.simulate(model, programme)
    back = cs.simulate(model, there, predict="torque")
    clear = np.abs(programme.torque_nm) > 3.0
    off = np.abs(back.torque_nm - programme.torque_nm)[clear]
    assert np.quantile(off, 0.95) < 0.05


@pytest.mark.parametrize("state", STATES)
def test_friction_is_found_in_its_state_from_any(state: dict[str, float]) -> None:
    search = search_of_recording(recording(friction(**state)))
    for begun in STATES:
        shape = in_other_state(friction().shape, begun)
        first = fit(
            search.problem,
            search.noise,
            [term(replace(friction(), shape=shape))],
            search.baseline.fit,
            rounds=20,
        )
        best = from_better_start(search.noise, first, PARAMETER_CHARGE)
        assert state_of(best.terms[0].shape) == state


@pytest.mark.parametrize("in_series", [False, True])
def test_an_elastic_effect_is_found_in_its_place_from_either(in_series: bool) -> None:
    values = (friction(slack=0.0), replace(SOFT, in_series=in_series))
    search = search_of_recording(recording(*values))
    for begun in (False, True):
        terms = [term(values[0]), replace(term(values[1]), in_series=begun)]
        first = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
        best = best_placed(first)
        assert best.terms[1].in_series == in_series
        assert (best is first) == (begun == in_series)
        assert best.rmse_deg == pytest.approx(0.05, rel=0.1)


def one_run(*ends: float) -> cs.Recording:
    """A single run from end to end of these torques, with friction and a curve in series."""
    torque = np.concatenate([np.linspace(a, b, 90)[1:] for a, b in pairwise((0.1, *ends))])
    model = cs.Model(COMPLIANCE, PLAY_DEG, 0.3, effects=(friction(slack=0.0), IN_SERIES))
    programme = cs.Recording.from_arrays(torque, time_s=np.arange(torque.size) * 1.0)
    angle = cs.simulate(model, programme).angle_deg
    assert angle is not None
    noise = np.random.default_rng(8).normal(0.0, 0.05, angle.size)
    return programme.with_angle(angle + noise).take(np.abs(programme.torque_nm) > 0.9)


IN_SERIES = replace(SOFT, in_series=True)
GROWING = (4.0, 1.5, 8.0, 1.5, 12.0, 1.5, 16.0, -16.0, -4.0, -16.0, -1.5)


@pytest.mark.parametrize(
    ("ends", "several"),
    [
        (GROWING, True),
        ((16.0, -16.0, -1.5), False),
        ((16.0, -16.0, 16.0, -16.0, 15.5, -15.5, -1.5), False),
        ((16.0, 9.0, 16.0, 1.0), False),
        ((16.0, 9.0, 16.0, 2.0, 16.0, 1.0), True),
    ],
)
def test_loops_that_turn_apart_are_several(ends: tuple[float, ...], several: bool) -> None:
    assert search_of_recording(one_run(*ends)).problem.has_several_loops == several


def test_loops_of_one_run_tell_the_places_apart() -> None:
    search = search_of_recording(one_run(*GROWING))
    assert search.problem.run_count == 1
    terms = [term(friction(slack=0.0)), term(SOFT)]
    held = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    assert best_placed(held).terms[1].in_series
    found = cs.diagnose(one_run(*GROWING), DRIVE, full=False)
    assert {e["name"] for e in found.effects} == {"friction_hysteresis", "overload_softening"}
    assert found.verdict == "IDENTIFIED"
    # Of a whole loop alone, another curve and another friction make the same.
    alone = search_of_recording(one_run(16.0, -16.0, -1.5))
    whole = fit(alone.problem, alone.noise, terms, alone.baseline.fit, rounds=20)
    assert best_placed(whole) is whole


def test_the_class_of_a_law_in_series_follows_the_applied_torque() -> None:
    values = (friction(slack=0.0), replace(SOFT, in_series=True))
    search = search_of_recording(recording(*values))
    terms = [term(values[0]), replace(term(values[1]), in_series=True)]
    fitted = fit(search.problem, search.noise, terms, search.baseline.fit, rounds=20)
    law = fitted.whitened_contribution(1, search.noise)
    curve = ClassColumns.of(fitted).columns["odd curve of the torque"]
    left = law - curve @ np.linalg.lstsq(curve, law, rcond=None)[0]
    beside = replace(fitted, terms=(terms[0], replace(terms[1], in_series=False)))
    other = ClassColumns.of(beside).columns["odd curve of the torque"]
    left_beside = law - other @ np.linalg.lstsq(other, law, rcond=None)[0]
    assert np.linalg.norm(left) < 0.02 * np.linalg.norm(law)
    assert np.linalg.norm(left_beside) > 0.05 * np.linalg.norm(law)


@pytest.mark.parametrize("in_series", [False, True])
def test_a_diagnosis_names_a_curve_wherever_it_lies(in_series: bool) -> None:
    made = recording(friction(behind_play=1.0), replace(SOFT, in_series=in_series))
    found = cs.diagnose(made, DRIVE, full=False)
    assert found.verdict == "IDENTIFIED"
    assert {e["name"] for e in found.effects} == {"friction_hysteresis", "overload_softening"}
    assert found.model is not None
    (curve,) = [v for v in found.model.effects if v.name == "overload_softening"]
    (slides,) = [v for v in found.model.effects if v.name == "friction_hysteresis"]
    assert curve.in_series == in_series
    assert slides.shape.get("behind_play") == 1.0
    notes = found.content["notes"]
    assert any("other side of the play" in note for note in notes)
    assert any("between the friction and the load" in note for note in notes) == in_series
    forecast = cs.simulate(found.model, made).angle_deg
    loaded = np.abs(made.torque_nm) > 2.0
    assert np.std((np.asarray(forecast) - np.asarray(made.angle_deg))[loaded]) < 0.06


def test_the_file_of_a_model_says_what_lies_in_series() -> None:
    value = replace(SOFT, in_series=True)
    assert EffectValue.from_dict(value.as_dict()) == value
    assert "in_series" not in SOFT.as_dict()
    for shape, found in (
        ({"behind_play": 0.3}, "behind_play: found 0.3"),
        ({"behind_play": 1.0, "slack": 0.0}, "slack: found beside behind_play"),
    ):
        with pytest.raises(cs.InputError, match=found):
            EffectValue.from_dict(friction(**shape).as_dict())
    content = friction(slack=0.0).as_dict() | {"in_series": True}
    with pytest.raises(cs.InputError, match="in_series: found true"):
        EffectValue.from_dict(content)


def test_friction_that_gets_no_bound_is_still_looked_for() -> None:
    torque = np.linspace(0.1, 12.0, 400)
    model = cs.Model(COMPLIANCE, PLAY_DEG, effects=(friction(slack=0.0),))
    angle = cs.simulate(model, cs.Recording.from_arrays(torque)).angle_deg
    assert angle is not None
    noise = np.random.default_rng(2).normal(0.0, 0.05, angle.size)
    found = cs.diagnose(cs.Recording.from_arrays(torque, angle + noise), DRIVE, full=False)
    said = {name for each in found.content["explanation_set"] for name in each["effects"]}
    assert found.verdict != "IDENTIFIED" or "friction_hysteresis" in said
    bounded = {row["name"] for row in found.content["ruled_out"] + found.content["undecided"]}
    assert not bounded & {"friction_hysteresis", "load_dependent_friction"}
