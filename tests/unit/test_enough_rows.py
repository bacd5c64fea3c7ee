"""A loud mismatch is diagnosed on fewer rows than a faint one."""

import json
from copy import copy
from dataclasses import replace

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep.diagnosis.calibrate import (
    ENOUGH,
    FEWEST_ROWS,
    LEAST_THINNED,
    calibrate,
    calibrate_on_enough_rows,
    mismatch,
)
from cyclosweep.diagnosis.hypotheses.library import build_library
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.prepare.problem import prepare
from cyclosweep.diagnosis.prepare.thinning import MOST_ROWS
from cyclosweep.simulation.effects import effects
from tests.support.long_recording import COMPLIANCE, friction, long_recording

DRIVE = cs.Drive.reference_87()
COUNT = 4_000


def on_rows(recording: cs.Recording, most: int) -> Search:
    line, pins = DRIVE.nominal_line("input"), int(DRIVE.output_pin_count)
    problem = prepare(recording, line, pins, most)
    return calibrate(problem, build_library(problem.history, problem.fitted, tuple(effects())), 0)


def ratio(search: Search) -> float:
    assert search.flexible is not None
    return mismatch(search, search.flexible)


def enough(recording: cs.Recording) -> Search:
    return calibrate_on_enough_rows(lambda most: on_rows(recording, most))


def recorded(friction_deg: float) -> cs.Recording:
    return long_recording(COUNT, [friction(friction_deg)])


def test_a_faint_mismatch_keeps_every_row() -> None:
    recording = recorded(0.05)
    search = enough(recording)
    assert ratio(search) < ENOUGH
    assert len(search.problem.history) == len(recording)


def test_a_loud_mismatch_is_seen_in_fewer_rows() -> None:
    recording = recorded(2.0)
    every = on_rows(recording, COUNT)
    assert ratio(every) > 2.0 * ENOUGH
    search = enough(recording)
    assert len(search.problem.history) == pytest.approx(FEWEST_ROWS, rel=0.15)
    assert search.problem.most_rows == FEWEST_ROWS


def test_the_mismatch_counts_rows_that_were_passed_over() -> None:
    recording = recorded(2.0)
    every, fewer = on_rows(recording, COUNT), on_rows(recording, FEWEST_ROWS)
    assert fewer.problem.rows.every > 1
    assert ratio(fewer) == pytest.approx(ratio(every), rel=0.2)


def test_ends_of_short_pieces_stay_and_are_not_counted_for_others() -> None:
    legs = np.tile(np.r_[np.arange(5), np.arange(5, 0, -1)], 400) / 5.0
    top = np.repeat(np.linspace(8.0, 30.0, 400), 10)
    programme = cs.Recording.from_arrays(legs * top, time_s=np.arange(4000) * 2.0)
    model = cs.Model(compliance_deg_per_nm=COMPLIANCE, free_play_deg=28.0, effects=(friction(0.6),))
    angle = cs.simulate(model, programme).angle_deg
    assert angle is not None
    noise = 0.05 * np.random.default_rng(5).normal(size=4000)
    recording = programme.with_angle(angle + noise)
    every, fewer = on_rows(recording, COUNT), on_rows(recording, FEWEST_ROWS)
    assert fewer.problem.rows.every > 1
    assert len(fewer.problem.history) > 1.5 * FEWEST_ROWS
    assert ratio(fewer) == pytest.approx(ratio(every), rel=0.15)


def test_between_them_rows_fall_with_the_square_of_the_mismatch() -> None:
    recording = recorded(0.5)
    every = on_rows(recording, COUNT)
    wanted = len(recording) * (ENOUGH / ratio(every)) ** 2
    assert 1.1 * FEWEST_ROWS < wanted < len(recording) / LEAST_THINNED
    assert enough(recording).problem.most_rows == int(wanted)


def test_a_recording_is_not_thinned_for_less_than_every_second_row() -> None:
    recording = recorded(0.4)
    every = on_rows(recording, COUNT)
    wanted = len(recording) * (ENOUGH / ratio(every)) ** 2
    assert len(recording) / LEAST_THINNED < wanted < 0.9 * len(recording)
    assert enough(recording).problem.most_rows == MOST_ROWS


def test_the_answer_says_that_a_loud_recording_was_thinned() -> None:
    found = cs.diagnose(recorded(2.0), DRIVE, full=False)
    assert [effect["name"] for effect in found.effects] == ["friction_hysteresis"]
    thinning = json.loads(found.to_json())["thinning"]
    assert thinning["samples"] == len(recorded(2.0))
    assert thinning["rows"] < 0.5 * COUNT


def asked_for(search: Search) -> list[int]:
    """Numbers of rows for which a search is calibrated."""
    asked = list[int]()

    def calibrated(most_rows: int) -> Search:
        asked.append(most_rows)
        return search

    calibrate_on_enough_rows(calibrated)
    return asked


def test_all_rows_are_kept_where_the_noise_is_not_known() -> None:
    search = on_rows(recorded(2.0), COUNT)
    assert asked_for(search) == [MOST_ROWS, FEWEST_ROWS]
    unsure = copy(search)
    unsure.noise = replace(search.noise, structured=True)
    assert asked_for(unsure) == [MOST_ROWS]
