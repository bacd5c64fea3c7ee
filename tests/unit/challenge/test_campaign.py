"""The record across both generators in small, with a stand-in for the diagnosis."""

import io
import json
import math
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
import pytest
from rich.console import Console

from cyclosweep_challenge.campaign import run as campaign_run
from cyclosweep_challenge.campaign.figures import new_figures
from cyclosweep_challenge.campaign.item import Foreign
from cyclosweep_challenge.campaign.making import make_item
from cyclosweep_challenge.campaign.page import campaign_page, write_campaign_page
from cyclosweep_challenge.campaign.parts import parts
from cyclosweep_challenge.campaign.real import real_board, real_figures
from cyclosweep_challenge.campaign.result import Result, make_result
from cyclosweep_challenge.campaign.rivals import OURS, rivals
from cyclosweep_challenge.campaign.run import Campaign, run_campaign
from cyclosweep_challenge.campaign.score import score_of
from cyclosweep_challenge.campaign.summary import BEGIN, END, WORDS, put_summary, summary
from cyclosweep_challenge.campaign.unseen import unseen_of
from cyclosweep_challenge.campaign.verify import _again, verify_campaign
from cyclosweep_challenge.runner.diagnosing import lay_out
from cyclosweep_challenge.runner.work import Options
from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.trial.seal import SealError
from cyclosweep_challenge.trial.tiers import Stratum

PROOF = Path(__file__).parents[3] / "proof"
STAND_IN = Path(__file__).parent / "stand_in.py"
SEED = 4200
SCALE = 0.004


def open_campaign(out: Path, until: float = math.inf, scale: float = SCALE) -> Campaign:
    program = (sys.executable, str(STAND_IN))
    options = Options(program=program, opponents="none", batch=4, until=until)
    return Campaign(out, SEED, scale, samples=300, steps=1, options=options)


def quiet() -> Console:
    return Console(file=io.StringIO(), width=150)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("campaign")
    assert run_campaign(open_campaign(out), quiet())
    return out


@pytest.fixture
def copied(whole: Path, tmp_path: Path) -> Path:
    shutil.copytree(whole, tmp_path / "campaign")
    return tmp_path / "campaign"


def untimed(results: list[Result]) -> list[tuple[Any, ...]]:
    return [(r.outcome.key, r.outcome.verdict, r.outcome.named, r.unseen) for r in results]


def test_every_part_is_published_before_it_is_diagnosed_and_can_be_checked(whole: Path) -> None:
    campaign = open_campaign(whole)
    events = [(line["event"], line["part"]) for line in campaign.ledger.lines]
    names = [part.name for part in campaign.parts]
    assert events == [("sealed", n) for n in names] + [("diagnosed", n) for n in names]
    assert verify_campaign(campaign) == []
    assert not list((whole / "parts" / "loud" / "recordings").iterdir())


def test_out_of_time_goes_on_to_the_same_results(tmp_path: Path, whole: Path) -> None:
    late = open_campaign(tmp_path, until=time.monotonic() - 1.0)
    assert not run_campaign(late, quiet())
    assert late.results() == []
    campaign = open_campaign(tmp_path)
    assert run_campaign(campaign, quiet())
    assert [line["event"] for line in campaign.ledger.lines].count("sealed") == len(campaign.parts)
    same = untimed(open_campaign(whole).results())
    assert str(untimed(campaign.results())) == str(same)


def test_a_changed_answer_or_diagnosis_is_noticed(copied: Path) -> None:
    campaign = open_campaign(copied)
    kept = copied / "parts" / "few" / "diagnoses" / "case-000000" / "diagnosis.json"
    kept.write_text(kept.read_text() + " ")
    with pytest.raises(SealError, match="diagnoses changed"):
        campaign.results()
    assert verify_campaign(campaign, 100) == ["few from 0: diagnoses are not those that were kept"]
    answer = copied / "parts" / "loud" / "answers" / "case-000000.json"
    answer.write_text(answer.read_text().replace('"first"', '"other"'))
    complaints = _again(campaign, campaign.parts[5], campaign.done(campaign.parts[5])[0])
    assert complaints[0].startswith("loud: case-000000.json: hash is")


def test_another_code_seed_or_size_is_refused(
    copied: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ValueError, match="parts: found"):
        open_campaign(copied, scale=0.1)
    with pytest.raises(ValueError, match="multiple of a hundred"):
        Campaign(tmp_path / "other", 4210)
    monkeypatch.setattr(campaign_run, "diagnosis_hash", lambda _: "other")
    with pytest.raises(ValueError, match="mixes no versions"):
        open_campaign(copied)


def test_parts_share_no_seed_and_keep_one_recording_at_any_scale() -> None:
    full = parts()
    assert len({part.offset for part in full}) == len({part.name for part in full}) == len(full)
    assert 1800 < sum(part.cases for part in full) < 2200
    assert all(part.cases == 1 for part in parts(1e-4))
    for part in full:
        ends = [part.slice(step, 10) for step in range(10)]
        assert ends[0][0] == 0
        assert ends[-1][1] == part.cases


def test_parts_are_of_the_noise_and_visibility_that_they_say() -> None:
    by_name = {part.name: part for part in parts()}
    found = make_item(by_name["foreign-correlated"].plan(SEED, 1, 300)[0]).truth
    assert found["noise"]["autocorrelation"] in (0.9, 0.95, 0.97, 0.99)
    assert found["causes"][0]["d_alone"] == pytest.approx(20.0, rel=0.02)
    loud = [kind for kind in by_name["loud"].kinds if isinstance(kind, Stratum)]
    assert {kind.tier for kind in loud} == {"C8"}
    assert {len(kind.d) for kind in loud} == {1, 2, 3, 4}
    rich = Foreign("single", rich=True)
    assert [rich.number(turn) for turn in range(6)] == [0, 1, 2, 4, 5, 6]
    truth = make_item(by_name["loud"].plan(SEED, 1, 300)[0]).truth
    assert truth["causes"][0]["name"] in {"friction_hysteresis", "load_dependent_friction"}
    assert truth["friction_family"] == "library"
    assert truth["held_out_calibrated_rms_deg"] > truth["held_out_fitting_rms_deg"]


def test_a_model_is_shown_the_drive_file_of_its_programme(tmp_path: Path) -> None:
    there = tmp_path / "there"
    there.mkdir()
    for name in ("model.json", "program.csv", "program.toml", "drive.toml", "recording.csv"):
        (there / name).write_text(name)
    names = lay_out(there / "model.json", there / "program.csv", tmp_path / "here")
    copied = {path.name for path in (tmp_path / "here").iterdir()}
    assert copied == {*names, "program.toml", "drive.toml"}


def answer(**more: Any) -> dict[str, Any]:
    cause = {"name": "creep", "kind": "effect", "d": 20.0, "d_alone": 21.0, "rms_deg": 1.0}
    cause |= {"peak_deg": 2.0}
    return {
        "key": "case-000000",
        "stratum": "C8/x",
        "tier": "C8",
        "programme": "rich",
        "noise": {"family": "white"},
        "causes": [cause],
        "effects": ["creep"],
        "aliens": [],
        "aliases": [],
        "calibration": {"datum_deg": 1.0},
    } | more


def said(verdict: str, *names: str) -> dict[str, Any]:
    return {"verdict": verdict, "effects": [{"name": name} for name in names]}


def result(diagnosis: dict[str, Any], part: str = "loud", **more: Any) -> Result:
    return make_result(part, answer(**more), diagnosis, Path("nowhere.csv"))


def small(name: str, d: float, rms_deg: float) -> dict[str, Any]:
    known = {"name": name, "kind": "effect", "d": d, "d_alone": d, "rms_deg": rms_deg}
    return known | {"peak_deg": rms_deg}


def test_share_removed_counts_the_wrong_side_apart(tmp_path: Path) -> None:
    clean = np.array([11.0, 12.0, -9.0, -10.0])
    held = answer(
        held_out_clean_deg=clean.tolist(),
        held_out_calibrated_rms_deg=2.0,
        held_out_fitting_rms_deg=0.2,
    )

    def of(*angles: float) -> Any:
        pl.DataFrame({"angle_deg": angles}).write_csv(tmp_path / "p.csv")
        return unseen_of(held, tmp_path / "p.csv")

    assert of(*clean).removed == 1.0
    assert of(*clean).own == pytest.approx(0.99)
    assert of(*(clean + 2.0)).removed == pytest.approx(0.0)
    assert of(*(clean + 1.0)).relative == pytest.approx(0.75 / 0.99)
    crossed = of(11.0, 12.0, -9.0, 12.0)
    assert (crossed.removed, crossed.wrong_side) == (1.0, 0.25)
    assert crossed.removed_everywhere == pytest.approx(1.0 - 22.0**2 / 4.0 / 4.0)
    chance = unseen_of(held | {"held_out_fitting_rms_deg": 1.9}, tmp_path / "p.csv")
    assert math.isnan(chance.relative)
    nothing = unseen_of(held, tmp_path / "absent.csv")
    assert (nothing.removed, nothing.error_ratio) == (0.0, 1.0)
    assert math.isnan(unseen_of(answer(), tmp_path / "p.csv").relative)


def test_what_counts_as_right_of_a_loud_recording() -> None:
    loud = [small("friction_hysteresis", 1000.0, 1.0), small("creep", 60.0, 0.06)]
    loud.append(small("thermal_drift", 5.0, 0.005))

    def of(*names: str) -> Result:
        return result(said("MOSTLY_EXPLAINED", *names), causes=[dict(c) for c in loud])

    both = of("friction_hysteresis", "creep")
    assert both.dominant_named
    assert both.all_visible_named
    assert both.all_beyond_model_error_named
    assert not both.right
    first = of("friction_hysteresis")
    assert not first.all_visible_named
    assert first.all_beyond_model_error_named
    false = of("friction_hysteresis", "creep", "clearance_takeup")
    assert false.false_name
    assert not false.all_visible_named
    assert not false.all_beyond_model_error_named
    assert not of("creep").dominant_named


def test_what_counts_as_right_of_few_readings() -> None:
    assert result(said("INSUFFICIENT_DATA")).right_or_insufficient
    assert result(said("IDENTIFIED", "creep")).right_or_insufficient
    assert not result(said("NOTHING_MISSING")).right_or_insufficient
    assert not result(said("IDENTIFIED", "friction_hysteresis")).right_or_insufficient
    assert result(said("NOTHING_MISSING"), causes=[], effects=[]).right_or_insufficient
    assert not result(said("UNKNOWN_PHYSICS"), causes=[], effects=[]).right_or_insufficient


def figures(results: list[Result]) -> dict[str, Criterion]:
    return {figure.name: figure for figure in new_figures(results)}


def test_false_alarms_under_correlated_noise_are_judged_by_their_upper_bound() -> None:
    name = "nothing missing, autocorrelation 0.9 to 0.99: false alarms"

    def quiet_part(diagnosis: dict[str, Any]) -> Result:
        noise = {"family": "ar0.97"}
        return result(diagnosis, "correlated-null", causes=[], effects=[], noise=noise)

    silent = quiet_part(said("NOTHING_MISSING"))
    assert figures([silent] * 184)[name].met is True
    assert figures([silent] * 180)[name].met is None
    alarm = quiet_part(said("IDENTIFIED", "creep"))
    assert figures([*[silent] * 250, alarm])[name].met is False


def test_power_is_counted_over_that_of_the_test_that_knows() -> None:
    known = small("creep", 20.0, 1.0) | {"oracle_z": 8.0}
    missed = small("creep", 20.0, 1.0) | {"oracle_z": 0.5}
    there = [
        result(said(verdict), "correlated", causes=[dict(cause)], noise={"family": "ar0.97"})
        for verdict, cause, count in (
            ("IDENTIFIED", known, 6),
            ("NOTHING_MISSING", known, 2),
            ("NOTHING_MISSING", missed, 2),
        )
        for _ in range(count)
    ]
    name = (
        "d = 20, autocorrelation 0.97, first generator: power over that of the test that knows "
        "the effect"
    )
    assert figures(there)[name].estimate.value == pytest.approx(6 / 8)
    assert figures(there)[name].met is False


def test_a_deleted_cause_with_a_false_name_counts_by_generator_and_loudness() -> None:
    loud = [small("creep", 500.0, 1.0)]
    there = [result(said("IDENTIFIED", "thermal_drift"), "deleted", causes=loud)]
    there += [result(said("UNKNOWN_PHYSICS"), "deleted") for _ in range(3)]
    found = figures(there)
    assert found["cause deleted from the library: false name"].estimate.value == 0.25
    assert found["deleted, second generator, loud: false name"].estimate.value == 1.0
    assert found["deleted, second generator, faint: recognised"].estimate.count == 3
    other = "cause deleted from the library: a name of another class of behaviour"
    assert found[other].estimate.value == 0.25
    taken_up = [small("contact_stiffening", 500.0, 1.0)]
    alike = result(said("IDENTIFIED", "clearance_takeup"), "deleted", causes=taken_up)
    assert (alike.false_name, alike.false_class) == (True, False)
    assert figures([*there, alike])[other].estimate.value == 0.2


def test_noise_of_the_torque_is_counted_by_itself() -> None:
    quiet: dict[str, list[Any]] = {"causes": [], "effects": []}
    there = [
        result(said("NOTHING_MISSING"), "torque-noise-null", **quiet),
        result(said("IDENTIFIED", "creep"), "torque-noise-null", **quiet),
        result(said("IDENTIFIED", "creep"), "torque-noise", causes=[small("creep", 20.0, 1.0)]),
        result(said("IDENTIFIED", "creep"), "torque-noise", causes=[small("creep", 60.0, 1.0)]),
        result(said("IDENTIFIED", "creep"), "foreign", causes=[small("creep", 20.0, 1.0)]),
    ]
    found = figures(there)
    alarms = found["nothing missing, noise of the torque reading: false alarms"]
    assert alarms.estimate.value == 0.5
    named = found["foreign laws, d = 20, noise of the torque reading: named right"]
    assert (named.estimate.value, named.estimate.count) == (1.0, 1)


def test_rivals_stand_beside_the_diagnosis_on_the_same_files() -> None:
    nulls = [
        result(said("NOTHING_MISSING"), "null", key=f"n{k}", causes=[], effects=[])
        for k in range(40)
    ]
    singles = [result(said("IDENTIFIED", "creep"), "open", key=f"s{k}") for k in range(10)]
    replies: dict[str, dict[str, Any]] = {
        r.outcome.key: {"x": {"score": float(k), "flagged": k > 37, "named": None}}
        for k, r in enumerate(nulls)
    }
    for k, r in enumerate(singles):
        replies[r.outcome.key] = {
            "x": {"score": 30.0 + 2.0 * k, "flagged": k > 4, "named": ["creep"] if k > 7 else []}
        }
    ours, theirs = rivals([*nulls, *singles], replies)
    assert (ours["who"], ours["named_right"]["value"]) == (OURS, 1.0)
    assert theirs["alarms"]["value"] == 2 / 40
    assert theirs["found"]["value"] == 0.5
    # One in twenty of the quiet ones lies above 38.
    assert theirs["found_tuned"]["value"] == 0.5
    assert theirs["named_right"]["value"] == 0.2
    # Fewer than twenty recordings with nothing missing decide no threshold of one in twenty.
    few, _ = rivals([*nulls[:19], *singles], replies)
    assert few["found_tuned"]["count"] == 0


def test_page_holds_every_figure_with_recordings_and_is_written_from_its_files(
    whole: Path, tmp_path: Path
) -> None:
    campaign = open_campaign(whole)
    before = json.loads((PROOF / "proof.json").read_text())
    content = score_of(campaign, tmp_path / "absent.json", before)
    (tmp_path / "rigs.json").write_text(json.dumps(content))
    shutil.copy(campaign.ledger.file, tmp_path / "rigs-published.jsonl")
    (tmp_path / "rigs-notes.md").write_text("What we learnt.\n")
    page = write_campaign_page(tmp_path).read_text()
    for figure in content["new"] + content["faint"]:
        there = figure["estimate"]["count"] > 0
        assert (f"| {figure['name']} |" in page) == there
        assert there or figure["name"] in page
    assert "What we learnt." in page
    assert content["record"]["diagnosis"] in page
    assert "The scoreboard was not run" in page
    assert sum(row["cases"] for row in content["tables"]["verdicts"]) == len(campaign.results())


def test_summary_stands_between_the_marks_of_the_page_in_plain_words(
    whole: Path, tmp_path: Path
) -> None:
    content = score_of(open_campaign(whole), tmp_path / "absent.json", None)
    page = tmp_path / "proof.md"
    page.write_text(f"before\n{BEGIN}\nwhat was there\n{END}\nafter\n")
    put_summary(page, content)
    words = page.read_text()
    assert words.startswith(f"before\n{BEGIN}\n\nSeed {SEED}, ")
    assert words.endswith(f"{END}\nafter\n")
    assert "what was there" not in words
    aimed = [f for f in content["new"] if f["target"] != "none" and f["estimate"]["count"]]
    assert words.count("\n| ") == len(aimed) + 1
    assert "| loud: the largest effect has its right name |" in words
    page.write_text("no marks")
    put_summary(page, content)
    assert page.read_text() == "no marks"


def test_words_of_the_summary_are_of_figures_that_there_are() -> None:
    assert set(WORDS) <= set(figures([]))


def test_committed_page_is_what_its_figures_give() -> None:
    if not (PROOF / "rigs.json").exists():
        pytest.skip("the record across both generators has not been made")
    content = json.loads((PROOF / "rigs.json").read_text())
    log = [
        json.loads(line)
        for line in (PROOF / "rigs-published.jsonl").read_text("utf-8").splitlines()
    ]
    notes = PROOF / "rigs-notes.md"
    words = notes.read_text().strip() if notes.exists() else ""
    assert (PROOF / "rigs.md").read_text("utf-8") == campaign_page(content, log, words)
    assert summary(content) in (PROOF.parent / "docs" / "proof.md").read_text("utf-8")


def test_measured_loops_are_taken_from_the_scoreboard(tmp_path: Path) -> None:
    file = tmp_path / "scoreboard.json"
    kept = {
        "verdict": "IDENTIFIED",
        "statement": "",
        "figures": {"over_floor": 1.3, "forecast_deg": 0.2},
    }
    other = kept | {"figures": {"over_floor": 1.05, "forecast_deg": 0.2}}
    lines = {"base_runin1": kept, "base_runin5": other}
    file.write_text(json.dumps({"code": "c" * 64, "date": "2026-11-22", "lines": lines}))
    board = real_board(file)
    middle, largest = real_figures(board)
    assert middle.estimate.value == pytest.approx(1.175)
    assert largest.estimate.value == 1.3
    assert (middle.met, largest.met) == (False, True)
    assert real_board(tmp_path / "absent.json") == {}
    assert real_figures({})[0].met is None
