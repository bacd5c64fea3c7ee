"""Check a record from its folder alone: log, seals, answers, recordings, diagnoses."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from pathlib import Path

from cyclosweep_challenge.record.ledger import Ledger
from cyclosweep_challenge.record.parts import Size
from cyclosweep_challenge.record.run import said_hash
from cyclosweep_challenge.runner.folders import Folders
from cyclosweep_challenge.runner.verify import verify_entry
from cyclosweep_challenge.trial.plan import Entry
from cyclosweep_challenge.trial.seal import SealError, root_hash


def verify_record(out: str | Path, every: int = 1) -> list[str]:
    """Check that a record is what it says it is.

    The log's lines must follow from one another; the root of every slice must follow from its
    answers' hashes, and stand in the log before the slice's diagnoses; diagnoses must be those
    that were written down; answers must open to what was published, and recordings and answers
    come out the same when made again from the seed.

    Parameters
    ----------
    out : str or pathlib.Path
        Folder of the record, with the keys of its answers.
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
        ledger = Ledger(folder / "PUBLISHED.jsonl")
    except SealError as error:
        return [str(error)]
    complaints = []
    for part in Size(**about["size"]).parts():
        done = ledger.done(part.name)
        folders = Folders(folder / "parts" / part.name)
        plan = part.plan(about["seed"], done, about["size"]["samples"])
        hashes = folders.hashes()
        passphrase = folders.passphrase("")
        sealed: dict[int, str] = {}
        for line in ledger.lines:
            if line.get("part") != part.name or line["last"] > done:
                continue
            here = plan[line["first"] : line["last"]]
            words = f"{part.name} from {line['first']}"
            if line["event"] == "sealed":
                sealed[line["first"]] = line["time"]
                if root_hash((e.key, hashes.get(e.key, "")) for e in here) != line["root"]:
                    complaints.append(f"{words}: answers are not those that were published")
            elif line["event"] == "diagnosed":
                if said_hash(here, folders) != line["root"]:
                    complaints.append(f"{words}: diagnoses are not those that were kept")
                early = _earliest(here, folders)
                if line["first"] not in sealed or early < sealed[line["first"]]:
                    complaints.append(f"{words}: diagnosed before its answers were published")
        for entry in plan[::every]:
            complaints += [
                f"{part.name}/{words}"
                for words in verify_entry(entry, folders.out, passphrase, hashes)
            ]
    return complaints


def _earliest(plan: list[Entry], folders: Folders) -> str:
    """Time of the first diagnosis of a slice, in the log's form."""
    first = min((folders.diagnoses / e.key / "diagnosis.json").stat().st_mtime for e in plan)
    return datetime.fromtimestamp(first, UTC).isoformat(timespec="milliseconds")
