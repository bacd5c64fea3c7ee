"""Remarks on a free play go by the play that the answer states, and by all readings of it."""

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.plausibility import doubts
from cyclosweep.result import (
    Answer,
    Baseline,
    CalibratedParameter,
    Doubt,
    PlayAndStiffness,
    Reading,
    Repair,
)

NOMINAL_DEG = 0.43
"""Free play of each side by the drive file [deg]."""


def calibrated(play: float, error: float, scale: float = 1.0) -> dict[str, CalibratedParameter]:
    """Parameters of a calibration with a fitted play of each side and its standard error [deg]."""
    return {
        "compliance_scale": CalibratedParameter(nominal=1.0, estimate=scale),
        "compliance_deg_per_nm": CalibratedParameter(nominal=0.04, estimate=0.04 * scale),
        "free_play_deg": CalibratedParameter(nominal=NOMINAL_DEG, estimate=play, std_error=error),
        "datum_deg": CalibratedParameter(nominal=0.0, estimate=0.0),
    }


def remarks(
    before: tuple[float, float],
    after: tuple[float, float],
    lines: Reading | None = None,
    *,
    hidden: bool = False,
    scales: tuple[float, float] = (1.0, 1.0),
) -> tuple[Doubt, ...]:
    """Remarks on fitted plays of each side with their errors, and on the whole play by lines."""
    answer = Answer(
        verdict="IDENTIFIED",
        baseline=Baseline(parameters=calibrated(*before, scales[0])),
        repaired=Repair(holdout="nothing", parameters=calibrated(*after, scales[1])),
        play_and_stiffness=PlayAndStiffness(runs=0 if lines is None else 3, free_play_deg=lines),
    )
    torque = np.r_[0:30:20j, 30:-30:40j, -30:0:20j]
    recording = cs.Recording.from_arrays(torque, 0.04 * torque + NOMINAL_DEG * np.sign(torque))
    return doubts(answer, recording, 87.0, hidden=hidden)


def test_no_remark_where_the_play_read_from_the_loop_is_that_of_the_file() -> None:
    # The fitted dead zone leaves out a soft start of the contacts, which the lines contain.
    read = Reading(estimate=0.858, ci95=(0.84, 0.88))
    assert remarks((0.001, 0.01), (0.001, 0.01), read) == ()


def test_no_remark_where_the_readings_lie_on_both_sides_of_the_file() -> None:
    assert remarks((0.001, 0.001), (0.001, 0.001), Reading(estimate=6.0, ci95=(5.9, 6.1))) == ()


def test_no_remark_on_a_fitted_play_whose_interval_holds_that_of_the_file() -> None:
    assert remarks((0.001, 0.4), (0.001, 0.4)) == ()
    (doubt,) = remarks((0.001, 0.01), (0.001, 0.01))
    assert doubt.quantity == "free_play"


def test_the_remark_states_the_play_that_is_read() -> None:
    read = Reading(estimate=3.0, ci95=(2.9, 3.1))
    (doubt,) = remarks((1.3, 0.01), (1.2, 0.01), read)
    assert doubt.found == pytest.approx(1.5)
    assert doubt.text.startswith("the free play is 1.5 deg each side where the drive file says")
    assert "worn" in doubt.text


@pytest.mark.parametrize("whole", [0.002, -0.02])
def test_less_play_than_the_file_says_is_not_called_wear(whole: float) -> None:
    (doubt,) = remarks((0.001, 0.01), (0.001, 0.01), Reading(estimate=whole))
    assert "worn" not in doubt.text
    assert "preload" in doubt.text
    assert "friction that holds the shaft" in doubt.text
    assert doubt.found is not None
    assert doubt.found >= 0.0
    assert "-" not in doubt.text


def test_no_remark_on_a_play_that_friction_hides() -> None:
    assert remarks((0.001, 0.01), (0.001, 0.01), hidden=True) == ()


def test_no_remark_on_a_compliance_that_two_calibrations_put_on_both_sides() -> None:
    near = (NOMINAL_DEG, 0.01)
    assert remarks(near, near, scales=(0.28, 6.4)) == ()


def test_a_remark_on_the_compliance_states_what_the_answer_states() -> None:
    near = (NOMINAL_DEG, 0.01)
    (doubt,) = remarks(near, near, scales=(3.0, 4.0))
    assert doubt.factor == pytest.approx(4.0)
