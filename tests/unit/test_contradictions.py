"""An answer that contradicts itself is found out, and none is given."""

from dataclasses import replace

import pytest

import cyclosweep as cs
from cyclosweep.result import (
    Answer,
    Bound,
    Doubt,
    Finding,
    FoundEffect,
    Mismatch,
    NextExperiment,
    PlayAndStiffness,
    Reading,
    Region,
    Remainder,
    Size,
)
from cyclosweep.result.contradictions import Recorded, contradictions
from tests.unit.test_diagnosis_answer import CASES, found

CREEP = FoundEffect(name="creep", size_deg=Size(estimate=0.5, ci95=(0.4, 0.6)), p_value=0.001)
SOUND = Answer(verdict="IDENTIFIED", effects=(CREEP,))
PLACE = Region(mean_residual_deg=0.3, share_of_excess=0.7, p_value=0.002)
MISFIT = Remainder(shape="misfit of the model", place="which does not repeat", size_deg=0.3)
STEPS = Finding(topic="staircase", text="They repeat at the same positions from run to run.")
HIDDEN = Finding(topic="play", text="Not reported, as friction hides it: too small a load.")

WRONG: dict[str, tuple[Answer, str]] = {
    "nothing and something": (replace(SOUND, verdict="NOTHING_MISSING"), "effects are named"),
    "named and not found": (
        replace(SOUND, undecided=(Bound(name="creep", upper95_deg=1.0),)),
        "creep is named, and stands among what was not found",
    ),
    "certain and perhaps zero": (
        replace(SOUND, effects=(replace(CREEP, size_deg=Size(estimate=0.1, ci95=(0.0, 0.2))),)),
        "the interval of creep holds zero",
    ),
    "more than all": (replace(SOUND, mismatch=Mismatch(regions=(PLACE, PLACE))), "140 %"),
    "repeats and does not": (
        replace(SOUND, unknown=MISFIT, findings=(STEPS,)),
        "a misfit remains which does not repeat",
    ),
    "given and hidden": (
        replace(
            SOUND,
            findings=(HIDDEN,),
            play_and_stiffness=PlayAndStiffness(free_play_deg=Reading(estimate=1.0)),
        ),
        "the play is given",
    ),
    "to show what is named": (
        replace(SOUND, next_experiment=NextExperiment(program="loops", separates=("creep",))),
        "creep, which is named already",
    ),
    "nothing to do beside a remark": (
        replace(
            SOUND,
            plausibility=(Doubt(quantity="compliance", text="2.5 times"),),
            next_experiment=NextExperiment(program="none needed"),
        ),
        "no experiment is needed",
    ),
    "nothing to do beside a remainder": (
        replace(SOUND, unknown=MISFIT, next_experiment=NextExperiment(program="none needed")),
        "remains without a name",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_each_contradiction_is_found(case: str) -> None:
    answer, words = WRONG[case]
    (said,) = contradictions(answer)
    assert words in said


def test_an_effect_larger_than_the_recording_is_found() -> None:
    recorded = Recorded(angle_deg=0.45, torque_nm=20.0)
    (said,) = contradictions(SOUND, recorded)
    assert said == ("creep has a size of 0.5 deg, and all of the recording lies within 0.45 deg")
    # A friction that takes most of the torque holds back more twist than is left to be seen.
    holds = replace(SOUND, effects=(replace(CREEP, name="friction_hysteresis", size_nm=15.0),))
    assert contradictions(holds, recorded) == ()
    assert contradictions(SOUND, replace(recorded, angle_deg=0.5)) == ()


def test_a_sound_answer_has_none() -> None:
    assert contradictions(SOUND) == ()


@pytest.mark.parametrize("case", CASES)
def test_no_answer_contradicts_itself(case: str) -> None:
    answer = found(case).answer
    assert contradictions(answer) == ()
    assert not any("contradicts" in note for note in answer.notes)
    assert answer.summary
    assert len(answer.summary) < 300


def test_a_contradiction_is_said_in_the_notes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "cyclosweep.diagnosis.finish.contradictions", lambda *answer: ("black is white",)
    )
    recording, options, _ = CASES["identified"]
    answer = cs.diagnose(recording, cs.Drive.reference_87(), **options, full=False).answer
    assert answer.notes[-1] == "This answer contradicts itself: black is white."
