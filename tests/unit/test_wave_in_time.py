"""A wave in time is looked for at frequencies that the runs do not see as a slow change."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.sinusoid import IN_TIME, find_sinusoid
from cyclosweep.diagnosis.prepare.problem import Problem, prepare
from tests.support.arrays import Floats

SLOW_HZ, FAST_HZ = 0.5, 5.0


def two_rates() -> tuple[Problem, Floats]:
    """Two slow runs and a fast one, each sampled at its own rate; and their clock [s]."""
    loop = np.r_[np.linspace(20.0, 300.0, 300), np.linspace(300.0, 20.0, 300)]
    torque = np.tile(loop, 3)
    run = np.repeat([0, 1, 2], len(loop))
    step = np.repeat([1.0 / SLOW_HZ, 1.0 / SLOW_HZ, 1.0 / FAST_HZ], len(loop))
    time = np.cumsum(step)
    recording = cs.Recording.from_arrays(
        torque, 0.00036 * torque, time_s=time, run=run, side="output"
    )
    return prepare(recording, cs.Drive.reference_87().nominal_line("output"), 8), time


def test_a_drift_is_no_wave_that_slow_runs_see_once_a_cycle() -> None:
    problem, time = two_rates()
    drift = (time - time.mean())[problem.fitted]
    seen, wave = find_sinusoid(problem.history, problem.fitted, drift / np.std(drift))
    frequency = float(wave.place.split()[1]) if seen > 0.0 and wave is not None else np.nan
    away = np.abs(frequency / SLOW_HZ - np.rint(frequency / SLOW_HZ))
    assert seen == 0.0 or frequency < 0.1 * SLOW_HZ or away > 0.01


@pytest.mark.parametrize("frequency_hz", [0.02, 0.13, 1.7])
def test_a_wave_is_found_at_its_frequency(frequency_hz: float) -> None:
    problem, time = two_rates()
    wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * frequency_hz * time[problem.fitted])
    seen, found = find_sinusoid(problem.history, problem.fitted, wave)
    assert seen > 50.0
    assert found is not None
    assert found.family == IN_TIME
    assert float(found.place.split()[1]) == pytest.approx(frequency_hz, rel=0.02)
