"""A staircase with rising against one with falling torque."""

import itertools

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.problem import Problem, prepare
from cyclosweep.diagnosis.whole_loop.both_ways import direction_correlation, in_words


def problem(phase_back_deg: float) -> Problem:
    """Two loops with a torque that pulsates, on the way back shifted by a phase."""
    ends = (-10.0, 10.0, -10.0, 10.0, -10.0)
    angle = np.concatenate([np.linspace(a, b, 700) for a, b in itertools.pairwise(ends)])
    rising = np.concatenate([np.full(700, b > a) for a, b in itertools.pairwise(ends)])
    wave = 2 * np.pi * angle / 0.9
    shifted = wave + np.radians(phase_back_deg)
    torque = 3.0 * angle + np.where(rising, 4.0 + np.cos(wave), -4.0 + np.cos(shifted))
    drive = cs.Drive.reference_87()
    line = drive.nominal_line("output")
    return prepare(cs.Recording.from_arrays(torque, angle, side="output"), line, 8)


@pytest.mark.parametrize(
    ("phase_back_deg", "correlation", "words"),
    [(0.0, 1.0, "are alike"), (180.0, -1.0, "are opposite"), (90.0, 0.0, "neither")],
)
def test_directions_are_compared_at_equal_angle(
    phase_back_deg: float, correlation: float, words: str
) -> None:
    found = direction_correlation(problem(phase_back_deg))
    assert found == pytest.approx(correlation, abs=0.1)
    assert words in in_words(found)


def test_too_few_common_places_say_nothing() -> None:
    one_way = cs.Recording.from_arrays(np.linspace(1, 9, 50), np.linspace(0, 3, 50), side="output")
    line = cs.Drive.reference_87().nominal_line("output")
    assert direction_correlation(prepare(one_way, line, 8)) is None
    assert in_words(None) == ""
