"""Opponents see files only, find what is plain, and are quiet at their tuned setting."""

from pathlib import Path

import numpy as np
import pytest

from cyclosweep_challenge import make_case
from cyclosweep_challenge.opponents import contest
from cyclosweep_challenge.opponents.contest import CHEAP, CHEAPEST, COSTLY, NEEDS, meet_opponents
from cyclosweep_challenge.opponents.subset import best_subset, bic_subset
from cyclosweep_challenge.opponents.view import RecordingView
from cyclosweep_challenge.scoring.opponents import OURS, opponent_curves, tuned
from cyclosweep_challenge.trial.plan import make_plan
from tests.unit.challenge.challenge_answers import diagnosis, outcome, truth

pytestmark = pytest.mark.filterwarnings("ignore")


def seen(folder: Path, **more: object) -> RecordingView:
    make_case(31, samples=1200, **more).write(folder)  # type: ignore[arg-type]
    return RecordingView.read(folder)


@pytest.mark.parametrize("name", [*CHEAP, *COSTLY])
def test_each_scores_a_plain_effect_above_nothing(name: str, tmp_path: Path) -> None:
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    opponent = contest._entrants([name])[name]
    quiet = opponent(seen(tmp_path / "a"))
    loud = opponent(seen(tmp_path / "b", effects=("friction_hysteresis",), d=60.0))
    assert loud.score > quiet.score
    assert loud.flagged


def test_library_is_free_of_the_baseline_and_of_near_duplicates(tmp_path: Path) -> None:
    recording = seen(tmp_path)
    table, names = recording.library
    assert np.abs(recording.baseline.T @ table).max() < 1e-6
    overlap = np.abs(table.T @ table) / len(table) - np.eye(len(names))
    assert overlap.max() < 0.96
    assert len(set(names)) >= 10


def test_best_subset_agrees_with_least_squares(tmp_path: Path) -> None:
    recording = seen(tmp_path, effects=("creep",), d=40.0)
    table, names = recording.library
    found = best_subset(recording, 1e9)
    single = []
    for k in range(len(names)):
        weight = table[:, k] @ recording.residual / (table[:, k] @ table[:, k])
        left = recording.residual - weight * table[:, k]
        single.append(recording.residual.size * -np.log(np.var(left) / np.var(recording.residual)))
    assert found.score == pytest.approx(max(single) - 1e9, abs=1e-2)
    assert "creep" in (bic_subset(recording).named or ())


def test_only_recordings_fit_for_comparison_are_shown(tmp_path: Path) -> None:
    plan = make_plan(200, 1)
    jobs = meet_opponents(plan, tmp_path, tmp_path, "cheap", 5)
    fit = [
        e
        for e in plan
        if e.stratum.tier in {"C0", "C6"} and e.stratum.programme in {"rich", "poor"}
    ]
    shown = {arguments[2]: set(arguments[3]) for _, arguments in jobs}
    assert set(shown) == {e.key for e in fit}
    for entry in fit:
        white = entry.stratum.noise == "white"
        assert shown[entry.key] == (set(CHEAP) if white else set(CHEAPEST))
    later = meet_opponents(plan, tmp_path, tmp_path, "cheap", 5, first=100)
    assert {arguments[2] for _, arguments in later} == {e.key for e in fit if e.number >= 100}
    # Of other noise only so many are shown as of white to the costly ones.
    none = meet_opponents(plan, tmp_path, tmp_path, "cheap", 0)
    assert len(none) == sum(e.stratum.noise == "white" for e in fit)
    assert meet_opponents(plan, tmp_path, tmp_path, "none", 5) == []
    with pytest.raises(ValueError, match="opponents"):
        meet_opponents(plan, tmp_path, tmp_path, "some", 5)


def test_tuned_threshold_lets_one_in_a_hundred_through() -> None:
    rng = np.random.default_rng(8)
    nulls, singles, words = [], [], {}
    for k in range(400):
        nulls.append(outcome({**truth(tier="C6"), "key": f"n{k}"}, diagnosis("NOTHING_MISSING")))
        words[f"n{k}"] = {"x": {"score": rng.normal(), "flagged": True, "named": None}}
    for k in range(100):
        singles.append(outcome({**truth("creep"), "key": f"s{k}"}, diagnosis("NOTHING_MISSING")))
        words[f"s{k}"] = {"x": {"score": rng.normal() + 5.0, "flagged": True, "named": None}}
    curve, own = opponent_curves([*nulls, *singles], words)
    assert (curve.who, own.who) == ("x", OURS)
    assert dict(curve.own.alarms)["white"].value <= 0.01
    assert curve.default_alarms.value == 1.0
    assert curve.own.power[0][1].value > 0.97
    assert curve.own.naming == ()
    assert curve.every is None


def test_every_family_counts_the_same_whatever_its_size() -> None:
    statistics = np.concatenate([np.zeros(9900), np.ones(99), [2.0]])
    assert tuned(statistics) == 0.0
    weights = np.concatenate([np.full(9900, 0.5 / 9900), np.full(100, 0.5 / 100)])
    # One in a hundred of both alike is two in a hundred of the hundred.
    assert tuned(statistics, weights) == 1.0
    counts = np.repeat([1.0, 4.0], [50, 50])
    assert tuned(np.arange(100.0), counts) == 99.0
