"""What the laws of a model miss: a table by direction and torque, in a forecast and in a file."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.identify.fitting.repetition import LEAST_REPEAT
from cyclosweep.diagnosis.model_error_table import repeatability
from cyclosweep.simulation.model import EffectValue
from cyclosweep.simulation.model_error import ErrorBranch, ModelError, load_branches
from cyclosweep.simulation.simulate import predict_history
from tests.support.arrays import Floats, present

TOP_NM = 20.0
PLAIN = cs.Model(compliance_deg_per_nm=2.7, free_play_deg=28.0, drive="reference-87")
NODES = np.linspace(-19.0, 19.0, 77)


def bumps(torque: Floats, phase: float = 0.0) -> Floats:
    """Error of a few waves over the range of the torque [deg]."""
    return np.asarray(0.5 * np.sin(0.8 * torque + phase))


def branch(direction: Any, from_nm: float, phase: float = 0.0) -> ErrorBranch:
    return ErrorBranch(direction, from_nm, tuple(NODES), tuple(bumps(NODES, phase)))


TABLE = ModelError((branch("falling", TOP_NM), branch("rising", -TOP_NM, 1.0)), TOP_NM)
KNOWING = replace(PLAIN, model_error=TABLE)


def loop(top_nm: float, loops: int = 1, **columns: Any) -> cs.Recording:
    """Loops from zero to the top, to minus the top and back, 0.1 N m a reading."""
    path = np.concatenate([np.linspace(0.1, top_nm, 200)] + [
        np.concatenate([np.linspace(top_nm, -top_nm, 400), np.linspace(-top_nm, top_nm, 400)])
        for _ in range(loops)
    ])  # fmt: skip
    return cs.Recording.from_arrays(path, **columns)


def missed(programme: cs.Recording, model: cs.Model = KNOWING) -> Floats:
    """What the table of a model adds to a forecast."""
    with_table, without = (present(cs.simulate(m, programme).angle_deg) for m in (model, PLAIN))
    return np.asarray(with_table - without)


def branches(programme: cs.Recording) -> list[tuple[float, str, int]]:
    """Start, direction and number of samples of every branch."""
    found = load_branches(predict_history(PLAIN, programme), TOP_NM)
    return [(b.from_nm, b.direction, b.samples.stop - b.samples.start) for b in found]


def test_branches_begin_where_the_torque_turns() -> None:
    expected = [(0.0, "rising", 200), (TOP_NM, "falling", 400), (-TOP_NM, "rising", 400)]
    assert branches(loop(TOP_NM)) == expected


def test_a_load_that_is_there_at_once_was_put_on() -> None:
    torque = np.r_[np.linspace(20.0, 5.0, 40), np.linspace(5.5, 20.0, 30)]
    expected = [(0.0, "rising", 1), (20.0, "falling", 39), (5.0, "rising", 30)]
    assert branches(cs.Recording.from_arrays(torque)) == expected


@pytest.mark.parametrize("torque", [[], [3.0], [2.0] * 9, [0.0] * 5])
def test_every_programme_has_branches_and_a_forecast(torque: list[float]) -> None:
    programme = cs.Recording.from_arrays(torque)
    assert sum(count for *_, count in branches(programme)) == len(torque)
    assert np.isfinite(missed(programme)).all()


def test_a_run_that_follows_without_a_break_continues_its_branch() -> None:
    torque = np.r_[np.linspace(-20, 0, 50), np.linspace(0.4, 20, 50)]
    run = np.repeat([1, 2], 50)
    broken = cs.Recording.from_arrays(torque, run=run)
    whole = cs.Recording.from_arrays(torque, run=run, history="continuous")
    assert branches(whole) == [(0.0, "falling", 1), (-20.0, "rising", 99)]
    assert branches(broken)[-1] == (0.0, "rising", 50)


def test_same_loop_has_the_errors_of_the_table() -> None:
    programme = loop(TOP_NM)
    torque, added = programme.torque_nm, missed(programme)
    inside = np.abs(torque) < 18.9
    falling = np.arange(len(torque)) - 200
    down, up = inside & (falling >= 0) & (falling < 400), inside & (falling >= 405)
    assert added[down] == pytest.approx(bumps(torque[down]), abs=0.03)
    assert added[up] == pytest.approx(bumps(torque[up], 1.0), abs=0.03)
    # The first loading begins at rest, not at a reversal: its start is another one, at first.
    first = (falling < 0) & inside
    assert np.abs(added[first & (torque < 2.0)]).max() < 1e-3


def test_errors_fade_on_a_loop_that_turns_elsewhere_and_beyond_the_torques_of_the_table() -> None:
    small = loop(0.5 * TOP_NM)
    turned = np.abs(small.torque_nm[200:260] - 0.5 * TOP_NM) < 2.0
    assert np.abs(missed(small)[200:260][turned]).max() < 0.05
    assert np.abs(missed(small)).max() < np.abs(missed(loop(TOP_NM))).max()
    large = loop(2.0 * TOP_NM)
    far = np.abs(large.torque_nm) > 1.9 * TOP_NM
    assert np.abs(missed(large)[far]).max() < 0.01


def test_a_recorded_start_is_asked_alone_and_a_first_loading_is_another() -> None:
    flat = tuple(np.ones(len(NODES)))
    inner = ErrorBranch("falling", 0.5 * TOP_NM, tuple(NODES), tuple(-each for each in flat))
    outer = ErrorBranch("falling", TOP_NM, tuple(NODES), flat)
    first = ErrorBranch("rising", 0.0, tuple(NODES), flat, fresh=True)
    known = replace(PLAIN, model_error=ModelError((inner, outer, first), TOP_NM))

    def added(torque: Floats) -> Floats:
        return missed(cs.Recording.from_arrays(torque), known)

    up, down = np.linspace(0.1, 20.0, 200), np.linspace(20.0, -18.0, 380)
    inside = np.abs(np.r_[up, down]) < 18.9
    np.testing.assert_allclose(added(np.r_[up, down])[inside], 1.0, atol=1e-9)
    again = added(np.r_[up, np.linspace(20.0, 0.0, 200), up])[400:]
    assert abs(again[60]) < 0.2


def test_forecast_does_not_depend_on_loads_that_follow() -> None:
    torque = loop(TOP_NM).torque_nm
    alone = missed(cs.Recording.from_arrays(torque))
    followed = missed(cs.Recording.from_arrays(np.r_[torque, np.linspace(20.0, 90.0, 300)]))
    np.testing.assert_array_equal(followed[: len(torque)], alone)


def test_error_does_not_jump_where_a_small_loop_turns() -> None:
    torque = np.r_[np.linspace(0.1, 20, 200), np.linspace(20, 8, 240), np.linspace(8, 20, 240)]
    added = missed(cs.Recording.from_arrays(torque))
    assert np.abs(np.diff(added[205:640])).max() < 0.06
    assert abs(added[439]) > 0.03


def test_table_of_one_position_says_nothing_at_another() -> None:
    known = replace(PLAIN, model_error=replace(TABLE, crank_deg=358.0))
    for crank_deg, is_used in ((1.0, True), (358.0, True), (10.0, False), (None, True)):
        torque = loop(TOP_NM).torque_nm
        crank = None if crank_deg is None else np.full(len(torque), crank_deg)
        programme = cs.Recording.from_arrays(torque, crank_deg=crank)
        assert bool(np.abs(missed(programme, known)).max() > 0.1) is is_used


def test_torque_for_a_twist_leaves_the_table_out() -> None:
    programme = cs.simulate(PLAIN, loop(TOP_NM))
    assert cs.simulate(KNOWING, programme, "torque").torque_nm == pytest.approx(
        cs.simulate(PLAIN, programme, "torque").torque_nm
    )


def test_file_gives_back_the_table() -> None:
    again = cs.Model.from_json(json.loads(KNOWING.to_json()))
    assert again.model_error == TABLE
    assert "model_error" not in json.loads(PLAIN.to_json())


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        (
            "direction",
            "up",
            "model_error: branch 1: direction: found 'up', expected one of rising, falling",
        ),
        ("torque_nm", [1.0, 0.0], "model_error: branch 1: torque_nm: expected numbers that rise"),
        ("error_deg", [0.1], "model_error: branch 1: found 2 torques and 1 errors"),
        (
            "error_deg",
            [0.1, "x"],
            'model_error: branch 1: error_deg 2: found "x", expected a number',
        ),
        ("from_nm", None, "model_error: branch 1: from_nm: "),
    ],
)
def test_a_table_that_is_none_is_one_line(key: str, value: Any, words: str) -> None:
    content = json.loads(KNOWING.to_json())
    entry = {"direction": "rising", "from_nm": 0.0, "torque_nm": [0.0, 1.0], "error_deg": [0, 1]}
    content["model_error"] = {"largest_torque_nm": 1.0, "branches": [entry | {key: value}]}
    with pytest.raises(cs.InputError) as raised:
        cs.Model.from_json(content)
    assert words in str(raised.value)
    assert "\n" not in str(raised.value)


SLIP = {"slip_deg": 3.0, "scatter": 0.3}
SEEN = replace(PLAIN, effects=(EffectValue("friction_hysteresis", SLIP, (2.0,)),))


def measured(size_deg: float, *, same: bool, noise_deg: float = 0.02) -> cs.Recording:
    """Four runs of two loops with friction and an error that no law has; the last is held out.

    The error is the same in every run, or each run has its own.
    """
    rng = np.random.default_rng(5)
    one = loop(TOP_NM, 2).torque_nm[::4]
    torque, run = np.tile(one, 4), np.repeat([1, 2, 3, 4], len(one))
    programme = cs.Recording.from_arrays(
        torque, run=run, time_s=np.arange(float(len(torque))), holdout_runs=(4,),
        drive="reference-87",
    )  # fmt: skip
    angle = present(cs.simulate(SEEN, programme).angle_deg)
    error = np.zeros(len(torque))
    for number in range(1, 5):
        waves = np.random.default_rng(1 if same else number)
        here = run == number
        for order in (0.9, 1.3, 1.7):
            phase = waves.uniform(0.0, 2.0 * np.pi, 2)
            rising = np.gradient(torque[here]) > 0
            error[here] += np.sin(order * torque[here] + np.where(rising, *phase))
    noise = rng.normal(0.0, noise_deg, len(torque))
    return programme.with_angle(angle + size_deg / np.sqrt(1.5) * error + noise)


def test_what_repeats_is_learned_and_forecasts_a_run_that_was_held_out() -> None:
    found = cs.diagnose(measured(0.4, same=True), full=False)
    learned = found.answer.repaired.model_error
    assert learned is not None
    assert learned.repeats > 0.9
    assert (learned.between, learned.compared) == ("runs", 3)
    # What of the error the named laws take up is theirs; the table holds what they leave.
    left_deg = found.answer.repaired.rmse_deg
    assert left_deg is not None
    assert learned.rms_deg == pytest.approx(left_deg, rel=0.1)
    assert 0.15 < left_deg < 0.5
    assert learned.holdout_rmse_deg is not None
    assert learned.holdout_without_deg is not None
    assert learned.holdout_rmse_deg < 0.5 * learned.holdout_without_deg
    said = [finding.text for finding in found.answer.findings if finding.topic == "model error"]
    assert len(said) == 1
    assert f"{learned.holdout_rmse_deg:.3g} deg with it" in said[0]


def curves(rng: np.random.Generator, runs: int, common: float, noise: float = 0.0) -> list[Floats]:
    """Errors of two branches in some runs, of which a share of the variance is common."""

    def waves() -> Floats:
        phases = rng.uniform(0.0, 2.0 * np.pi, 3)
        orders = np.array([1.4, 2.0, 2.6])[:, None]
        angle = 2.0 * np.pi * orders * np.linspace(0.0, 1.0, 101) + phases[:, None]
        return np.asarray(np.sin(angle).sum(axis=0))

    return [
        np.sqrt(common) * waves()
        + np.sqrt(1.0 - common) * np.array([waves() for _ in range(runs)])
        + noise * rng.normal(size=(runs, 101))
        for _ in range(2)
    ]


@pytest.mark.parametrize("noise", [0.0, 0.3])
@pytest.mark.parametrize("runs", [2, 3, 6])
def test_smooth_errors_that_have_nothing_in_common_seldom_seem_to_repeat(
    runs: int, noise: float
) -> None:
    rng = np.random.default_rng(3)
    unlike = [repeatability(curves(rng, runs, 0.0, noise)) for _ in range(200)]
    assert np.mean([share >= LEAST_REPEAT for share in unlike if share is not None]) < 0.1
    alike = [repeatability(curves(rng, runs, 0.8, noise)) for _ in range(200)]
    assert np.mean([share >= LEAST_REPEAT for share in alike if share is not None]) > 0.9
    assert np.median([share for share in alike if share is not None]) == pytest.approx(0.8, abs=0.1)


def test_too_few_places_say_nothing() -> None:
    few = np.full((3, 101), np.nan)
    few[:, 40:50] = np.sin(np.arange(10.0))
    assert repeatability([few]) is None
    few[:, 30:50] = np.sin(np.arange(20.0))
    assert repeatability([few]) == pytest.approx(1.0)


@pytest.mark.parametrize("places", [(0.0, 360.0), (10.0, 10.08), (0.0, 90.0)])
def test_table_remembers_the_only_position_of_the_mesh(places: tuple[float, float]) -> None:
    recording = measured(0.4, same=True)
    crank = np.where(recording.run == 2, places[1], places[0])
    found = cs.diagnose(replace(recording, crank_deg=crank), full=False)
    assert found.model is not None
    table = found.model.model_error
    assert table is not None
    single = places[1] != 90.0
    assert (table.crank_deg is not None) is single
    if table.crank_deg is not None:
        assert abs((table.crank_deg - places[0] + 180.0) % 360.0 - 180.0) < 0.1


@pytest.mark.parametrize(("size_deg", "same"), [(0.4, False), (0.0, True)])
def test_what_does_not_repeat_and_what_is_noise_is_not_learned(size_deg: float, same: bool) -> None:
    found = cs.diagnose(measured(size_deg, same=same), full=False)
    assert found.answer.repaired.model_error is None
    assert found.model is not None
    assert found.model.model_error is None
