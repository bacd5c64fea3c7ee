"""Runs without a pause between them: asked about once, and only then."""

from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.recording.unbroken_runs import UNBROKEN, unbroken_runs

LOOP = np.concatenate([np.linspace(0, 20, 60), np.linspace(19, -20, 120), np.linspace(-19, 0, 60)])


def recording(
    pause_s: float = 0.5, *, start_nm: float = 0.0, history: str = "per-run", clock: bool = True
) -> cs.Recording:
    """Three runs of a loop, half a second a reading, with a pause and an offset between them."""
    count = len(LOOP)
    run = np.repeat([1, 2, 3], count)
    time = 0.5 * np.arange(3 * count) + (pause_s - 0.5) * (run - 1)
    return cs.Recording.from_arrays(
        np.tile(LOOP, 3) + start_nm * (run - 1),
        run=run,
        time_s=time if clock else None,
        history=history,
    )


@pytest.mark.parametrize("pause_s", [0.5, 1.0])
def test_runs_without_a_pause_are_asked_about(pause_s: float) -> None:
    assert unbroken_runs(recording(pause_s)) == (UNBROKEN,)


def test_a_pause_another_torque_no_clock_and_a_stated_history_are_not() -> None:
    assert unbroken_runs(recording(60.0)) == ()
    assert unbroken_runs(recording(start_nm=5.0)) == ()
    assert unbroken_runs(recording(clock=False)) == ()
    assert unbroken_runs(recording(history="continuous")) == ()
    assert unbroken_runs(replace(recording(), reset_between_runs=True)) == ()
    assert unbroken_runs(cs.Recording.from_arrays(LOOP, time_s=np.arange(float(len(LOOP))))) == ()
    assert unbroken_runs(cs.Recording.from_arrays([])) == ()


def test_the_question_stands_in_the_answer() -> None:
    load = recording()
    angle = cs.simulate(cs.Drive.reference_87(), load).angle_deg
    assert angle is not None
    noise = np.random.default_rng(1).normal(0.0, 0.1, len(angle))
    found = cs.diagnose(load.with_angle(angle + noise), cs.Drive.reference_87(), full=False)
    assert UNBROKEN in found.answer.notes
