"""Make a campaign: step by step, each published before it is diagnosed; resumable."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from cyclosweep_challenge.campaign.item import Item, Part
from cyclosweep_challenge.campaign.making import write_item
from cyclosweep_challenge.campaign.parts import STEPS, parts
from cyclosweep_challenge.campaign.result import Result, make_result
from cyclosweep_challenge.opponents.contest import libraries_apart, meet
from cyclosweep_challenge.record.code import PYTHON, commit, diagnosis_hash, source_hash
from cyclosweep_challenge.record.ledger import Ledger
from cyclosweep_challenge.record.machine import machine
from cyclosweep_challenge.record.run import FLAGS, diagnoses_hash, discard, write_json
from cyclosweep_challenge.runner.diagnosing import (
    DRIVE_FILE,
    diagnose_batch,
    predict_batch,
    read_diagnosis,
)
from cyclosweep_challenge.runner.folders import Folders
from cyclosweep_challenge.runner.work import Options, OutOfTimeError, program_of, work
from cyclosweep_challenge.trial.seal import SealError, reveal_answer, root_hash

SCHEMA = "cyclosweep.campaign/1"
MAKERS = ("cyclosweep_challenge.campaign.making",)
"""Modules that, with what they import of the challenge, make recordings and answers."""
TIMED = 2
"""Recordings of each step of the open part that are diagnosed once more with everything."""
LIMIT_S = 180.0
"""Time allowed for one diagnosis, of loud recordings as well [s]."""
BATCH = 6
"""Most recordings shown to one process, few enough to keep all workers busy to the end."""
REMOVING = ("C5-removed", "deleted")
"""Tiers in which an effect is taken out of the library before the diagnosis."""


@dataclass(frozen=True)
class Slice:
    """Recordings of a part that belong to one step.

    Attributes
    ----------
    part : Part
        The part.
    first, last : int
        First recording, and the first one after it.
    items : tuple of Item
        The recordings.
    folders : Folders
        Folders of the part.
    """

    part: Part
    first: int
    last: int
    items: tuple[Item, ...]
    folders: Folders


class Campaign:
    """Folder of a campaign.

    Parameters
    ----------
    out : pathlib.Path
        Folder.
    seed : int
        A multiple of a hundred; parts use the numbers after it.
    scale : float
        Factor on the number of recordings of every part [-].
    samples : int
        Readings of each recording.
    steps : int
        Steps in which all parts grow together.
    options : Options, optional
        Workers, limits, and which opponents.
    fresh : bool
        Throw away what the folder holds.

    Raises
    ------
    SealError
        If its log was changed.
    ValueError
        If the folder holds a campaign of another seed, size or code.
    """

    def __init__(
        self,
        out: Path,
        seed: int,
        scale: float = 1.0,
        samples: int = 3000,
        steps: int = STEPS,
        options: Options | None = None,
        fresh: bool = False,
    ) -> None:
        if seed % 100:
            raise ValueError(f"seed: found {seed}, expected a multiple of a hundred")
        if fresh:
            discard(out)
        self.out, self.seed, self.steps, self.samples = out, seed, steps, samples
        self.parts = parts(scale)
        self.options = options or Options(diagnose_flags=FLAGS, limit_s=LIMIT_S, batch=BATCH)
        out.mkdir(parents=True, exist_ok=True)
        own: dict[str, Any] = {
            "schema": SCHEMA,
            "seed": seed,
            "samples": samples,
            "steps": steps,
            "parts": {part.name: part.cases for part in self.parts},
            "diagnosis": diagnosis_hash(PYTHON),
            "rig": source_hash(PYTHON, MAKERS),
        }
        file = out / "record.json"
        if not file.exists():
            write_json(file, own | {"scale": scale, "commit": commit(), "machine": machine()})
        self.about: dict[str, Any] = json.loads(file.read_text())
        for key, value in own.items():
            if self.about.get(key) != value:
                raise ValueError(
                    f"{file}: {key}: found {self.about.get(key)}, expected {value}; "
                    "a campaign mixes no versions: start afresh or use another folder"
                )
        self.ledger = Ledger(out / "PUBLISHED.jsonl")

    def folders(self, part: Part) -> Folders:
        """Folders of a part."""
        return Folders(self.out / "parts" / part.name)

    def step(self, number: int) -> list[Slice]:
        """Slices of a step that are not yet diagnosed."""
        found = []
        for part in self.parts:
            first, last = part.slice(number, self.steps)
            if last > first and self.ledger.find("diagnosed", part.name, first) is None:
                plan = part.plan(self.seed, last, self.samples)
                found.append(Slice(part, first, last, tuple(plan[first:]), self.folders(part)))
        return found

    def run_step(self, number: int, screen: Console) -> None:
        """Make, publish, diagnose and show to the opponents what belongs to one step.

        Raises
        ------
        SealError
            If published answers are no longer what they were.
        OutOfTimeError
            If the time is over; what is done is kept.
        """
        slices = self.step(number)
        if not slices:
            return
        self._publish(slices, screen)
        for title, jobs, processes in (
            ("diagnoses", self._diagnoses(slices), False),
            ("predictions", None, False),
            ("opponents", self._meetings(slices), True),
        ):
            # Which predictions are to be made is known only after the diagnoses.
            some = self._predictions(slices) if jobs is None else jobs
            work(
                f"step {number + 1}: {title}",
                self.options.workers,
                list(some),
                screen,
                until=self.options.until,
                processes=processes,
            )
        for one in slices:
            self.ledger.append(
                "diagnosed",
                part=one.part.name,
                first=one.first,
                last=one.last,
                root=diagnoses_hash(one.items, one.folders),
            )
        for one in slices:
            for item in one.items:
                shutil.rmtree(one.folders.recordings / item.key, ignore_errors=True)

    def _publish(self, slices: Sequence[Slice], screen: Console) -> None:
        """Make a step's recordings, and write down the roots of its answers."""
        hashes = {one.part.name: one.folders.hashes() for one in slices}
        jobs = []
        for one in slices:
            for item in one.items:
                if item.key not in hashes[one.part.name]:
                    target = one.folders.answer(item.key)
                    made = (item, one.folders.recordings, target, one.part.predicted)
                    jobs.append((_written, (one.part.name, *made)))

        def keep(done: tuple[str, str, str]) -> None:
            hashes[done[0]][done[1]] = done[2]

        try:
            work("recordings", self.options.workers, jobs, screen, keep, until=self.options.until)
        finally:
            for one in slices:
                one.folders.publish(hashes[one.part.name])
        for one in slices:
            there = hashes[one.part.name]
            root = root_hash((item.key, there[item.key]) for item in one.items)
            published = self.ledger.find("sealed", one.part.name, one.first)
            if published is None:
                place = {"part": one.part.name, "first": one.first, "last": one.last}
                self.ledger.append("sealed", **place, answers=len(one.items), root=root)
            elif published["root"] != root:
                raise SealError(
                    f"{one.part.name} from {one.first}: root is {root}, not what was published"
                )

    def _diagnoses(self, slices: Sequence[Slice]) -> Iterator[Any]:
        """Jobs that diagnose; loud parts first, which take longest."""
        program = program_of(self.options)
        for one in sorted(slices, key=lambda s: "loud" not in s.part.name):
            for (flags, beside), keys in self._alike(one).items():
                for batch in _batches(keys, self.options.batch):
                    some = {key: one.folders.recordings / key for key in batch}
                    drive = some[batch[0]] / beside if beside else None
                    every = (*self.options.diagnose_flags, *flags)
                    limit = self.options.limit_s
                    yield (
                        diagnose_batch,
                        (some, one.folders.diagnoses, every, limit, program, drive),
                    )
            if one.part.name == "open":
                for item in one.items[:TIMED]:
                    if not (self.whole / item.key / "diagnosis.json").exists():
                        some = {item.key: one.folders.recordings / item.key}
                        yield diagnose_batch, (some, self.whole, (), self.options.limit_s, program)

    @property
    def whole(self) -> Path:
        """Folder of the diagnoses made with everything."""
        return self.out / "whole"

    def _alike(self, one: Slice) -> dict[tuple[tuple[str, ...], str], list[str]]:
        """Recordings of a slice without a diagnosis, by flags and by drive file."""
        found: dict[tuple[tuple[str, ...], str], list[str]] = {}
        hashes = one.folders.hashes()
        for item in one.items:
            if (one.folders.diagnoses / item.key / "diagnosis.json").exists():
                continue
            flags: tuple[str, ...] = ()
            if item.kind.tier in REMOVING:
                answer = reveal_answer(one.folders.answer(item.key), hashes[item.key])
                flags = (self.options.removal_flag, str(answer["removed"]))
            own = (one.folders.recordings / item.key / DRIVE_FILE).exists()
            found.setdefault((flags, DRIVE_FILE if own else ""), []).append(item.key)
        return found

    def _predictions(self, slices: Sequence[Slice]) -> Iterator[Any]:
        """Jobs that let repaired models predict programmes they have not seen."""
        for one in slices:
            waiting = []
            for item in one.items if one.part.predicted else ():
                target = one.folders.diagnoses / item.key
                later = one.folders.recordings / item.key / "program.csv"
                done = target / "prediction.csv"
                if (target / "model.json").exists() and later.exists() and not done.exists():
                    waiting.append((target / "model.json", later, done))
            for batch in _batches(waiting, 4 * self.options.batch):
                yield predict_batch, (batch, self.options.limit_s, self.options.program)

    def _meetings(self, slices: Sequence[Slice]) -> Iterator[Any]:
        """Jobs of the opponents."""
        if self.options.opponents == "none":
            return
        names = libraries_apart(self.options.opponents)
        for one in slices:
            for item in one.items:
                if item.number < one.part.opponents:
                    shown = one.folders.recordings / item.key
                    if shown.exists():
                        yield meet, (shown, one.folders.opponents, item.key, names)

    def results(self) -> list[Result]:
        """Open the answers of everything that is diagnosed, and lay the diagnoses beside them.

        Raises
        ------
        SealError
            If an answer or a kept diagnosis was changed.
        """
        found = []
        for part in self.parts:
            folders, plan = self.folders(part), self.done(part)
            hashes = folders.hashes()
            for line in self.ledger.lines:
                if line["event"] == "diagnosed" and line["part"] == part.name:
                    kept = diagnoses_hash(plan[line["first"] : line["last"]], folders)
                    if kept != line["root"]:
                        raise SealError(f"{part.name} from {line['first']}: diagnoses changed")
            for item in plan:
                answer = reveal_answer(folders.answer(item.key), hashes[item.key])
                diagnosis = read_diagnosis(folders.diagnoses, item.key)
                prediction = folders.diagnoses / item.key / "prediction.csv"
                found.append(make_result(part.name, answer, diagnosis, prediction))
        return found

    def done(self, part: Part) -> list[Item]:
        """Recordings of a part that are diagnosed."""
        return part.plan(self.seed, self.ledger.done(part.name), self.samples)

    def replies(self) -> dict[str, dict[str, Any]]:
        """Replies of the opponents to what is diagnosed, by part and key of the recording."""
        found = {}
        for part in self.parts:
            folders = self.folders(part)
            for item in self.done(part):
                file = folders.opponents / f"{item.key}.json"
                if file.exists():
                    found[f"{part.name}/{item.key}"] = json.loads(file.read_text())
        return found


def run_campaign(campaign: Campaign, screen: Console) -> bool:
    """Go on with a campaign to its end or until its time is over; return whether it is complete.

    Parameters
    ----------
    campaign : Campaign
        ``options.until`` says when nothing more is begun.
    screen : rich.console.Console
        Where progress goes.
    """
    try:
        for number in range(campaign.steps):
            campaign.run_step(number, screen)
            screen.print(f"step {number + 1} of {campaign.steps} is done")
    except OutOfTimeError:
        screen.print("the time is over; the same command goes on")
        return False
    return True


def _written(name: str, item: Item, recordings: Path, target: Path, predicted: bool) -> Any:
    """Make one recording; return its part with its key and hash."""
    return name, *write_item(item, recordings, target, predicted)


def _batches(items: Sequence[Any], size: int) -> Iterator[Sequence[Any]]:
    """Share work out in batches of a size."""
    return (items[k : k + size] for k in range(0, len(items), max(1, size)))
