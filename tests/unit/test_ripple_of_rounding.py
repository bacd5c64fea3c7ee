"""A ripple along the twist that has as many cycles as the dial has steps is its rounding."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.hypotheses.sinusoid import find_sinusoid
from cyclosweep.diagnosis.prepare.problem import prepare
from tests.support.arrays import Floats

STEP_DEG = 0.5


def even_torque() -> Floats:
    """Torque up and down in equal steps, which mirror the rounding at slower frequencies."""
    return np.concatenate([np.linspace(-10.0, 10.0, 173)[::sense] for sense in (1, -1, 1)])


def irregular_torque() -> Floats:
    """Torque up and down in unequal steps."""
    rng = np.random.default_rng(7)
    return np.concatenate([np.sort(rng.uniform(-10.0, 10.0, 300))[::sense] for sense in (1, -1, 1)])


@pytest.mark.parametrize("torque", [even_torque(), irregular_torque()], ids=["even", "irregular"])
def test_the_rounding_of_a_dial_is_no_ripple(torque: Floats) -> None:
    twist = 2.7 * torque
    scatter = 0.1 * STEP_DEG * np.random.default_rng(8).normal(size=len(twist))
    read = STEP_DEG * np.rint((twist + scatter) / STEP_DEG)
    problem = prepare(
        cs.Recording.from_arrays(torque, read), cs.Drive.reference_87().nominal_line("input"), 8
    )
    error = (read - twist)[problem.fitted] / np.std(read - twist)
    history = problem.history.with_state(angle_deg=twist, free_play_deg=0.0)
    seen, ripple = find_sinusoid(history, problem.fitted, error)
    assert seen > 50.0
    assert ripple is not None
    assert "cycles a degree" in ripple.place
    assert find_sinusoid(history, problem.fitted, error, STEP_DEG)[0] < 0.1 * seen


@pytest.mark.parametrize("torque", [even_torque(), irregular_torque()], ids=["even", "irregular"])
def test_another_ripple_is_seen_on_a_dial(torque: Floats) -> None:
    problem = prepare(
        cs.Recording.from_arrays(torque, 2.7 * torque),
        cs.Drive.reference_87().nominal_line("input"),
        8,
    )
    wave = np.sqrt(2.0) * np.sin(2.0 * np.pi * 0.7 * problem.history.angle_deg[problem.fitted])
    seen = [
        find_sinusoid(problem.history, problem.fitted, wave, step)[0] for step in (0.0, STEP_DEG)
    ]
    assert min(seen) > 50.0
