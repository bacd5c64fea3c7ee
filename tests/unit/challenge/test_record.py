"""The run of record in small, with a stand-in for the diagnosis."""

import io
import json
import shutil
import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from rich.console import Console

from cyclosweep_challenge.opponents import contest as opponents_contest
from cyclosweep_challenge.record import run as record_run
from cyclosweep_challenge.record.command import main
from cyclosweep_challenge.record.compare import fits, pairs
from cyclosweep_challenge.record.ledger import Ledger
from cyclosweep_challenge.record.paper import write_pages, write_paper
from cyclosweep_challenge.record.parts import COLOURED, CONTEST, CONTEST_POOR, FULL, SUBSET, Size
from cyclosweep_challenge.record.run import Record, RecordOptions, run_record
from cyclosweep_challenge.record.verify import verify_log, verify_record
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.runner.folders import LOCK
from cyclosweep_challenge.runner.work import Options, OutOfTimeError
from cyclosweep_challenge.trial.plan import Entry, make_entry
from cyclosweep_challenge.trial.seal import SealError

PROOF = Path(__file__).parents[3] / "proof"
STAND_IN = Path(__file__).parent / "stand_in.py"
OPTIONS = Options(program=(sys.executable, str(STAND_IN)), opponents="none", batch=4)
SMALL = Size(null=4, opened=4, concealed=2, tuning=2, coloured=2, samples=300, steps=2)


def quiet() -> Console:
    return Console(file=io.StringIO(), width=150)


def make(out: Path, **changes: Any) -> dict[str, Any]:
    options = replace(OPTIONS, **changes)
    run_record(Record(out, 40, SMALL, RecordOptions(options)), quiet())
    score: dict[str, Any] = json.loads((out / "score.json").read_text())
    return score


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("record")
    make(out)
    return out


def events(out: Path) -> list[tuple[str, str, int]]:
    lines = (out / "PUBLISHED.jsonl").read_text().splitlines()
    return [(e["event"], e["part"], e["first"]) for e in map(json.loads, lines)]


def test_every_slice_is_published_before_it_is_diagnosed(whole: Path) -> None:
    found = events(whole)
    for event, part, first in found:
        if event == "diagnosed":
            assert found.index(("sealed", part, first)) < found.index((event, part, first))
    assert len([e for e in found if e[0] == "diagnosed"]) == 10
    assert verify_record(whole) == []


def test_all_parts_grow_together(whole: Path) -> None:
    order = [part for event, part, _ in events(whole) if event == "sealed"]
    assert order == ["null", "open", "concealed", "tuning", COLOURED] * 2
    for size in (FULL, SUBSET, CONTEST, CONTEST_POOR):
        ends = {part.name: last for part, _, last in size.slices()}
        assert ends == {part.name: part.cases for part in size.parts() if part.cases}


def test_parts_of_a_full_record_are_whole_turns_of_their_plans() -> None:
    assert FULL.null == 10 * 1000
    assert FULL.opened == 12 * 300


def test_a_diagnosis_never_runs_on_what_is_not_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen = []

    def look(plan: list[Entry], *_: object) -> None:
        log = Ledger(tmp_path / "PUBLISHED.jsonl")
        assert log.lines[-1]["event"] == "sealed"
        assert log.lines[-1]["answers"] == len(plan)
        seen.append(len(plan))
        raise OutOfTimeError

    monkeypatch.setattr(record_run, "diagnose", look)
    make(tmp_path)
    assert seen == [2]


def test_out_of_time_is_scored_and_goes_on_to_the_same_score(tmp_path: Path, whole: Path) -> None:
    empty = make(tmp_path, until=time.monotonic() - 1.0)
    assert empty["about"]["cases"] == 0
    record = Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS))
    part, first, last = next(SMALL.slices())
    record.run_slice(part, first, last, quiet())
    partial = make(tmp_path, until=time.monotonic() - 1.0)
    assert partial["about"]["parts"]["null"] == 2
    assert untimed(make(tmp_path)) == untimed(json.loads((whole / "score.json").read_text()))


def test_a_kill_between_two_diagnoses_costs_nothing(tmp_path: Path, whole: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    log = tmp_path / "PUBLISHED.jsonl"
    lines = log.read_text().splitlines(keepends=True)
    # As if killed in the last slice: one diagnosis was there, one was not, and half a line.
    log.write_text("".join(lines[:-1]) + lines[-1][:20])
    shown = tmp_path / "parts" / COLOURED
    record = Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS))
    last = record.plan(record.size.parts()[-1], 2)[1]
    make_entry(last).write(shown / "recordings" / last.key)
    (shown / "diagnoses" / last.key / "diagnosis.json").unlink()
    before = untimed(json.loads((whole / "score.json").read_text()))
    assert untimed(make(tmp_path)) == before
    assert verify_record(tmp_path) == []


def untimed(score: dict[str, Any]) -> list[dict[str, Any]]:
    return [f for f in score["figures"] if "time" not in f["name"]]


def test_another_version_of_the_diagnosis_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    Record(tmp_path, 40, SMALL)
    monkeypatch.setattr(record_run, "code", lambda: {"diagnosis": "other", "rig": "other"})
    with pytest.raises(ValueError, match="mixes no versions"):
        Record(tmp_path, 40, SMALL)
    Record(tmp_path, 40, SMALL, fresh=True)


def test_another_seed_or_size_is_refused_and_only_records_are_deleted(tmp_path: Path) -> None:
    Record(tmp_path / "a", 40, SMALL)
    with pytest.raises(ValueError, match="seed"):
        Record(tmp_path / "a", 50, SMALL)
    with pytest.raises(ValueError, match="size"):
        Record(tmp_path / "a", 40, FULL)
    with pytest.raises(ValueError, match="multiple of ten"):
        Record(tmp_path / "b", 41, SMALL)
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "mine.txt").write_text("mine")
    with pytest.raises(ValueError, match="not deleted"):
        Record(tmp_path / "c", 40, SMALL, fresh=True)


def test_a_changed_log_or_diagnosis_is_noticed(tmp_path: Path, whole: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    kept = tmp_path / "parts" / "null" / "diagnoses" / "case-000001" / "diagnosis.json"
    good = kept.read_text()
    kept.write_text(good.replace("NOTHING_MISSING", "IDENTIFIED") + " ")
    with pytest.raises(SealError, match="diagnoses changed"):
        make(tmp_path)
    assert any("not those that were kept" in words for words in verify_record(tmp_path))
    kept.write_text(good)
    log = tmp_path / "PUBLISHED.jsonl"
    log.write_text(log.read_text().replace('"answers": 2', '"answers": 4', 1))
    with pytest.raises(SealError, match="does not follow"):
        Record(tmp_path, 40, SMALL)
    assert "does not follow" in verify_record(tmp_path)[0]


@pytest.mark.parametrize("name", ["proof", "contest", "contest-poor"])
def test_published_logs_are_unbroken_and_lead_to_their_figures(name: str) -> None:
    log, figures = PROOF / f"{name}-published.jsonl", PROOF / f"{name}.json"
    assert verify_log(log, figures) == []
    with pytest.raises(SystemExit) as ended:
        main(["--verify-log", str(log)])
    assert ended.value.code == 0


def test_what_is_wrong_with_a_published_log_is_found(tmp_path: Path) -> None:
    log, figures = PROOF / "proof-published.jsonl", PROOF / "proof.json"
    lines = log.read_text().splitlines(keepends=True)

    def complaints(*kept: str) -> list[str]:
        (tmp_path / "log.jsonl").write_text("".join(kept))
        return verify_log(tmp_path / "log.jsonl", figures)

    assert complaints(*lines) == []
    assert "line 3 does not follow" in complaints(*lines[:2], *lines[3:])[0]
    assert "head of the log" in complaints(*lines[:-1])[0]
    assert complaints()[0] == "log.jsonl: no lines"
    # Written anew with hashes that fit: a slice was diagnosed before it was published.
    swapped = Ledger(tmp_path / "again.jsonl")
    for entry in map(json.loads, [lines[1], lines[0]]):
        swapped.append(
            entry["event"],
            **{k: entry[k] for k in ("part", "first", "last", "answers") if k in entry},
        )
    assert verify_log(tmp_path / "again.jsonl") == [
        "null from 0: diagnosed before it was published"
    ]


def test_words_of_the_opponents_are_laid_beside_the_right_part(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    for part in ("null", "open"):
        file = tmp_path / "parts" / part / "opponents" / "case-000001.json"
        file.write_text(json.dumps({"who": {"score": 1.0, "flagged": True, "named": None}}))
    # A case that is made but not yet part of a finished slice does not count.
    (tmp_path / "parts" / "open" / "opponents" / "case-000099.json").write_text("{}")
    outcomes, diagnosis = Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS)).outcomes()
    assert set(diagnosis) == {"null/case-000001", "open/case-000001"}
    assert set(diagnosis) < {outcome.key for outcome in outcomes}


def test_recordings_are_gone_and_made_again_for_the_check(whole: Path) -> None:
    assert not list((whole / "parts" / "null" / "recordings").iterdir())
    again = whole / "parts" / "open" / "recordings" / "case-000000"
    again.mkdir()
    (again / "recording.csv").write_text("torque_nm,angle_deg\n")
    assert verify_record(whole, 6) == ["open/case-000000/recording.csv: not what the seed gives"]
    (again / "recording.csv").unlink()
    again.rmdir()


def test_page_of_record_holds_every_figure_and_the_notes(whole: Path, tmp_path: Path) -> None:
    (tmp_path / "proof-notes.md").write_text("What we learnt.\n")
    page = write_paper(whole, tmp_path).read_text()
    record = json.loads((tmp_path / "proof.json").read_text())
    for figure in record["figures"]:
        assert f"| {figure['name']} |" in page
    assert "What we learnt." in page
    assert record["record"]["diagnosis"] in page
    assert (tmp_path / "proof-power-rich.svg").read_text().startswith("<svg xmlns=")
    log = (tmp_path / "proof-published.jsonl").read_text()
    assert log == (whole / "PUBLISHED.jsonl").read_text()


def test_page_of_record_shows_every_contest(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    record = Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS))
    outcomes, _ = record.outcomes()
    [null, *_] = [o for o in outcomes if o.tier == "C6"]
    [white, *_] = [o for o in outcomes if o.key.startswith("open/")]
    nulls = [
        replace(null, key=f"null/{noise}{k}", noise=noise, programme="rich")
        for noise in NOISES
        for k in range(12)
    ]
    singles = [
        replace(white, key=f"{part}/{k}", noise=noise, programme="rich", d=float(3 + k % 4))
        for part, noise in (("open", "white"), (COLOURED, "ar0.6"))
        for k in range(24)
    ]
    every = [*nulls, *singles]
    diagnosis = {
        o.key: {"who": {"score": o.d + 0.01 * k, "flagged": True, "named": None}}
        for k, o in enumerate(every)
    }
    score = record.score(every, diagnosis).as_dict()
    assert {f["name"] for f in score["figures"]} >= {
        "opponents at 1 % on ar0.6 noise behind the diagnosis as it is, rich",
        "opponents at 1 % over all ten families of noise behind the diagnosis as it is, rich",
    }
    # What is aside counts in no other figure.
    named = next(f for f in score["figures"] if f["name"].startswith("d for 90 % power, rich"))
    assert named["estimate"]["count"] in (0, 24)
    (tmp_path / "score.json").write_text(json.dumps(score))
    page = write_paper(tmp_path, tmp_path / "docs").read_text()
    for title in ("white noise", "noise ar0.6", "thresholds set over all families of noise"):
        part = page.split(f"#### Rich programme, {title}\n")[1].split("####")[0]
        assert "| who |" in part
    for name in ("rich", "rich-ar0.6", "rich-every-family"):
        assert (tmp_path / "docs" / f"proof-power-{name}.svg").exists()


def test_parts_of_a_contest_are_of_one_programme_and_noise_and_share_no_seed() -> None:
    parts = {part.name: part for part in CONTEST.parts() if part.cases}
    assert [part.offset for part in Size().parts()] == list(range(10))
    kinds = {
        name: {(e.stratum.tier, e.stratum.programme, e.stratum.noise) for e in part.plan(50, 60, 9)}
        for name, part in parts.items()
        if part.programme
    }
    assert kinds == {
        "rich_null": {("C6", "rich", "white")},
        "poor_null": {("C6", "poor", "white")},
        "coloured_rich_null": {("C6", "rich", "ar0.6")},
        "coloured_poor_null": {("C6", "poor", "ar0.6")},
        "rich_open": {("C0", "rich", "white")},
    }


def test_a_contest_on_one_programme_has_no_other() -> None:
    parts = [part for part in CONTEST_POOR.parts() if part.cases]
    assert CONTEST_POOR.is_contest
    kinds = {
        part.name: {
            (e.stratum.tier, e.stratum.programme, e.stratum.noise) for e in part.plan(60, 90, 9)
        }
        for part in parts
    }
    assert kinds == {
        "open": {("C0", "poor", "white")},
        COLOURED: {("C0", "poor", "ar0.6")},
        "poor_null": {("C6", "poor", "white")},
        "coloured_poor_null": {("C6", "poor", "ar0.6")},
    }
    assert all("poor programme" in part.what for part in parts)


def test_a_contest_alone_has_its_page_beside_the_proof(
    whole: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # The others have tests of their own and no row that is looked at here.
    for names in ("CHEAP", "CHEAPEST"):
        few = ("aic_subset", "bic_subset", "error_ladder")
        monkeypatch.setattr(opponents_contest, names, few)
    size = replace(CONTEST, opened=24, coloured=12, rich_open=12, samples=200, steps=1)
    size = replace(size, rich_null=4, poor_null=4, coloured_rich_null=4, coloured_poor_null=4)
    out, docs = tmp_path / "contest", tmp_path / "docs"
    write_paper(whole, docs)
    options = RecordOptions(replace(OPTIONS, opponents="cheap", batch=50))
    run_record(Record(out, 40, size, options), quiet())
    page = write_paper(out, docs)
    assert page.name == "contest.md"
    words = page.read_text()
    behind = words.split("## Who is behind")[1].split("##")[0]
    for row in (
        "| white | rich | bic_subset |",
        "| white | poor | error_ladder |",
        "| ar0.6 | poor | aic_subset |",
    ):
        assert row in behind
    # Figures for which there are cases, none of the rest of the proof.
    assert "| false alarms, white |" in words
    assert "| false alarms, ar0.6 |" in words
    assert "| false alarms, jitter |" not in words
    assert "two effects ten to one" not in words
    assert (docs / "contest-power-rich-ar0.6.svg").exists()
    # The table of targets of the whole proof shows it too.
    assert "[contest.md](contest.md)" in (docs / "proof.md").read_text()
    assert not (out / "measured").exists()

    # A second contest, on one programme, has a page of its own that shows no other.
    poor = replace(CONTEST_POOR, opened=24, coloured=12, samples=200, steps=1)
    poor = replace(poor, poor_null=8, coloured_poor_null=8)
    run_record(Record(tmp_path / "poor", 60, poor, options), quiet())
    page = write_paper(tmp_path / "poor", docs)
    assert page.name == "contest-poor.md"
    words = page.read_text()
    assert "make proof-contest-poor CONTEST_POOR_SEED=60" in words
    behind = words.split("## Who is behind")[1].split("##")[0]
    assert "| ar0.6 | poor | bic_subset |" in behind
    assert "| rich |" not in behind
    assert "Rich programme" not in words
    pictures = {picture.name for picture in docs.glob("contest-poor-*.svg")}
    assert pictures == {"contest-poor-power-poor.svg", "contest-poor-power-poor-ar0.6.svg"}
    for other in ("proof", "contest"):
        assert "contest-poor.md" in (docs / f"{other}.md").read_text()


def test_committed_pages_are_what_their_figures_give(tmp_path: Path) -> None:
    for kind in ("*.json", "*-published.jsonl", "*-notes.md"):
        for file in PROOF.glob(kind):
            shutil.copy(file, tmp_path)
    given = set(tmp_path.iterdir())
    names = [page.stem for page in write_pages(tmp_path)]
    made = {file.name: file.read_text() for file in set(tmp_path.iterdir()) - given}
    assert "proof" in names
    there = [
        f for name in names for f in (PROOF / f"{name}.md", *PROOF.glob(f"{name}-power-*.svg"))
    ]
    assert made == {file.name: file.read_text() for file in there}


def test_a_record_begun_before_a_part_was_thought_of_is_the_same_without_it(
    whole: Path, tmp_path: Path
) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    file = tmp_path / "record.json"
    about = json.loads(file.read_text())
    del about["size"]["rich_open"], about["size"]["poor_null"], about["size"]["programme"]
    file.write_text(json.dumps(about))
    before = [f.read_text() for f in (file, tmp_path / "PUBLISHED.jsonl")]
    Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS))
    assert [f.read_text() for f in (file, tmp_path / "PUBLISHED.jsonl")] == before


def test_a_part_may_be_added_to_a_record_and_is_written_down(whole: Path, tmp_path: Path) -> None:
    shutil.copytree(whole, tmp_path, dirs_exist_ok=True)
    file = tmp_path / "record.json"
    about = json.loads(file.read_text())
    del about["size"][COLOURED]
    file.write_text(json.dumps(about))
    more = replace(SMALL, coloured=SMALL.coloured + 2)
    record = Record(tmp_path, 40, more, RecordOptions(OPTIONS))
    assert record.ledger.lines[-1]["event"] == "part added"
    assert record.ledger.lines[-1][COLOURED] == more.coloured
    assert json.loads(file.read_text())["size"][COLOURED] == more.coloured
    with pytest.raises(ValueError, match="size: found"):
        Record(tmp_path, 40, SMALL, RecordOptions(OPTIONS))
    # The programme of the effects is nothing that can be added.
    about = json.loads(file.read_text())
    del about["size"]["programme"]
    file.write_text(json.dumps(about))
    with pytest.raises(ValueError, match="size: found"):
        Record(tmp_path, 40, replace(more, programme="poor"), RecordOptions(OPTIONS))


def test_notes_on_another_record_say_so(whole: Path, tmp_path: Path) -> None:
    notes = tmp_path / "proof-notes.md"
    notes.write_text("On the record of seed 40.\n")
    assert "Not yet rewritten" not in write_paper(whole, tmp_path).read_text()
    notes.write_text("On the record of seed 30.\n")
    assert "Not yet rewritten for the record of seed 40" in write_paper(whole, tmp_path).read_text()


def test_the_command_makes_goes_on_and_starts_afresh(tmp_path: Path) -> None:
    sizes = ("null", "opened", "concealed", "tuning", COLOURED, "costly-nulls", "costly-open")
    tiny = [word for name in sizes for word in (f"--{name}", "0")]
    out = tmp_path / "record"
    words = ["--out", str(out), "--seed", "40", "--steps", "1", *tiny]
    for more in ([], ["--docs", str(tmp_path / "docs")], ["--fresh"]):
        with pytest.raises(SystemExit) as ended:
            main([*words, *more])
        assert ended.value.code == 0
    assert (tmp_path / "docs" / "proof.md").exists()
    with FileLock(out / LOCK), pytest.raises(SystemExit) as ended:
        main([*words, "--fresh"])
    assert ended.value.code == 2
    assert (out / "record.json").exists()


def test_pages_are_written_again_by_the_command(whole: Path, tmp_path: Path) -> None:
    page = write_paper(whole, tmp_path)
    good = page.read_text()
    page.write_text("")
    for words, status in ((["--pages", str(tmp_path)], 0), (["--pages", str(tmp_path / "x")], 2)):
        with pytest.raises(SystemExit) as ended:
            main(words)
        assert ended.value.code == status
    assert page.read_text() == good
    (tmp_path / "proof-published.jsonl").unlink()
    with pytest.raises(ValueError, match="missing, expected the log"):
        write_pages(tmp_path)


def test_figures_of_two_runs_agree_within_their_intervals(whole: Path) -> None:
    near = {"value": 0.90, "low": 0.86, "high": 0.93, "count": 300}
    far = {"value": 0.60, "low": 0.50, "high": 0.70, "count": 90}
    assert fits(near, {**near, "value": 0.92, "low": 0.89, "high": 0.95})
    assert not fits(near, far)
    kinds = {"x": True, "time of it": False}
    ours = {"figures": [{"name": n, "estimate": near, "comparable": c} for n, c in kinds.items()]}
    record = {"figures": [{"name": n, "estimate": near} for n in kinds]}
    assert [p.name for p in pairs(ours, record)] == ["x"]


def test_what_belongs_to_a_machine_or_a_number_of_cases_is_not_compared(whole: Path) -> None:
    figures = json.loads((whole / "score.json").read_text())["figures"]
    own = {f["name"] for f in figures if not f["comparable"]}
    assert own == {
        "calibration error of stated probabilities",
        "the same if every stated probability were exact",
        "time of a diagnosis as run here, s, median",
        "time of the verdict alone, s, median",
        "time of the verdict alone, s, 95 of 100 within",
        "time of the whole report, s, median",
        "time of the whole report, s, 95 of 100 within",
    }
