"""The scoreboard: checks that can fail, recordings as stated, lines that are not done twice."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

import cyclosweep as cs
from cyclosweep_challenge.scoreboard import printed_drive
from cyclosweep_challenge.scoreboard import run as running
from cyclosweep_challenge.scoreboard.checks import (
    CONSISTENT,
    names_only,
    no_stiffness_to_three_digits,
    removes,
    says_the_drive_changed,
)
from cyclosweep_challenge.scoreboard.command import main
from cyclosweep_challenge.scoreboard.line import Line
from cyclosweep_challenge.scoreboard.lines import all_lines, all_summaries
from cyclosweep_challenge.scoreboard.made import Recipe, correlated, left_over, long_recording, make
from cyclosweep_challenge.scoreboard.made_effects import SHAPES
from cyclosweep_challenge.scoreboard.made_rig import Course, Friction, balance
from cyclosweep_challenge.scoreboard.outcome import FAILURE, Outcome
from cyclosweep_challenge.scoreboard.page import page
from cyclosweep_challenge.scoreboard.printed_drive import (
    all_forecasts,
    exchanged_lines,
    printed_drive_lines,
)

GOOD = Outcome(
    "IDENTIFIED",
    "Missing physics: creep.",
    ("creep",),
    noise_deg=0.1,
    scale_calibrated=1.0,
    scale_repaired=1.1,
    scale_error=0.05,
    rms_calibrated_deg=1.0,
    rms_repaired_deg=0.11,
    held_calibrated_deg=1.0,
    held_repaired_deg=0.12,
    stationary=True,
)


def broken(outcome: Outcome) -> list[str]:
    """Words of the checks against itself that an answer breaks."""
    return [check.words for check in CONSISTENT if not check.holds(outcome)]


def test_an_answer_is_checked_against_itself() -> None:
    assert broken(GOOD) == []
    assert len(broken(replace(GOOD, scale_calibrated=-0.2))) == 1
    assert len(broken(replace(GOOD, rms_repaired_deg=0.4))) == 1
    assert broken(replace(GOOD, rms_repaired_deg=0.4, verdict="MOSTLY_EXPLAINED")) == []
    assert len(broken(replace(GOOD, verdict="NOTHING_MISSING"))) == 1
    assert len(broken(replace(GOOD, held_repaired_deg=1.1))) == 1
    assert len(broken(Outcome(FAILURE))) == 1


def test_checks_can_fail() -> None:
    assert names_only("creep").holds(GOOD)
    assert not names_only("creep").holds(replace(GOOD, named=("creep", "viscous_drag")))
    assert removes(0.9).holds(GOOD)
    assert not removes(0.9).holds(replace(GOOD, rms_repaired_deg=0.5))
    assert not says_the_drive_changed().holds(GOOD)
    assert says_the_drive_changed().holds(replace(GOOD, stationary=False))
    vague = no_stiffness_to_three_digits()
    assert vague.holds(GOOD)
    assert not vague.holds(replace(GOOD, scale_error=0.001))
    assert not vague.holds(replace(GOOD, statement="Calibration: compliance +12.3 % against"))


def test_lines_and_the_checks_over_them_fit_together(tmp_path: Path) -> None:
    names = [line.name for line in all_lines(tmp_path)]
    assert len(names) == len(set(names))
    for summary in all_summaries():
        assert set(summary.of) <= set(names)


def test_what_is_kept_is_read_back_and_not_done_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = list[str]()

    def diagnosed(line: Line, recordings: Path, *, full: bool = True) -> Outcome:
        made.append(line.name)
        return GOOD

    monkeypatch.setattr(running, "diagnosed", diagnosed)
    lines = [line for line in all_lines(tmp_path) if line.name in ("coulomb-dahl", "wall-no-clock")]
    file = tmp_path / "scoreboard.json"
    for _ in range(2):
        board = running.Board.open(file, "one")
        running.run(board, lines, tmp_path, lambda text: None)
        assert board.outcomes == {"coulomb-dahl": GOOD}  # the wall's file is absent
    assert made == ["coulomb-dahl"]
    assert running.Board.open(file, "another").outcomes == {}


def test_an_error_is_an_answer_that_is_wrong(tmp_path: Path) -> None:
    line = next(each for each in all_lines(tmp_path) if each.name == "foot-dual-x33")
    outcome = running.diagnosed(line, tmp_path)
    assert outcome.verdict == FAILURE
    assert "there is an answer" in line.failed(outcome)


def test_made_recordings_have_the_size_that_is_stated() -> None:
    for recipe, size in (
        (Recipe(1, 1e-6, "friction_hysteresis", "bouc-wen", friction_rms_deg=0.7), 0.7),
        (Recipe(2, 1e-6, added={"clearance_takeup": 0.3}), 0.3),
    ):
        recording = make(recipe)
        assert recording.angle_deg is not None
        course = Course(
            recording.torque_nm,
            recording.torque_nm,
            recording.torque_nm,
            recording.torque_nm,
            np.asarray(recording.run),
        )
        rms = np.sqrt(np.mean(left_over(course, recording.angle_deg) ** 2))
        assert rms == pytest.approx(size, rel=0.02)


def test_noise_of_high_autocorrelation_has_it() -> None:
    recording = correlated(1, "", 20.0, 0.97)
    assert recording.angle_deg is not None
    torque, run = recording.torque_nm, np.asarray(recording.run)
    course = Course(torque, torque, torque, torque, run)
    error = left_over(course, recording.angle_deg)
    follows = np.diff(run) == 0
    assert np.corrcoef(error[1:][follows], error[:-1][follows])[0, 1] == pytest.approx(
        0.96, abs=0.02
    )


@pytest.mark.parametrize("effect", SHAPES)
def test_every_shape_adds_something(effect: str) -> None:
    recording = make(Recipe(3, 1e-6, added={effect: 0.5}))
    plain = make(Recipe(3, 1e-6))
    assert recording.angle_deg is not None
    assert plain.angle_deg is not None
    assert np.std(recording.angle_deg - plain.angle_deg) > 0.3


@pytest.mark.parametrize("law", ["jenkins", "dahl", "bouc-wen"])
def test_friction_balances_and_reaches_its_limit(law: str) -> None:
    torque = np.r_[np.linspace(0.0, 20.0, 60), np.linspace(20.0, -20.0, 120)]
    same = np.zeros(torque.size)
    course = Course(torque, np.arange(torque.size) * 1.0, same, same, np.ones(180, dtype=np.int64))
    friction = Friction(law, 2.0, constant_nm=1.5)  # type: ignore[arg-type]
    at = balance(course, friction)
    force = torque - at.elastic_nm
    assert np.all(np.abs(force) <= 1.5 + 1e-6)
    assert force[59] == pytest.approx(1.5, rel=0.01)
    assert force[-1] == pytest.approx(-1.5, rel=0.01)


def test_every_tenth_row_of_the_long_recording_is_its_every_tenth_row() -> None:
    whole, some = long_recording(20_000), long_recording(20_000, 10)
    assert len(some.torque_nm) < len(whole.torque_nm) / 9
    assert set(some.torque_nm.tolist()) <= set(whole.torque_nm.tolist())


def test_the_page_has_every_line_and_every_check(tmp_path: Path) -> None:
    lines, summaries = all_lines(tmp_path), all_summaries()
    board = running.Board(tmp_path / "scoreboard.json", "code")
    board.outcomes = {line.name: GOOD for line in lines[:-1]}
    text = page(lines, summaries, board)
    for line in lines:
        assert f"| {line.name} | {line.asks} | {line.answer} |" in text
    for summary in summaries:
        assert f"| {summary.name} |" in text
    assert f"| {lines[-1].name} | – |" in text
    assert "| creep-d12 | yes | IDENTIFIED | creep |" in text
    assert "| thermal-drift-d12 | no | IDENTIFIED | creep |" in text


def test_checks_over_several_lines_can_fail() -> None:
    known = {summary.name: summary for summary in all_summaries()}
    for name, good, bad in (
        ("ar97-power", GOOD, replace(GOOD, verdict="INSUFFICIENT_DATA")),
        ("two-effects-seconds", GOOD, replace(GOOD, seconds=11.0)),
        ("all-forecasts", replace(GOOD, figures={"over_floor": 1.05}), GOOD),
    ):
        summary = known[name]
        assert summary.judged(dict.fromkeys(summary.of, good))[0]
        assert not summary.judged(dict.fromkeys(summary.of, bad))[0]
    same = known["long-same-answer"]
    answers = dict.fromkeys(same.of, GOOD)
    assert same.judged(answers)[0]
    assert not same.judged({**answers, same.of[0]: replace(GOOD, named=())})[0]


def test_exchanged_lines_keep_the_other_ramp_back(monkeypatch: pytest.MonkeyPatch) -> None:
    ramps = cs.Recording.from_arrays(
        [0.0, 5.0, 0.0, 5.0], [0.0, 20.0, 0.0, 20.0], run=[101, 101, 102, 102], holdout_runs=(102,)
    )
    plain = replace(printed_drive_lines()[0], recording=lambda _: ramps)
    monkeypatch.setattr(printed_drive, "printed_drive_lines", lambda: [plain])
    (line,) = exchanged_lines()
    assert line.name == f"{plain.name}-exchanged"
    assert line.recording(Path()).holdout_runs == (101,)
    assert all_forecasts([line]).of == (line.name,)


def test_what_is_forecast_is_the_ramp_that_was_kept_back() -> None:
    torque = np.tile([0.0, 8.0, 16.0, 8.0, -8.0, -16.0, 0.0], 2)
    run = np.repeat([101, 102], 7)
    angle = np.where(run == 101, 1.0, 1.2) * torque
    recording = cs.Recording.from_arrays(torque, angle, run=run, time_s=np.arange(14.0))
    model = cs.Model(1.2, 0.0, 0.0, side=recording.side)
    found = cast(cs.Diagnosis, SimpleNamespace(recording=recording, model=model))
    assert printed_drive.forecast(found)["forecast_deg"] == pytest.approx(0.0, abs=1e-9)
    other_way = printed_drive.forecast(found, fitted=102, ahead=101)
    assert other_way["forecast_deg"] > 1.0


def test_steps_that_repeat_are_named_by_their_own_order_or_by_that_of_the_other_files() -> None:
    check = next(c for c in printed_drive.STEADY if "staircase" in c.words)
    others = {"others_order": 42.3, "others_chance": 0.0025, "own_order": 41.0, "own_apart": 3.0}
    steps = replace(GOOD, figures={"repeats": 0.7})
    assert not check.holds(steps)
    assert check.holds(replace(steps, words="order 42.5 of a turn of the input"))
    assert not check.holds(replace(steps, words="order 35 of a turn of the input"))
    assert check.holds(replace(steps, figures={**steps.figures, **others}))
    for wrong in ({"others_order": 38.0}, {"others_chance": 0.05}, {"own_order": 30.0}):
        assert not check.holds(replace(steps, figures={**steps.figures, **others, **wrong}))
    without_own = {k: v for k, v in others.items() if k != "own_order"}
    assert not check.holds(replace(steps, figures={**steps.figures, **without_own}))


@pytest.mark.parametrize("name", ["preload-order", "preload-order-fitted"])
def test_the_preload_series_is_judged_by_its_order(name: str) -> None:
    (summary,) = (each for each in all_summaries() if each.name == name)
    fitted = name.endswith("fitted")

    def outcome(friction: float, play: float) -> Outcome:
        if fitted:
            limit = {"friction_hysteresis.friction_torque_nm": friction}
            return replace(GOOD, play_deg=play, parameters=limit)
        return replace(GOOD, figures={"loop_friction_nm": friction, "lost_motion_deg": play})

    def outcomes(friction: list[float], play: list[float]) -> dict[str, Outcome]:
        return {
            name: outcome(friction[int(name[6]) - 1], play[int(name[6]) - 1]) for name in summary.of
        }

    assert summary.judged(outcomes([1, 2, 3, 4], [0.4, 0.3, 0.1, 0.105]))[0]
    assert not summary.judged(outcomes([1, 3, 2, 4], [0.4, 0.3, 0.1, 0.1]))[0]
    assert not summary.judged(outcomes([1, 2, 3, 4], [0.3, 0.4, 0.1, 0.1]))[0]


def test_a_pattern_that_fits_no_line_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["--only", "nonesuch", "--list"])
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "nonesuch" in said


def test_the_page_in_docs_asks_what_the_lines_ask(tmp_path: Path) -> None:
    text = (Path(__file__).parents[3] / "docs" / "scoreboard.md").read_text("utf-8")
    for line in all_lines(tmp_path):
        assert f"| {line.name} | {line.asks} | {line.answer} | {line.source} |" in text
