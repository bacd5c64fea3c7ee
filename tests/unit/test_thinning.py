"""Rows of a long recording: where they are cut, how many samples they average, what is kept."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.prepare.pieces import LEAST_FULL, Pieces, find_pieces
from cyclosweep.diagnosis.prepare.problem import Problem, prepare
from cyclosweep.diagnosis.prepare.rows import Rows
from cyclosweep.diagnosis.prepare.thinning import (
    MOST_ERROR,
    MOST_ROWS,
    averaging_error,
    thin,
)
from cyclosweep.recording.structure import turning_points
from tests.support.arrays import Floats, Integers
from tests.support.long_recording import (
    driven_through_friction,
    flanks_through_friction,
    friction,
    long_recording,
)

LINE = cs.Drive.reference_87().nominal_line("input")
NOISY = long_recording(40_000, [friction()], noise_deg=0.5)
QUIET = long_recording(40_000, [friction()], noise_deg=0.002)


def prepared(recording: cs.Recording) -> Problem:
    return prepare(recording, LINE, 8)


def values_by_row(rows: Rows, values: Floats | Integers) -> list[npt.NDArray[Any]]:
    used = np.flatnonzero(rows.row >= 0)
    return np.split(values[used], np.flatnonzero(np.diff(rows.row[used])) + 1)


def test_short_recordings_keep_every_sample() -> None:
    recording = long_recording(MOST_ROWS - 500)
    problem = prepared(recording)
    assert not problem.rows.thinned
    assert np.array_equal(problem.rows.row, np.arange(len(recording)))
    assert np.array_equal(problem.history.applied_nm, recording.torque_nm)
    assert problem.angle_deg.tolist() == list(recording.to_frame()["angle_deg"])


@pytest.mark.parametrize("recording", [NOISY, QUIET], ids=["averaged", "passed over"])
def test_rows_cross_no_bend_of_the_load_history(recording: cs.Recording) -> None:
    rows = thin(recording, LINE)
    turn = np.sign(np.diff(recording.torque_nm))
    for samples in values_by_row(rows, np.arange(len(recording))):
        assert np.array_equal(samples, np.arange(samples[0], samples[-1] + 1))
        assert len(np.unique(recording.run[samples])) == 1
        assert len(np.unique(np.sign(recording.torque_nm[samples]))) == 1
        assert len(np.unique(turn[samples[:-1]])) <= 1, "a reversal or the start of a dwell"


@pytest.mark.parametrize("limit_nm", [0.3, 1.0, 4.0])
@pytest.mark.parametrize("noise_deg", [0.3, 3.0])
def test_rows_hold_one_flank_wherever_friction_lets_the_play_be_crossed(
    limit_nm: float, noise_deg: float
) -> None:
    recording = driven_through_friction(40_000, limit_nm, noise_deg)
    flank = flanks_through_friction(recording, limit_nm)
    rows = thin(recording, LINE)
    assert rows.averaged > 4
    for samples in values_by_row(rows, flank):
        assert len(np.unique(samples)) == 1


def test_rows_hold_one_flank_where_the_play_is_crossed_slowly() -> None:
    recording = driven_through_friction(40_000, 1.0, 0.3)
    flank = flanks_through_friction(recording, 1.0)
    # Over 30 samples the shaft moves from the one flank to the other.
    angle = 28.0 * np.convolve(np.pad(flank, 15, mode="edge"), np.ones(31) / 31, mode="valid")
    angle[flank == 0] = 0.0
    noise = 0.3 * np.random.default_rng(5).normal(size=len(angle))
    slowly = recording.with_angle(angle + 2.7 * recording.torque_nm + noise)
    rows = thin(slowly, LINE)
    assert rows.averaged > 4
    for samples in values_by_row(rows, flank):
        assert len(np.unique(samples)) == 1


def test_where_a_shaft_stood_in_its_play_before_the_first_load_is_not_fitted() -> None:
    recording = driven_through_friction(4_000, 0.5, 0.05)
    flank = flanks_through_friction(recording, 0.5)
    loose = flank == 0
    assert loose.sum() > 5
    problem = prepared(recording)
    assert not np.any(problem.whole_fitted & loose)
    assert np.array_equal(problem.whole_fitted, ~loose)


@pytest.mark.parametrize("recording", [NOISY, QUIET], ids=["averaged", "passed over"])
def test_extremes_of_the_torque_stay(recording: cs.Recording) -> None:
    history = prepared(recording).history
    for number, run in enumerate(recording.runs):
        whole = recording.torque_nm[recording.run == run]
        kept = history.applied_nm[history.run == number]
        extremes = whole[turning_points(whole, 0.1)]
        assert len(extremes) >= 6
        assert kept[turning_points(kept, 0.1)] == pytest.approx(extremes, rel=1e-12)
        assert (kept[0], kept[-1]) == (whole[0], whole[-1])


def test_only_rows_of_about_the_usual_size_are_fitted() -> None:
    problem = prepared(NOISY)
    rows = problem.rows
    assert rows.averaged >= 4
    fitted = problem.weight[problem.fitted]
    assert fitted.min() >= LEAST_FULL * rows.averaged
    assert fitted.max() <= 1.6 * rows.averaged
    assert fitted.sum() > 0.85 * np.count_nonzero(np.abs(NOISY.torque_nm) > 0.5)


def test_noise_allows_averages_that_a_quiet_recording_does_not() -> None:
    noisy, quiet = thin(NOISY, LINE), thin(QUIET, LINE)
    assert noisy.averaged > 4 * quiet.averaged
    assert noisy.every == 1
    assert quiet.every > 4
    for rows in (noisy, quiet):
        assert 0.6 * MOST_ROWS < len(rows) < 1.1 * MOST_ROWS


def test_a_coarse_dial_is_not_averaged() -> None:
    step = 2.0
    angle = NOISY.angle_deg
    assert angle is not None
    read = cs.Recording.from_arrays(
        NOISY.torque_nm,
        step * np.round(angle / step),
        time_s=NOISY.time_s,
        run=NOISY.run,
        angle_resolution_deg=step,
    )
    rows = thin(read, LINE)
    assert rows.averaged == 1
    assert rows.every > 4


def test_single_outliers_do_not_keep_rows_from_being_averaged() -> None:
    rng = np.random.default_rng(4)
    angle = NOISY.angle_deg
    assert angle is not None
    spikes = np.where(rng.random(len(angle)) < 0.002, 30 * 0.5, 0.0)
    assert thin(NOISY.with_angle(angle + spikes), LINE).averaged == thin(NOISY, LINE).averaged


def test_error_of_averaging_is_the_curvature_over_the_noise() -> None:
    # Every four hundredth row a smooth bump begins, eight rows wide.
    count, size = 40_000, 20
    noise = np.random.default_rng(2).normal(size=count)
    rows = Pieces(np.array([0]), np.array([count]), np.array([False])).blocks(size)
    usable = np.ones(len(rows), dtype=bool)
    place = np.arange(count) / size

    def bumps(at: Floats) -> Floats:
        along = at % 400.0
        return np.asarray(np.where(along < 8, 12.0 * (1.0 - np.cos(np.pi * along / 4)), 0.0))

    assert averaging_error(noise, rows, usable) < MOST_ERROR
    lost = rows.mean(bumps(place)) - bumps(rows.mean(place))
    made = float(np.linalg.norm(lost)) * np.sqrt(size)
    assert made > MOST_ERROR
    found = averaging_error(bumps(place) + noise, rows, usable)
    assert found == pytest.approx(made, rel=0.25)


def test_without_noise_nothing_curved_is_averaged() -> None:
    exact = long_recording(40_000, [friction()], noise_deg=0.0)
    assert thin(exact, LINE).averaged == 1


def test_short_dwells_are_a_row_each() -> None:
    levels = np.repeat(np.r_[np.linspace(1, 30, 600), np.linspace(29.9, 1, 600)], 30)
    rng = np.random.default_rng(3)
    angle = 28 + 2.7 * levels + 3.0 * rng.normal(size=len(levels))
    stairs = cs.Recording.from_arrays(levels, angle)
    rows = thin(stairs, LINE, 1000)
    problem = prepare(stairs, LINE, 8, 1000)
    assert len(rows) == 1200
    assert np.all(rows.samples == 30)
    assert problem.history.applied_nm == pytest.approx(levels[::30], rel=1e-12)
    assert np.all(problem.fitted)


def test_values_of_rows_come_back_at_every_sample() -> None:
    rows = thin(NOISY, LINE)
    place = np.arange(float(len(NOISY)))
    assert rows.at_samples(rows.mean(place)) == pytest.approx(place)
    apart = np.abs(rows.at_samples(rows.mean(NOISY.torque_nm)) - NOISY.torque_nm)
    assert apart.max() < 0.2, "between the last row of a dwell and the first of a ramp"
    assert np.count_nonzero(apart > 1e-9) < 0.01 * len(NOISY)
    same = Rows(np.arange(5), np.ones(5, dtype=bool))
    assert np.array_equal(same.at_samples(np.arange(5.0)), np.arange(5.0))


def test_position_is_averaged_across_the_turn() -> None:
    rows = Rows(np.repeat(np.arange(2), 4), np.ones(2, dtype=bool), averaged=4)
    place = np.r_[358.0, 359.0, 360.0 - 360.0, 1.0, 10.0, 11.0, 12.0, 13.0]
    assert rows.mean_angle(place) == pytest.approx([359.5, 11.5])


def test_pieces_end_at_breaks_of_the_clock_and_moves_of_the_position() -> None:
    torque = np.linspace(1, 30, 400)
    time = np.arange(400.0)
    time[150:] += 500.0
    crank = np.where(np.arange(400) < 300, 0.0, 90.0)
    pieces = find_pieces(cs.Recording.from_arrays(torque, time_s=time, crank_deg=crank))
    assert pieces.start.tolist() == [0, 150, 300]


def test_a_noisy_torque_has_no_reversals_of_its_own() -> None:
    rng = np.random.default_rng(8)
    torque = np.r_[np.linspace(1, 30, 3000), np.linspace(30, 1, 3000)] + 0.02 * rng.normal(
        size=6000
    )
    pieces = find_pieces(cs.Recording.from_arrays(torque))
    assert len(pieces.start) == 2
    assert abs(int(pieces.start[1]) - 3000) < 12
