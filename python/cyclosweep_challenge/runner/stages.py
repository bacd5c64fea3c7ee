"""Stages of a challenge: recordings and committed answers, diagnoses, predictions, scoring."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import polars as pl
from rich.console import Console

from cyclosweep_challenge.board.gallery import Exhibit, choose, exhibit
from cyclosweep_challenge.runner.diagnosing import (
    diagnose_batch,
    predict,
    predict_batch,
    read_diagnosis,
)
from cyclosweep_challenge.runner.folders import Folders
from cyclosweep_challenge.runner.work import Options, program_of, work
from cyclosweep_challenge.scoring.outcome import HeldOut, Outcome, make_outcome
from cyclosweep_challenge.trial.plan import Entry, make_entry
from cyclosweep_challenge.trial.seal import commit_answer, reveal_answer


def _prepare(entry: Entry, recordings: Path, target: Path) -> tuple[str, str]:
    """Make one case, write its recording, commit to its answer; return key and hash."""
    case = make_entry(entry)
    # With nothing missing there is no repaired model whose predictions would be scored, and a
    # programme for each of ten thousand nulls would take gigabytes.
    predicted = entry.stratum.tier != "C6"
    written = case.write(recordings / entry.key, program=predicted)
    answer = dict(case.truth)
    # With these a recording can be checked, or made again, after it was deleted.
    answer["files"] = {
        file.name: hashlib.sha256(file.read_bytes()).hexdigest()
        for file in sorted(written.iterdir())
    }
    if predicted:
        answer["held_out_clean_deg"] = case.held_out_clean_deg.round(5).tolist()
        answer["held_out_read_deg"] = case.held_out_read_deg.round(5).tolist()
    return entry.key, commit_answer(answer, target)


def prepare(plan: Sequence[Entry], folders: Folders, options: Options, console: Console) -> str:
    """Write every recording, commit to every answer; return the root of the hashes."""
    hashes = folders.hashes()
    missing = [entry for entry in plan if entry.key not in hashes]
    made = 0

    def keep(result: tuple[str, str]) -> None:
        nonlocal made
        hashes[result[0]] = result[1]
        made += 1
        if made % 200 == 0:
            folders.publish(hashes)

    jobs = [(_prepare, (entry, folders.recordings, folders.answer(entry.key))) for entry in missing]
    try:
        work("recordings", options.workers, jobs, console, keep, until=options.until)
    finally:
        root = folders.publish(hashes)
    return root


def _removed(entry: Entry, folders: Folders) -> str:
    """Effect that a case's diagnosis has to do without; empty for none."""
    if entry.stratum.tier != "C5-removed":
        return ""
    answer = reveal_answer(folders.answer(entry.key), folders.hashes()[entry.key])
    return str(answer["removed"])


def diagnose(plan: Sequence[Entry], folders: Folders, options: Options, console: Console) -> None:
    """Let the diagnosis see every recording, in processes of its own."""
    waiting: dict[tuple[str, ...], list[str]] = {}
    for entry in plan:
        if not (folders.diagnoses / entry.key / "diagnosis.json").exists():
            removed = _removed(entry, folders)
            flags: tuple[str, ...] = (options.removal_flag, removed) if removed else ()
            waiting.setdefault(flags, []).append(entry.key)
    jobs: list[tuple[Callable[..., None], tuple[Any, ...]]] = []
    program = program_of(options)
    for flags, keys in waiting.items():
        for batch in options.batches(keys):
            some = {key: folders.recordings / key for key in batch}
            every = (*options.diagnose_flags, *flags)
            jobs.append(
                (diagnose_batch, (some, folders.diagnoses, every, options.limit_s, program))
            )
    work("diagnoses", options.workers, jobs, console, until=options.until, processes=False)


def predict_all(
    plan: Sequence[Entry], folders: Folders, options: Options, console: Console
) -> None:
    """Let every model that named something predict its specimen's second programme."""
    waiting = []
    for entry in plan:
        target = folders.diagnoses / entry.key
        model, done = target / "model.json", target / "prediction.csv"
        later = folders.recordings / entry.key / "program.csv"
        if model.exists() and later.exists() and not done.exists():
            diagnosis = read_diagnosis(folders.diagnoses, entry.key)
            if diagnosis.get("verdict") == "IDENTIFIED":
                waiting.append((model, later, done))
    jobs = [
        (predict_batch, (batch, options.limit_s, options.program))
        for batch in options.batches(waiting)
    ]
    work("predictions", options.workers, jobs, console, until=options.until, processes=False)


def held_out_ratio(answer: dict[str, Any], prediction: Path) -> HeldOut:
    """Error of a prediction over the true model's own, both against what was read [-]."""
    if not prediction.exists():
        return HeldOut()
    predicted = pl.read_csv(prediction)["angle_deg"].cast(pl.Float64).to_numpy()
    read = np.array(answer["held_out_read_deg"])
    clean = np.array(answer["held_out_clean_deg"])
    if predicted.size != read.size or not np.isfinite(predicted).any():
        return HeldOut()
    there = np.isfinite(predicted)
    error = np.sqrt(np.mean((predicted - read)[there] ** 2))
    own = np.sqrt(np.mean((clean - read)[there] ** 2))
    fitted = np.hypot(own, answer["held_out_fitting_rms_deg"])
    return HeldOut(known=float(error / own), fitted=float(error / fitted))


def reveal_answers(plan: Sequence[Entry], folders: Folders) -> list[Outcome]:
    """Reveal the answers, check their hashes and score the diagnoses by them."""
    hashes = folders.hashes()
    outcomes = []
    for entry in plan:
        answer = reveal_answer(folders.answer(entry.key), hashes[entry.key])
        ratio = held_out_ratio(answer, folders.diagnoses / entry.key / "prediction.csv")
        for column in ("held_out_clean_deg", "held_out_read_deg", "files"):
            answer.pop(column, None)
        outcomes.append(make_outcome(answer, read_diagnosis(folders.diagnoses, entry.key), ratio))
    return outcomes


def opponent_replies(folders: Folders) -> dict[str, Any]:
    """Return the opponents' replies, by key of the case."""
    return {
        file.stem: json.loads(file.read_text()) for file in sorted(folders.opponents.glob("*.json"))
    }


def gallery(
    outcomes: list[Outcome],
    folders: Folders,
    options: Options,
    make_again: Callable[[str], None] = lambda _: None,
) -> list[Exhibit]:
    """Predict the recordings of some cases with their repaired models, for the page."""
    program = program_of(options)
    items = []
    for outcome in choose(outcomes):
        make_again(outcome.key)
        folder = folders.diagnoses / outcome.key
        recording = folders.recordings / outcome.key / "recording.csv"
        again = folder / "again.csv"
        if (folder / "model.json").exists() and not again.exists():
            loads = folder / "loads.csv"
            pl.read_csv(recording).drop("angle_deg").write_csv(loads)
            predict(folder / "model.json", loads, again, options.limit_s, program)
        statement = str(read_diagnosis(folders.diagnoses, outcome.key).get("statement", ""))
        items.append(exhibit(outcome, statement, recording, again))
    return items
