"""Opponents see files only, find what is plain, and are quiet at their tuned setting."""

import json
from pathlib import Path

import numpy as np
import pytest

from cyclosweep_challenge import make_case
from cyclosweep_challenge.opponents import contest
from cyclosweep_challenge.opponents.contest import (
    CHEAP,
    CHEAPEST,
    COSTLY,
    NEEDS,
    libraries_apart,
    meet,
    meet_opponents,
)
from cyclosweep_challenge.opponents.project_library import NAMES, project_views, replies
from cyclosweep_challenge.opponents.subset import best_subset, bic_subset
from cyclosweep_challenge.opponents.view import RecordingView
from cyclosweep_challenge.scoring.opponents import OURS, opponent_curves, tuned
from cyclosweep_challenge.trial.plan import make_plan
from tests.unit.challenge.challenge_answers import diagnosis, outcome, truth

pytestmark = pytest.mark.filterwarnings("ignore")


def seen(folder: Path, **more: object) -> RecordingView:
    make_case(31, samples=1200, **more).write(folder)  # type: ignore[arg-type]
    return RecordingView.read(folder)


@pytest.mark.parametrize("name", [*CHEAP, *COSTLY, "kennedy_ohagan"])
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


@pytest.mark.parametrize("name", NAMES)
def test_regressions_with_the_project_s_library_name_a_plain_effect(
    name: str, tmp_path: Path
) -> None:
    if name in NEEDS:
        pytest.importorskip(NEEDS[name])
    make_case(31, ("creep",), 60.0, samples=1200).write(tmp_path)
    [reply] = replies(tmp_path, (name,)).values()
    assert reply.flagged
    assert "creep" in (reply.named or ())


def test_whitening_takes_correlated_noise_from_a_regression(tmp_path: Path) -> None:
    make_case(31, noise="ar0.9", samples=1200).write(tmp_path)
    views = project_views(tmp_path)
    assert bic_subset(views["project"]).score > 40.0
    assert bic_subset(views["whitened"]).score < 4.0


def test_project_s_library_has_columns_of_unit_size_for_nearly_all_effects(tmp_path: Path) -> None:
    make_case(31, samples=1200).write(tmp_path)
    for view in project_views(tmp_path).values():
        table, names = view.library
        assert table.shape[1] == len(names) > 40
        np.testing.assert_allclose(np.sqrt(np.mean(table**2, axis=0)), 1.0)
        assert len(set(names)) >= 12
        assert view.residual.shape == (len(table),)


def test_opponents_of_a_campaign_are_met_without_clock_or_position(tmp_path: Path) -> None:
    case = make_case(31, ("friction_hysteresis",), 60.0, samples=900)
    folder = case.write(tmp_path)
    case.recording.select("torque_nm", "angle_deg", "run").write_csv(folder / "recording.csv")
    names = tuple(n for n in libraries_apart("all") if n.startswith(("bic", "kennedy")))
    assert len(names) >= 3
    meet(folder, tmp_path, "here", names)
    said = json.loads((tmp_path / "here.json").read_text())
    assert all(said[name]["flagged"] for name in names)
    assert "friction_hysteresis" in said["bic_subset_project"]["named"]
    assert libraries_apart("none") == ()


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
