"""A whole challenge: recordings, sealed answers, diagnoses, opponents and score; resumable."""

from __future__ import annotations

import hashlib
import json
import math
import multiprocessing
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import polars as pl
from filelock import FileLock, Timeout
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from cyclosweep.challenge.board.gallery import Exhibit, choose, exhibit
from cyclosweep.challenge.board.page import write_page
from cyclosweep.challenge.board.terminal import print_board
from cyclosweep.challenge.diagnosing import (
    command,
    diagnose_batch,
    predict,
    predict_batch,
    read_diagnosis,
)
from cyclosweep.challenge.noise import NOISES
from cyclosweep.challenge.opponents.contest import absent, meet_opponents
from cyclosweep.challenge.plan import Entry, make_entry, make_plan
from cyclosweep.challenge.scoring.outcome import HeldOut, Outcome, make_outcome
from cyclosweep.challenge.scoring.score import Score, make_score
from cyclosweep.challenge.seal import new_passphrase, root_hash, seal, unseal

T = TypeVar("T")

LOCK = ".lock"
"""File by which a process has a run's folder to itself."""
RECORD_SEED = 100_000
"""Records use seeds from here on; development uses seeds below ten thousand."""


@dataclass(frozen=True)
class Options:
    """How a challenge is run, apart from what it is made of.

    Attributes
    ----------
    workers : int
        Processes at a time.
    batch : int
        Most recordings shown to one process of the diagnosis; fewer where that keeps every
        worker busy to the end.
    limit_s : float
        Time allowed for one recording [s].
    diagnose_flags : tuple of str
        Further flags of ``cyclosweep diagnose``.
    removal_flag : str
        Flag that takes an effect out of the library, followed by its name.
    program : tuple of str
        Command that starts ``cyclosweep``; with this interpreter where empty.
    opponents : str
        ``all``, ``cheap`` or ``none``.
    costly_limit : int
        Recordings of each stratum that the costly opponents see.
    passphrase : str
        Key of the answers; drawn at random and kept beside the run where empty.
    until : float
        Clock of ``time.monotonic`` after which no further work is begun [s].
    """

    workers: int = 1
    batch: int = 50
    limit_s: float = 60.0
    diagnose_flags: tuple[str, ...] = ()
    removal_flag: str = "--without"
    program: tuple[str, ...] = ()
    opponents: str = "all"
    costly_limit: int = 300
    passphrase: str = ""
    until: float = math.inf

    def batches(self, items: Sequence[T]) -> Iterator[Sequence[T]]:
        """Share work out in batches, about two for every worker if there are several."""
        even = len(items) if self.workers == 1 else -(-len(items) // (2 * self.workers))
        size = max(1, min(self.batch, even))
        return (items[k : k + size] for k in range(0, len(items), size))


class OutOfTimeError(Exception):
    """The time given is over; what is done is kept."""


@contextmanager
def alone(out: Path) -> Iterator[None]:
    """Have a run's folder to oneself; the lock dies with its process.

    Raises
    ------
    ValueError
        If another process is at work there.
    """
    out.mkdir(parents=True, exist_ok=True)
    try:
        with FileLock(out / LOCK, timeout=0):
            yield
    except Timeout:
        raise ValueError(f"{out}: another process is at work there; let it finish") from None


class Folders:
    """Where a run keeps what: recordings are never in one folder with answers."""

    def __init__(self, out: Path) -> None:
        self.out = out
        self.recordings = out / "recordings"
        self.answers = out / "answers"
        self.diagnoses = out / "diagnoses"
        self.opponents = out / "opponents"
        for folder in (self.recordings, self.answers, self.diagnoses, self.opponents):
            folder.mkdir(parents=True, exist_ok=True)

    def passphrase(self, given: str) -> str:
        """Key of this run's answers."""
        if given:
            return given
        file = self.out / "answers.key"
        if not file.exists():
            file.touch(mode=0o600)
            file.write_text(new_passphrase())
        return file.read_text().strip()

    def hashes(self) -> dict[str, str]:
        """Return the published hash of every sealed answer, by key."""
        file = self.answers / "HASHES.txt"
        lines = file.read_text().splitlines() if file.exists() else []
        return dict(line.split(" ", 1) for line in lines if line)

    def publish(self, hashes: dict[str, str]) -> str:
        """Write all hashes and their root; return the root."""
        text = "".join(f"{key} {hashes[key]}\n" for key in sorted(hashes))
        partial = self.answers / "HASHES.tmp"
        partial.write_text(text)
        partial.replace(self.answers / "HASHES.txt")
        root = root_hash(hashes.items())
        (self.answers / "ROOT.txt").write_text(f"{root} {len(hashes)} answers\n")
        return root


def _prepare(entry: Entry, recordings: Path, answers: Path, passphrase: str) -> tuple[str, str]:
    """Make one case, write its recording, seal its answer; return key and hash."""
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
    return entry.key, seal(answer, answers / f"{entry.key}.sealed", passphrase)


def program_of(options: Options) -> tuple[str, ...]:
    """Command that starts ``cyclosweep``."""
    return options.program or tuple(command())


def _pool(workers: int, processes: bool) -> Executor:
    """Return threads, or processes that do not fork with one linear-algebra thread each."""
    if not processes:
        return ThreadPoolExecutor(workers)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def _results(
    workers: int,
    processes: bool,
    jobs: Sequence[tuple[Callable[..., T], tuple[Any, ...]]],
    until: float,
) -> Iterator[T]:
    """Results of jobs as they come; a single worker is this process itself.

    Raises
    ------
    OutOfTimeError
        If work is left when the time is over; what had begun by then is finished.
    """
    if workers == 1:
        for function, arguments in jobs:
            if time.monotonic() > until:
                raise OutOfTimeError
            yield function(*arguments)
        return
    if not jobs:
        return
    if time.monotonic() > until:
        raise OutOfTimeError
    pool = _pool(workers, processes)
    try:
        futures = [pool.submit(function, *arguments) for function, arguments in jobs]
        late = False
        for future in as_completed(futures):
            if not late and time.monotonic() > until:
                late = sum(other.cancel() for other in futures) > 0
            if not future.cancelled():
                yield future.result()
        if late:
            raise OutOfTimeError
    finally:
        pool.shutdown(cancel_futures=True)


def work(
    title: str,
    workers: int,
    jobs: Sequence[tuple[Callable[..., T], tuple[Any, ...]]],
    console: Console,
    done: Callable[[T], None] = lambda _: None,
    *,
    until: float = math.inf,
    processes: bool = True,
) -> None:
    """Run jobs, showing progress; ``done`` takes each result as it comes."""
    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task(title, total=len(jobs))
        for result in _results(workers, processes, jobs, until):
            done(result)
            progress.advance(task)


def prepare(plan: Sequence[Entry], folders: Folders, options: Options, console: Console) -> str:
    """Write every recording and seal every answer; return the root hash."""
    passphrase = folders.passphrase(options.passphrase)
    hashes = folders.hashes()
    missing = [entry for entry in plan if entry.key not in hashes]
    made = 0

    def keep(result: tuple[str, str]) -> None:
        nonlocal made
        hashes[result[0]] = result[1]
        made += 1
        if made % 200 == 0:
            folders.publish(hashes)

    jobs = [
        (_prepare, (entry, folders.recordings, folders.answers, passphrase)) for entry in missing
    ]
    try:
        work("recordings", options.workers, jobs, console, keep, until=options.until)
    finally:
        root = folders.publish(hashes)
    return root


def _removed(entry: Entry, folders: Folders, options: Options) -> str:
    """Effect that a case's diagnosis has to do without; empty for none."""
    if entry.stratum.tier != "C5-removed":
        return ""
    answer = unseal(
        folders.answers / f"{entry.key}.sealed",
        folders.passphrase(options.passphrase),
        folders.hashes()[entry.key],
    )
    return str(answer["removed"])


def diagnose(plan: Sequence[Entry], folders: Folders, options: Options, console: Console) -> None:
    """Let the diagnosis see every recording, in processes of its own."""
    waiting: dict[tuple[str, ...], list[str]] = {}
    for entry in plan:
        if not (folders.diagnoses / entry.key / "diagnosis.json").exists():
            removed = _removed(entry, folders, options)
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
            said = read_diagnosis(folders.diagnoses, entry.key)
            if said.get("verdict") == "IDENTIFIED":
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


def open_answers(plan: Sequence[Entry], folders: Folders, options: Options) -> list[Outcome]:
    """Open the answers, check their hashes and lay them beside the diagnoses."""
    passphrase = folders.passphrase(options.passphrase)
    hashes = folders.hashes()
    outcomes = []
    for entry in plan:
        answer = unseal(folders.answers / f"{entry.key}.sealed", passphrase, hashes[entry.key])
        ratio = held_out_ratio(answer, folders.diagnoses / entry.key / "prediction.csv")
        for column in ("held_out_clean_deg", "held_out_read_deg", "files"):
            answer.pop(column, None)
        outcomes.append(make_outcome(answer, read_diagnosis(folders.diagnoses, entry.key), ratio))
    return outcomes


def opponents_said(folders: Folders) -> dict[str, Any]:
    """Return what the opponents said, by key of the case."""
    return {
        file.stem: json.loads(file.read_text()) for file in sorted(folders.opponents.glob("*.json"))
    }


def gallery(
    outcomes: list[Outcome],
    folders: Folders,
    options: Options,
    make_again: Callable[[str], None] = lambda _: None,
) -> list[Exhibit]:
    """Let the repaired models of some cases predict their own recordings, and lay them out."""
    program = program_of(options)
    items = []
    for outcome in choose(outcomes):
        make_again(outcome.key)
        kept = folders.diagnoses / outcome.key
        recording = folders.recordings / outcome.key / "recording.csv"
        again = kept / "again.csv"
        if (kept / "model.json").exists() and not again.exists():
            loads = kept / "loads.csv"
            pl.read_csv(recording).drop("angle_deg").write_csv(loads)
            predict(kept / "model.json", loads, again, options.limit_s, program)
        statement = str(read_diagnosis(folders.diagnoses, outcome.key).get("statement", ""))
        items.append(exhibit(outcome, statement, recording, again))
    return items


def plan_of(about: Mapping[str, Any], cases: int) -> list[Entry]:
    """Lay out the first cases of a challenge as its folder describes it.

    Parameters
    ----------
    about : mapping
        Seed, mix and samples, as ``plan.make_plan`` takes them; with ``noise``, a family of
        noise that takes the place of white noise.
    cases : int
        Number of cases.
    """
    plan = make_plan(cases, about["seed"], about["mix"], about["samples"])
    noise = about.get("noise", "white")
    return [
        replace(entry, stratum=replace(entry.stratum, noise=noise))
        if entry.stratum.noise == "white"
        else entry
        for entry in plan
    ]


def run_challenge(
    cases: int,
    seed: int,
    out: str | Path,
    workers: int = 1,
    *,
    mix: str = "all",
    noise: str = "white",
    samples: int = 3000,
    options: Options | None = None,
    console: Console | None = None,
) -> Score:
    """Run a challenge, or go on with one that was interrupted.

    Parameters
    ----------
    cases : int
        Number of cases; a larger number on the same folder adds to it.
    seed : int
        Seed of the challenge.
    out : str or pathlib.Path
        Folder of the run.
    workers : int
        Processes at a time.
    mix : {"all", "null", "open", "concealed", "contest", "tuning"}
        Which strata take part.
    noise : str
        Family of noise that takes the place of white noise, of ``noise.NOISES``.
    samples : int
        Readings of each recording.
    options : Options, optional
        Everything else; ``workers`` above wins.
    console : rich.console.Console, optional
        Where progress, root hash and table go; standard error if absent.

    Returns
    -------
    Score
        Figures, curves and tables; also in ``score.json`` and ``score.html`` of the folder.

    Raises
    ------
    SealError
        If an answer was changed after it was sealed.
    OutOfTimeError
        If ``options.until`` is over before the last case; what is done is kept.
    ValueError
        If the folder holds a challenge of another seed, mix, noise or size, or another process
        is at work there.
    """
    if noise not in NOISES:
        raise ValueError(f"noise: found {noise!r}, expected one of {', '.join(NOISES)}")
    chosen = Options(**(vars(options or Options()) | {"workers": max(1, workers)}))
    about = {"seed": seed, "mix": mix, "samples": samples}
    if noise != "white":
        about["noise"] = noise
    plan = plan_of(about, cases)
    with alone(Path(out)):
        return _run(plan, about, Folders(Path(out)), chosen, console or Console(stderr=True))


def _run(
    plan: Sequence[Entry],
    about: dict[str, Any],
    folders: Folders,
    options: Options,
    screen: Console,
) -> Score:
    """Run a challenge whose folder nobody else uses."""
    _claim(folders.out, about)
    root = prepare(plan, folders, options, screen)
    screen.print(f"answers sealed: SHA-256 {root} over {len(folders.hashes())} answers")
    diagnose(plan, folders, options, screen)
    predict_all(plan, folders, options, screen)
    if options.opponents != "none" and absent():
        screen.print(f"without their libraries (extra: challenge): {', '.join(absent())}")
    meetings = meet_opponents(
        plan,
        folders.recordings,
        folders.opponents,
        options.opponents,
        options.costly_limit,
        home=about.get("noise", "white"),
    )
    work("opponents", options.workers, meetings, screen, until=options.until)
    outcomes = open_answers(plan, folders, options)
    score = make_score(outcomes, opponents_said(folders), about | {"root": root})
    (folders.out / "outcomes.json").write_text(json.dumps([asdict(o) for o in outcomes]))
    (folders.out / "score.json").write_text(json.dumps(score.as_dict(), indent=1))
    exhibits = gallery(outcomes, folders, options)
    write_page(score, exhibits, folders.out / "score.html")
    print_board(score, screen)
    return score


def _claim(out: Path, own: dict[str, Any]) -> None:
    """Make sure that a folder holds one challenge only."""
    file = out / "challenge.json"
    if file.exists():
        found = json.loads(file.read_text())
        if found != own:
            raise ValueError(f"{file}: found {found}, expected {own}; use another folder")
    else:
        file.write_text(json.dumps(own))
