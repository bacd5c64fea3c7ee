"""A whole challenge in small, with a stand-in for the diagnosis."""

import io
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from filelock import FileLock
from rich.console import Console

from cyclosweep_challenge.runner.folders import LOCK
from cyclosweep_challenge.runner.run import run_challenge
from cyclosweep_challenge.runner.verify import verify_run
from cyclosweep_challenge.runner.work import Options
from cyclosweep_challenge.trial.seal import SealError

STAND_IN = Path(__file__).parent / "stand_in.py"
OPTIONS = Options(program=(sys.executable, str(STAND_IN)), opponents="none", batch=4)


def run(cases: int, out: Path, options: Options = OPTIONS) -> tuple[dict[str, Any], str]:
    text = io.StringIO()
    console = Console(file=text, width=160)
    run_challenge(cases, 17, out, 1, mix="open", samples=500, options=options, console=console)
    return json.loads((out / "score.json").read_text()), text.getvalue()


def test_runs_goes_on_and_notices_a_changed_answer(tmp_path: Path) -> None:
    score, text = run(6, tmp_path)
    assert score["about"]["cases"] == 6
    assert text.index("answers committed: SHA-256") < text.index("figure")
    assert (tmp_path / "score.html").exists()
    first = (tmp_path / "diagnoses" / "case-000003" / "diagnosis.json").stat().st_mtime_ns
    shown = sorted(p.name for p in (tmp_path / "recordings" / "case-000000").iterdir())
    assert shown == ["program.csv", "recording.csv", "recording.toml"]

    score, _ = run(8, tmp_path)
    assert score["about"]["cases"] == 8
    again = (tmp_path / "diagnoses" / "case-000003" / "diagnosis.json").stat().st_mtime_ns
    assert again == first

    answer = tmp_path / "answers" / "case-000001.json"
    other = tmp_path / "answers" / "case-000002.json"
    answer.write_bytes(other.read_bytes())
    with pytest.raises(SealError, match="published"):
        run(8, tmp_path)


def test_a_finished_run_can_be_checked_from_its_folder(tmp_path: Path) -> None:
    run(3, tmp_path)
    assert verify_run(tmp_path) == []
    recording = tmp_path / "recordings" / "case-000001" / "recording.csv"
    recording.write_text(recording.read_text().replace("1", "2", 1))
    (complaint,) = verify_run(tmp_path)
    assert complaint == "case-000001/recording.csv: not what the seed gives"


def test_a_folder_holds_one_challenge_only(tmp_path: Path) -> None:
    run(1, tmp_path)
    with pytest.raises(ValueError, match="another folder"):
        run_challenge(1, 18, tmp_path, 1, mix="open", samples=500, options=OPTIONS)


def test_a_diagnosis_that_breaks_is_counted_not_hidden(tmp_path: Path) -> None:
    broken = Options(program=(sys.executable, "-c", "raise SystemExit(1)"), opponents="none")
    score, _ = run(2, tmp_path, broken)
    failures = [f for f in score["figures"] if f["name"] == "no answer at all"]
    assert failures[0]["estimate"]["value"] == 1.0


def test_batches_keep_every_worker_busy_and_lose_nothing() -> None:
    options = Options(workers=2, batch=50)
    for count, largest in ((0, 0), (1, 1), (38, 10), (144, 36), (400, 50)):
        batches = list(options.batches(range(count)))
        assert [k for batch in batches for k in batch] == list(range(count))
        assert max(map(len, batches), default=0) == largest


def test_another_noise_takes_the_place_of_white_noise(tmp_path: Path) -> None:
    options = Options(program=(sys.executable, str(STAND_IN)), opponents="cheap")
    quiet = Console(file=io.StringIO())

    def contest(noise: str) -> None:
        run_challenge(
            9, 17, tmp_path, mix="contest", noise=noise, samples=500, options=options, console=quiet
        )

    contest("ar0.6")
    outcomes = json.loads((tmp_path / "outcomes.json").read_text())
    assert {o["noise"] for o in outcomes} == {"ar0.6"}
    assert {o["tier"] for o in outcomes} == {"C0", "C6"}
    score = json.loads((tmp_path / "score.json").read_text())
    assert score["about"]["noise"] == "ar0.6"
    assert {o["noise"] for o in score["opponents"]} == {"ar0.6"}
    assert verify_run(tmp_path, 3) == []
    with pytest.raises(ValueError, match="another folder"):
        contest("white")
    with pytest.raises(ValueError, match="noise: found 'pink'"):
        contest("pink")


def test_a_folder_belongs_to_one_process(tmp_path: Path) -> None:
    with FileLock(tmp_path / LOCK), pytest.raises(ValueError, match="another process"):
        run(2, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} <= {LOCK}
