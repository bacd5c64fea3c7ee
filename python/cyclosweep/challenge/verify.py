"""Check a finished challenge from its folder alone: seals, answers and recordings."""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory

from cyclosweep.challenge.plan import make_entry, make_plan
from cyclosweep.challenge.seal import SealError, root_hash, unseal


def verify_run(out: str | Path, every: int = 1) -> list[str]:
    """Check that a challenge is what it says it is.

    The root hash must follow from the published hashes, every answer must open to what was
    published, and recordings and answers must come out the same when made again from the seed.

    Parameters
    ----------
    out : str or pathlib.Path
        Folder of the run, with its ``answers.key``.
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
    passphrase = (folder / "answers.key").read_text().strip()
    complaints = []
    if root_hash(hashes.items()) != published:
        complaints.append("ROOT.txt: not the hash of HASHES.txt")
    for entry in make_plan(len(hashes), about["seed"], about["mix"], about["samples"])[::every]:
        if entry.key not in hashes:
            complaints.append(f"{entry.key}: no hash was published")
            continue
        file = folder / "answers" / f"{entry.key}.sealed"
        try:
            answer = unseal(file, passphrase, hashes[entry.key])
        except (SealError, OSError) as error:
            complaints.append(str(error))
            continue
        case = make_entry(entry)
        made = json.loads(json.dumps(case.truth))
        complaints += [
            f"{entry.key}: the answer's {key!r} is not what the seed gives"
            for key in made
            if answer.get(key) != made[key]
        ]
        with TemporaryDirectory() as scratch:
            case.write(scratch, program=entry.stratum.tier != "C6")
            complaints += [
                f"{entry.key}/{again.name}: not what the seed gives"
                for again in sorted(Path(scratch).iterdir())
                if again.read_bytes()
                != (folder / "recordings" / entry.key / again.name).read_bytes()
            ]
    return complaints
