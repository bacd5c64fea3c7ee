"""The next experiment: loads in newton metres, a programme to start from, nothing that is known."""

from pathlib import Path

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.verification import SETTLE
from cyclosweep.diagnosis.verify.experiment import FINER, next_experiment, rig_programme
from cyclosweep.diagnosis.verify.menu import MENU, SHOWN_BY, able_to_show
from cyclosweep.simulation.effects import VOCABULARY
from tests.support.dry_friction import friction_that_builds_up
from tests.support.searches import search_of, search_of_recording
from tests.unit.test_diagnosis_answer import found

RIGS = Path(__file__).parents[2] / "examples" / "rigs"


def test_the_loads_are_said_in_newton_metres() -> None:
    diagnosis = found("ambiguous")
    plan = diagnosis.answer.next_experiment
    assert plan is not None
    largest = float(np.abs(diagnosis.recording.torque_nm).max())
    search = search_of()
    shown = next_experiment(search, [], "clearance_takeup", 100.0 * search.noise.sigma_deg)
    for each, top in ((plan, largest), (shown, search.problem.largest_torque_nm)):
        assert len(each.loads_nm) >= 3
        (of_menu,) = [one for one in MENU if one.words == each.program]
        expected = [share * top for share in of_menu.shares]
        assert each.loads_nm == pytest.approx(expected, rel=5e-3)
    assert plan.rig_programme == "motor-current"  # two rates
    assert shown.rig_programme == "weights-and-protractor"


def test_every_programme_of_the_menu_goes_as_far_as_its_loads_say() -> None:
    for plan in MENU:
        torque = plan.make(10.0)[0]
        assert max(plan.shares) * 10.0 == pytest.approx(float(torque.max()), rel=0.05)
        assert min(plan.shares) * 10.0 == pytest.approx(float(torque.min()), rel=0.05)


def test_the_programme_to_start_from_is_that_of_the_rig() -> None:
    torque, angle = np.arange(9.0), np.arange(9.0)
    output = cs.Recording.from_arrays(torque, angle, side="output")
    motor = cs.Recording.from_arrays(torque, angle, torque_from="motor-current")
    by_hand = cs.Recording.from_arrays(torque, angle)
    (loops,) = able_to_show(["overload_softening"])
    assert rig_programme(output, loops) == "torque-sensor-and-encoder"
    assert rig_programme(motor, loops) == "motor-current"
    assert rig_programme(by_hand, loops) == "weights-and-protractor"


def test_no_programme_is_named_that_cannot_do_what_is_asked() -> None:
    torque, angle = np.arange(9.0), np.arange(9.0)
    output = cs.Recording.from_arrays(torque, angle, side="output")
    by_hand = cs.Recording.from_arrays(torque, angle)
    (rates,) = able_to_show(["viscous_drag"])
    (dwells,) = able_to_show(["creep"])
    assert rig_programme(by_hand, rates) == "motor-current"  # weights have no clock
    assert rig_programme(by_hand, dwells) == ""
    assert rig_programme(output, dwells) == "torque-sensor-and-encoder"
    for plan in MENU:
        name = rig_programme(by_hand, plan)
        if name:
            header = (RIGS / f"{name}.csv").read_text(encoding="utf-8").partition("\n")[0]
            needs = {"rates": "time_s", "positions": "crank_deg"}.get(plan.varies, "torque_nm")
            assert needs in header.split(",")


@pytest.mark.parametrize(
    ("effect", "words"),
    [
        ("viscous_drag", "three rates"),
        ("creep", "holds"),
        ("load_asymmetry", "loops"),
        ("overload_softening", "1.4 times the largest torque"),
    ],
)
def test_the_programme_changes_what_the_effect_follows(effect: str, words: str) -> None:
    search = search_of()
    plan = next_experiment(search, [], effect, 100.0 * search.noise.sigma_deg)
    assert words in plan.program
    assert plan.separates == (effect,)
    assert "1.4 times" in words or "1.4 times" not in plan.program


def test_nothing_is_proposed_that_would_drown_in_the_noise() -> None:
    plan = found("too noisy").answer.next_experiment  # 0.001 deg in noise of 0.2 deg
    assert plan is not None
    assert plan.program == FINER
    assert not plan.separates
    assert not plan.loads_nm


def test_what_is_named_is_not_to_be_shown_again() -> None:
    unknown = found("unknown").answer
    assert unknown.next_experiment is not None
    named = {effect.name for effect in unknown.effects}
    assert not named & set(unknown.next_experiment.separates)


def test_every_effect_has_programmes_of_the_menu() -> None:
    made = [plan.make for plan in MENU]
    assert all(programme in made for able in SHOWN_BY.values() for programme in able)
    assert set(SHOWN_BY) == {effect.name for effect in VOCABULARY}
    assert able_to_show(["an effect of a user"]) == MENU


def test_torques_that_do_not_count_are_not_asked_for_again() -> None:
    up = np.linspace(0.0, 10.0, 50)
    torque = np.concatenate([up, up[::-1], -up, -up[::-1]])
    beyond = np.abs(torque) > 8.0  # the motor was at its limit
    angle = 28.0 * np.sign(torque) + 2.7 * torque
    search = search_of_recording(cs.Recording.from_arrays(torque, angle, unscored=beyond))
    assert search.problem.largest_torque_nm == pytest.approx(np.abs(torque[~beyond]).max())


def test_a_programme_that_would_hardly_show_the_effect_is_to_be_repeated() -> None:
    """At 2.2 times the noise an effect is missed more often than found; it was said to show."""
    search = search_of()
    strong = next_experiment(search, [], "creep", 10.0 * search.noise.sigma_deg)
    assert strong.detectability is not None
    assert strong.minutes is not None
    size = 10.0 * search.noise.sigma_deg * 2.2 / strong.detectability
    weak = next_experiment(search, [], "creep", size)
    assert weak.program == f"{strong.program}; all of it 4 times"  # (3.9 / 2.2)^2 is 3.1
    assert weak.detectability == pytest.approx(4.4, rel=0.01)
    assert weak.minutes == pytest.approx(4 * strong.minutes, rel=0.4)
    weaker = next_experiment(search, [], "creep", 0.8 * size)
    assert weaker.program == FINER


def test_rates_that_were_recorded_are_not_asked_for_again() -> None:
    leg = np.linspace(0.0, 10.0, 60)
    torque = np.r_[leg, leg[-2::-1], -leg[1:], -leg[-2::-1]]
    angle = 28.0 * np.sign(torque) + 2.7 * torque + np.random.default_rng(1).normal(0, 0.1, 237)
    for rates, more in (((1.0, 5.0, 25.0), True), ((1.0, 1.0, 25.0), False), ((1, 2, 5), False)):
        time = np.concatenate([k * 1e5 + np.arange(237) / rate for k, rate in enumerate(rates)])
        recording = cs.Recording.from_arrays(
            np.tile(torque, 3), np.tile(angle, 3), run=np.repeat([1, 2, 3], 237), time_s=time
        )
        search = search_of_recording(recording)
        plan = next_experiment(search, [], "viscous_drag", 100.0 * search.noise.sigma_deg)
        assert ("three more rates" in plan.program) == more
        assert ("at three rates" in plan.program) == (not more)


def test_the_loads_of_separate_runs_are_those_that_were_simulated() -> None:
    """Of a ladder of runs one sequence was given that never came back to zero between them."""
    (ladder,) = able_to_show(["datum_drift"])
    torque, run = ladder.make(10.0)[:2]
    ends = [0.0]
    for each in np.unique(run):
        own = torque[run == each]
        ends += [float(own.max()), float(own.min()), float(own[-1])]
    assert [10.0 * share for share in ladder.shares] == pytest.approx(ends)
    assert "each a run of its own" in ladder.words
    assert "without zeroing the angle" in ladder.words


def test_a_play_that_changes_from_run_to_run_is_to_settle_first() -> None:
    """Asked for were nested loops that would show a take-up of clearance, which was not there."""
    leg = np.linspace(0.0, 600.0, 60)
    torque = np.r_[leg, leg[-2::-1], -leg[1:], -leg[-2::-1]]
    elastic = torque - 20.0 * np.r_[np.ones(59), -np.ones(119), np.ones(59)]
    rng = np.random.default_rng(3)
    angle = [
        half * np.sign(elastic) + 0.00036 * elastic + 0.001 * rng.normal(size=237)
        for half in (0.30, 0.32, 0.38)
    ]
    recording = cs.Recording.from_arrays(
        np.tile(torque, 3), np.concatenate(angle), run=np.repeat([1, 2, 3], 237), side="output"
    )
    answer = cs.diagnose(recording, cs.Drive.reference_87()).answer
    assert "play that changes from run to run" in [each.behaviour for each in answer.classes]
    assert answer.next_experiment is not None
    assert answer.next_experiment.program == SETTLE


def test_what_is_no_larger_than_rounding_is_to_be_read_finer() -> None:
    """Whether it repeats was asked, which rounding does whatever rounds."""
    leg = np.linspace(0.0, 600.0, 200)
    torque = np.r_[leg, leg[-2::-1], -leg[1:], -leg[-2::-1]]
    elastic = torque - friction_that_builds_up(torque, 25.0)
    angle = 0.32 * np.where(elastic < 0, -1.0, 1.0) + 0.00036 * elastic
    noise = 0.001 * np.random.default_rng(31).normal(size=3 * len(torque))
    time = np.arange(len(torque)) * 600.0 / 199
    recording = cs.Recording.from_arrays(
        np.tile(torque, 3),
        np.round((np.tile(angle, 3) + noise) / 0.05) * 0.05,
        run=np.repeat([1, 2, 3], len(torque)),
        time_s=np.concatenate([time / 5.0, 1e3 + time / 5.0, 2e3 + time / 50.0]),
        side="output",
        angle_resolution_deg=0.05,
    )
    answer = cs.diagnose(recording, cs.Drive.reference_87()).answer
    assert answer.verdict == "UNKNOWN_PHYSICS"
    assert answer.next_experiment is not None
    assert "finer than 0.05 deg" in answer.next_experiment.program
