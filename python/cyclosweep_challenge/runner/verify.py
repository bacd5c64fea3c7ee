"""Check a finished challenge from its folder alone: hashes, answers and recordings."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory

from cyclosweep_challenge.runner.run import plan_of
from cyclosweep_challenge.trial.plan import Entry, make_entry
from cyclosweep_challenge.trial.seal import SealError, reveal_answer, root_hash


def verify_run(out: str | Path, every: int = 1) -> list[str]:
    """Check that a challenge is what it says it is.

    The root hash must follow from the published hashes, every answer must be the one that was
    published, and recordings and answers must come out the same when made again from the seed.

    Parameters
    ----------
    out : str or pathlib.Path
        Folder of the run.
    every : int
        Check each so many-th case only.

    Returns
    -------
    list of str
        What does not fit; empty if all does.
    """
    folder = Path(out)
    about = json.loads((folder / "challenge.json").read_text())
    lines = (folder / "answers" / "HASHES.txt").read_text().splitlines()
    hashes = dict(line.split(" ", 1) for line in lines)
    published = (folder / "answers" / "ROOT.txt").read_text().split()[0]
    complaints = []
    if root_hash(hashes.items()) != published:
        complaints.append("ROOT.txt: not the hash of HASHES.txt")
    for entry in plan_of(about, len(hashes))[::every]:
        complaints += verify_entry(entry, folder, hashes)
    return complaints


def verify_entry(entry: Entry, folder: Path, hashes: Mapping[str, str]) -> list[str]:
    """Check one case: its hash, and that its answer and recording are what its seed gives.

    Parameters
    ----------
    entry : Entry
        The case.
    folder : pathlib.Path
        Folder of the run. Where recordings were deleted, those made again are compared with
        the hashes in the answer.
    hashes : mapping
        Published hashes by key.
    """
    if entry.key not in hashes:
        return [f"{entry.key}: no hash was published"]
    try:
        answer = reveal_answer(folder / "answers" / f"{entry.key}.json", hashes[entry.key])
    except (SealError, OSError) as error:
        return [str(error)]
    case = make_entry(entry)
    made = json.loads(json.dumps(case.truth))
    complaints = [
        f"{entry.key}: the answer's {key!r} is not what the seed gives"
        for key in made
        if answer.get(key) != made[key]
    ]
    with TemporaryDirectory() as scratch:
        case.write(scratch, program=entry.stratum.tier != "C6")
        for again in sorted(Path(scratch).iterdir()):
            kept = folder / "recordings" / entry.key / again.name
            digest = hashlib.sha256(again.read_bytes()).hexdigest()
            if digest != answer["files"][again.name] or (
                kept.exists() and kept.read_bytes() != again.read_bytes()
            ):
                complaints.append(f"{entry.key}/{again.name}: not what the seed gives")
    return complaints
