"""The next experiment: loads in newton metres, a programme to start from, nothing that is known."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.verify.experiment import (
    MENU,
    USUAL,
    rig_programme,
)
from cyclosweep.simulation.effects import VOCABULARY
from tests.support.searches import search_of_recording
from tests.unit.test_diagnosis_answer import found


def test_the_loads_are_said_in_newton_metres() -> None:
    for case in ("ambiguous", "too noisy"):
        diagnosis = found(case)
        plan = diagnosis.answer.next_experiment
        assert plan is not None
        largest = float(np.abs(diagnosis.recording.torque_nm).max())
        assert len(plan.loads_nm) >= 3
        (of_menu,) = [each for each in MENU if each.words == plan.program]
        expected = [share * largest for share in of_menu.shares]
        assert plan.loads_nm == pytest.approx(expected, rel=5e-3)
        assert plan.rig_programme == "weights-and-protractor"


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
    assert rig_programme(output) == "torque-sensor-and-encoder"
    assert rig_programme(motor) == "motor-current"
    assert rig_programme(by_hand) == "weights-and-protractor"


def test_what_is_named_is_not_to_be_shown_again() -> None:
    unknown = found("unknown").answer
    assert unknown.next_experiment is not None
    named = {effect.name for effect in unknown.effects}
    assert not named & set(unknown.next_experiment.separates)


def test_the_usual_programmes_are_those_of_the_menu() -> None:
    made = [plan.make for plan in MENU]
    assert all(programme in made for programme in USUAL.values())
    assert set(USUAL) <= {effect.name for effect in VOCABULARY}


def test_torques_that_do_not_count_are_not_asked_for_again() -> None:
    up = np.linspace(0.0, 10.0, 50)
    torque = np.concatenate([up, up[::-1], -up, -up[::-1]])
    beyond = np.abs(torque) > 8.0  # the motor was at its limit
    angle = 28.0 * np.sign(torque) + 2.7 * torque
    search = search_of_recording(cs.Recording.from_arrays(torque, angle, unscored=beyond))
    assert search.problem.largest_torque_nm == pytest.approx(np.abs(torque[~beyond]).max())
