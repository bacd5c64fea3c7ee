"""Check a record from its folder, or its published log alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from cyclosweep_challenge.record.ledger import Ledger
from cyclosweep_challenge.record.parts import Size
from cyclosweep_challenge.record.run import Keyed, diagnoses_hash
from cyclosweep_challenge.runner.folders import Folders
from cyclosweep_challenge.runner.verify import verify_entry
from cyclosweep_challenge.trial.seal import SealError, root_hash


def verify_log(log: Path, figures: Path | None = None) -> list[str]:
    """Check a published log without the record's folder.

    Its lines must follow from one another, each slice must be committed to before it is diagnosed,
    and the last line's hash must be the one in the figures that were made from it. What answers the
    hashes stand for cannot be checked from the log: that takes the record's folder.

    Parameters
    ----------
    log : pathlib.Path
        ``PUBLISHED.jsonl`` of a record, or a ``*-published.jsonl`` beside a page.
    figures : pathlib.Path, optional
        The page's JSON file.

    Returns
    -------
    list of str
        What does not fit; empty if all does.
    """
    try:
        ledger = Ledger(log, repair=False)
    except SealError as error:
        return [str(error)]
    complaints = _order(ledger.lines)
    if not ledger.lines:
        complaints.append(f"{log.name}: no lines")
    if figures is not None:
        head = json.loads(figures.read_text())["about"]["root"]
        if head != ledger.head:
            complaints.append(f"{figures.name}: head of the log is {head}, found {ledger.head}")
    return complaints


def _order(lines: Sequence[dict[str, Any]]) -> list[str]:
    """Slices of a log that were diagnosed before they were committed to, or times that go back."""
    complaints = []
    committed: dict[tuple[str, int, int], int] = {}
    before = ""
    for line in lines:
        if line["time"] < before:
            complaints.append(f"{line['time']}: earlier than the line before")
        before = line["time"]
        if line["event"] not in {"sealed", "diagnosed"}:
            continue
        place = (line["part"], line["first"], line["last"])
        if line["event"] == "sealed":
            committed[place] = line["answers"]
        elif place not in committed:
            complaints.append(f"{place[0]} from {place[1]}: diagnosed before it was published")
    return complaints


def verify_record(out: str | Path, every: int = 1) -> list[str]:
    """Check that a record is what it says it is.

    The log's lines must follow from one another; the root of every slice must follow from its
    answers' hashes, and stand in the log before the slice's diagnoses; diagnoses must be those
    that were written down; answers must be those that were published, and recordings and answers
    come out the same when made again from the seed.

    Parameters
    ----------
    out : str or pathlib.Path
        Folder of the record.
    every : int
        Make each so many-th case again only; the rest is checked for all.

    Returns
    -------
    list of str
        What does not fit; empty if all does.
    """
    folder = Path(out)
    about = json.loads((folder / "record.json").read_text())
    try:
        ledger = Ledger(folder / "PUBLISHED.jsonl", repair=False)
    except SealError as error:
        return [str(error)]
    complaints = []
    for part in Size(**about["size"]).parts():
        done = ledger.done(part.name)
        folders = Folders(folder / "parts" / part.name)
        plan = part.plan(about["seed"], done, about["size"]["samples"])
        hashes = folders.hashes()
        committed: dict[int, str] = {}
        for line in ledger.lines:
            if line.get("part") != part.name or line["last"] > done:
                continue
            here = plan[line["first"] : line["last"]]
            words = f"{part.name} from {line['first']}"
            if line["event"] == "sealed":
                committed[line["first"]] = line["time"]
                if root_hash((e.key, hashes.get(e.key, "")) for e in here) != line["root"]:
                    complaints.append(f"{words}: answers are not those that were published")
            elif line["event"] == "diagnosed":
                if diagnoses_hash(here, folders) != line["root"]:
                    complaints.append(f"{words}: diagnoses are not those that were kept")
                early = earliest(here, folders)
                if line["first"] not in committed or early < committed[line["first"]]:
                    complaints.append(f"{words}: diagnosed before its answers were published")
        for entry in plan[::every]:
            complaints += [
                f"{part.name}/{words}" for words in verify_entry(entry, folders.out, hashes)
            ]
    return complaints


def earliest(plan: Sequence[Keyed], folders: Folders) -> str:
    """Time of the first diagnosis of a slice, in the log's form."""
    first = min((folders.diagnoses / e.key / "diagnosis.json").stat().st_mtime for e in plan)
    return datetime.fromtimestamp(first, UTC).isoformat(timespec="milliseconds")
