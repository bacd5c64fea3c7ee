"""Make a record: slice by slice, each published before it is diagnosed; resumable."""

from __future__ import annotations

import hashlib
import json
import shutil
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

from rich.console import Console

from cyclosweep_challenge.board.page import write_page
from cyclosweep_challenge.board.terminal import print_board
from cyclosweep_challenge.opponents.contest import absent, meet_opponents
from cyclosweep_challenge.record.code import code, commit
from cyclosweep_challenge.record.ledger import Ledger
from cyclosweep_challenge.record.machine import machine
from cyclosweep_challenge.record.parts import COLOURED, COUNTS, FULL, Part, Size
from cyclosweep_challenge.runner.diagnosing import diagnose_batch, read_diagnosis
from cyclosweep_challenge.runner.folders import LOCK, Folders
from cyclosweep_challenge.runner.stages import (
    diagnose,
    gallery,
    opponent_replies,
    predict_all,
    prepare,
    reveal_answers,
)
from cyclosweep_challenge.runner.work import Options, OutOfTimeError, program_of, work
from cyclosweep_challenge.scoring.criteria import timing
from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.scoring.score import Score, make_score
from cyclosweep_challenge.trial.plan import Entry, make_entry
from cyclosweep_challenge.trial.seal import SealError, root_hash

TIMED = 2
"""Recordings of each slice of the open part that are diagnosed once more with everything."""
FLAGS = ("--quick",)
"""The verdict needs no report, self-check or held-out proof; those are timed apart."""


class Keyed(Protocol):
    """A case of any plan."""

    @property
    def key(self) -> str:
        """Name of the case's folder."""
        ...


@dataclass(frozen=True)
class RecordOptions:
    """How a record is made, apart from what it is made of.

    Attributes
    ----------
    run : Options
        Workers, batches, limits and who diagnoses.
    keep_recordings : bool
        Whether recordings stay on disk once their slice is done; they follow from the seed.
    """

    run: Options = field(default_factory=lambda: Options(diagnose_flags=FLAGS))
    keep_recordings: bool = False


class Record:
    """A record's folder.

    Parameters
    ----------
    out : pathlib.Path
        Folder.
    seed : int
        Seed; its parts use the numbers after it too.
    size : Size
        What it is made of.
    options : RecordOptions, optional
        How it is made.
    fresh : bool
        Throw away what the folder holds.

    Raises
    ------
    SealError
        If its log was changed.
    ValueError
        If the folder holds a record of another seed, size or code.
    """

    def __init__(
        self,
        out: Path,
        seed: int,
        size: Size = FULL,
        options: RecordOptions | None = None,
        fresh: bool = False,
    ) -> None:
        if seed % 10:
            raise ValueError(f"seed: found {seed}, expected a multiple of ten: parts use seed + k")
        if fresh:
            discard(out)
        self.out, self.seed, self.size = out, seed, size
        self.options = options or RecordOptions()
        out.mkdir(parents=True, exist_ok=True)
        own = {"schema": "cyclosweep.record/1", "seed": seed, "size": asdict(size)} | dict(code())
        file = out / "record.json"
        if not file.exists():
            write_json(file, own | {"commit": commit(), "machine": machine()})
        self.about: dict[str, Any] = json.loads(file.read_text())
        self.ledger = Ledger(out / "PUBLISHED.jsonl")
        # A part that this record was begun without is one without a case, until it is added;
        # what else it was begun without cannot be added.
        begun = {name: type(given)() for name, given in asdict(size).items()} | self.about["size"]
        added = {
            name: cases
            for name in COUNTS
            if name not in self.about["size"] and (cases := getattr(size, name))
        }
        there = self.about | {"size": begun | added}
        for key, value in own.items():
            if there[key] != value:
                raise ValueError(
                    f"{file}: {key}: found {self.about[key]}, expected {value}; "
                    "a record mixes no versions: start afresh or use another folder"
                )
        if added:
            self.ledger.append("part added", **added)
            self.about["size"] = asdict(size)
            write_json(file, self.about)

    def folders(self, part: Part) -> Folders:
        """Folders of a part."""
        return Folders(self.out / "parts" / part.name)

    def plan(self, part: Part, last: int) -> list[Entry]:
        """Cases of a part up to one."""
        return part.plan(self.seed, last, self.size.samples)

    def run_slice(self, part: Part, first: int, last: int, screen: Console) -> None:
        """Make, publish, diagnose and show to the opponents one slice.

        Raises
        ------
        SealError
            If published answers are no longer what they were.
        OutOfTimeError
            If the time is over; what is done is kept.
        """
        folders, options = self.folders(part), self.options.run
        plan = self.plan(part, last)
        new = plan[first:last]
        self._publish(part, first, last, new, screen)
        diagnose(new, folders, options, screen)
        predict_all(new, folders, options, screen)
        if part.name != "concealed":
            meetings = meet_opponents(
                plan, folders.recordings, folders.opponents, options.opponents, part.costly, first
            )
            work("opponents", options.workers, meetings, screen, until=options.until)
        if part.name == "open":
            self._time(new[:TIMED], folders, screen)
        self.ledger.append(
            "diagnosed",
            part=part.name,
            first=first,
            last=last,
            root=diagnoses_hash(new, folders),
        )
        if not self.options.keep_recordings:
            for entry in new:
                shutil.rmtree(folders.recordings / entry.key, ignore_errors=True)

    def _publish(
        self, part: Part, first: int, last: int, new: Sequence[Entry], screen: Console
    ) -> None:
        """Make a slice and write down the root of its answers before anybody diagnoses it."""
        folders = self.folders(part)
        published = self.ledger.find("sealed", part.name, first)
        if published is None:
            prepare(new, folders, self.options.run, screen)
        hashes = folders.hashes()
        root = root_hash((entry.key, hashes[entry.key]) for entry in new)
        if published is None:
            self.ledger.append(
                "sealed", part=part.name, first=first, last=last, answers=len(new), root=root
            )
            screen.print(f"{part.name} {first} to {last - 1} committed: SHA-256 {root}")
        elif published["root"] != root:
            raise SealError(f"{part.name} from {first}: root is {root}, not what was published")

    def _time(self, some: Sequence[Entry], folders: Folders, screen: Console) -> None:
        """Diagnose some recordings once more with everything, each in a process of its own."""
        options = self.options.run
        program, target = program_of(options), self.out / "whole"
        jobs = [
            (
                diagnose_batch,
                ({e.key: folders.recordings / e.key}, target, (), options.limit_s, program),
            )
            for e in some
            if not (target / e.key / "diagnosis.json").exists()
        ]
        work("whole reports", options.workers, jobs, screen, until=options.until, processes=False)

    def outcomes(self) -> tuple[list[Outcome], dict[str, Any]]:
        """Open the answers of all finished slices; return outcomes and the opponents' replies."""
        outcomes: list[Outcome] = []
        replies: dict[str, Any] = {}
        for part in self.size.parts():
            folders, done = self.folders(part), self.ledger.done(part.name)
            plan = self.plan(part, done)
            self._check_diagnoses(part, plan, folders)
            for outcome in reveal_answers(plan, folders):
                outcomes.append(replace(outcome, key=f"{part.name}/{outcome.key}"))
            known = {entry.key for entry in plan}
            for key, reply in opponent_replies(folders).items():
                if key in known:
                    replies[f"{part.name}/{key}"] = reply
        return outcomes, replies

    def _check_diagnoses(self, part: Part, plan: Sequence[Entry], folders: Folders) -> None:
        """Make sure that the kept diagnoses are those that were written down."""
        for line in self.ledger.lines:
            if line["event"] == "diagnosed" and line["part"] == part.name:
                found = diagnoses_hash(plan[line["first"] : line["last"]], folders)
                if found != line["root"]:
                    raise SealError(
                        f"{part.name} from {line['first']}: diagnoses changed after they were kept"
                    )

    def exhibits(self, outcomes: list[Outcome]) -> list[Any]:
        """Gallery of the concealed part, its recordings made again where they are gone."""
        part = next(p for p in self.size.parts() if p.name == "concealed")
        folders = self.folders(part)
        plan = {entry.key: entry for entry in self.plan(part, self.ledger.done(part.name))}
        there = [
            replace(o, key=o.key.removeprefix("concealed/"))
            for o in outcomes
            if o.key.startswith("concealed/")
        ]

        def again(key: str) -> None:
            if not (folders.recordings / key / "recording.csv").exists():
                make_entry(plan[key]).write(folders.recordings / key)

        return gallery(there, folders, self.options.run, again)

    def score(self, outcomes: list[Outcome], replies: dict[str, Any]) -> Score:
        """Score what is finished."""
        counts = {part.name: self.ledger.done(part.name) for part in self.size.parts()}
        contest_only = [o for o in outcomes if o.key.startswith(f"{COLOURED}/")]
        main = [o for o in outcomes if not o.key.startswith(f"{COLOURED}/")]
        about = {
            "seed": self.seed,
            "mix": ", ".join(f"{name} {count}" for name, count in counts.items()),
            "root": self.ledger.head,
            "parts": counts,
        }
        return make_score(main, replies, about, self.timings(main), contest_only)

    def timings(self, outcomes: Sequence[Outcome]) -> list[Criterion]:
        """Time of the verdict alone and of everything, and whether both say the same."""
        quick = {o.key.removeprefix("open/"): o for o in outcomes if o.key.startswith("open/")}
        whole = self.out / "whole"
        files = sorted(whole.glob("*/diagnosis.json")) if whole.exists() else []
        whole_reports = {
            file.parent.name: read_diagnosis(whole, file.parent.name)
            for file in files
            if file.parent.name in quick
        }
        agree = [
            s.get("verdict") == quick[key].verdict
            and tuple(e["name"] for e in s.get("effects") or []) == quick[key].named
            for key, s in whole_reports.items()
        ]
        elapsed = [float(s["challenge_elapsed_s"]) for s in whole_reports.values()]
        return timing([o.elapsed_s for o in outcomes], elapsed, agree)


def diagnoses_hash(plan: Sequence[Keyed], folders: Folders) -> str:
    """One hash over the kept diagnoses of some cases."""
    return root_hash(
        (
            entry.key,
            hashlib.sha256(
                (folders.diagnoses / entry.key / "diagnosis.json").read_bytes()
            ).hexdigest(),
        )
        for entry in plan
    )


def write_json(file: Path, content: Any) -> None:
    """Write JSON whole or not at all."""
    partial = file.with_suffix(".tmp")
    partial.write_text(json.dumps(content, indent=1))
    partial.replace(file)


def run_record(record: Record, console: Console | None = None) -> Score:
    """Go on with a record until it is complete or its time is over, and score what is finished.

    Parameters
    ----------
    record : Record
        The record; ``options.until`` says when nothing more is begun.
    console : rich.console.Console, optional
        Where progress and table go; standard error if absent.

    Raises
    ------
    SealError
        If answers, published roots or kept diagnoses were changed.
    """
    screen = console or Console(stderr=True)
    until = record.options.run.until
    if absent():
        screen.print(f"without their libraries (extra: challenge): {', '.join(absent())}")
    try:
        for part, first, last in record.size.slices():
            if record.ledger.find("diagnosed", part.name, first) is None:
                if time.monotonic() > until:
                    raise OutOfTimeError
                record.run_slice(part, first, last, screen)
    except OutOfTimeError:
        screen.print("the time is over; the same command goes on")
    outcomes, replies = record.outcomes()
    score = record.score(outcomes, replies)
    write_json(
        record.out / "outcomes.json", [asdict(o) | {"recognised": o.recognised} for o in outcomes]
    )
    write_json(record.out / "score.json", score.as_dict())
    write_page(score, record.exhibits(outcomes), record.out / "score.html")
    print_board(score, screen)
    return score


def discard(folder: Path) -> None:
    """Delete the contents of a folder that holds a record; refuse any other folder."""
    held = [path for path in folder.glob("*") if path.name != LOCK]
    if held and not (folder / "record.json").exists():
        raise ValueError(f"{folder}: found something that is no record, not deleted")
    # The record's own file goes last: what a kill leaves is still known as a record.
    for path in sorted(held, key=lambda path: path.name == "record.json"):
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        else:
            path.unlink()
