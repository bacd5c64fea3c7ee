"""Compare the diagnoses of two versions of the code, verdict by verdict and number by number.

    python proof/same_diagnosis.py make FOLDER --cases 300 --seed 424242    make recordings
    python proof/same_diagnosis.py run FOLDER ANSWERS.json                  diagnose them all
    python proof/same_diagnosis.py compare BEFORE.json AFTER.json           print what differs

`run` uses the cyclosweep that the interpreter imports, so the same file compares two checkouts:
run it once with the interpreter of each. `make same-diagnosis OTHER=PATH` does all three.

The drive states its output stiffness outright, so that a correction of the compliance model does
not move the line from which a diagnosis starts.
"""

from __future__ import annotations

import argparse
import json
import math
import multiprocessing
import os
import sys
import time
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

SINGLE_THREADED = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
"""Set to one thread a process unless they are set already: more are many times slower here."""
TOLERANCE = 1e-9
"""Largest difference that counts as the same, relative to the larger number or to one [-]."""
IGNORED = ("provenance",)
"""Keys that name the version of the code."""
STIFFNESS_NM_PER_ARCMIN = 1.0 / (60.0 * 19.8 / 7.2575 / 87**2)
"""Output stiffness of the 87:1 reference drive [N m/arcmin]."""
SHOWN = 5
"""Differences printed of each recording."""


def make(folder: Path, cases: int, seed: int) -> None:
    """Write recordings of the challenge, each in a folder of its own.

    Parameters
    ----------
    folder : pathlib.Path
        Where they go.
    cases : int
        Number of recordings, all kinds of case in balance.
    seed : int
        Seed of the challenge.
    """
    from cyclosweep_challenge.trial.plan import make_entry, make_plan

    for entry in make_plan(cases, seed=seed):
        case = make_entry(entry)
        case.write(folder / entry.key)
        removed = case.truth.get("removed")
        if removed:
            (folder / entry.key / "without.txt").write_text(removed)


def diagnose_one(task: tuple[Path, tuple[str, ...]]) -> tuple[str, dict[str, Any]]:
    """Diagnose one recording in full; return the name of its folder and the whole answer."""
    import cyclosweep as cs

    folder, without = task
    drive = cs.Drive.reference_87().replace(output_stiffness_nm_per_arcmin=STIFFNESS_NM_PER_ARCMIN)
    if (folder / "drive.toml").exists():
        drive = cs.Drive.from_toml(folder / "drive.toml")
    note = folder / "without.txt"
    left_out = {*without, *([note.read_text()] if note.exists() else [])}
    recording = cs.Recording.read(folder / "recording.csv")
    found = cs.diagnose(recording, drive, without=tuple(sorted(left_out)))
    answer: dict[str, Any] = json.loads(found.to_json())
    if found.model is not None:
        answer["model.json"] = json.loads(found.model.to_json())
    return folder.name, answer


def run(folder: Path, target: Path, without: Sequence[str], workers: int, most: int | None) -> None:
    """Diagnose the recordings of a folder and write all answers to one file.

    Parameters
    ----------
    folder : pathlib.Path
        Folder that ``make`` wrote.
    target : pathlib.Path
        JSON file: the answer of each recording by the name of its folder.
    without : sequence of str
        Effects that no diagnosis may use.
    workers : int
        Processes at a time.
    most : int or None
        Diagnose the first so many only.
    """
    tasks = [
        (p, tuple(without)) for p in sorted(folder.iterdir()) if (p / "recording.csv").exists()
    ]
    for name in SINGLE_THREADED:
        os.environ.setdefault(name, "1")
    begun = time.perf_counter()
    spawn = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=spawn) as pool:
        answers = dict(pool.map(diagnose_one, tasks[:most]))
    target.write_text(json.dumps(answers))
    print(f"{len(answers)} recordings in {time.perf_counter() - begun:.0f} s", file=sys.stderr)


def differences(before: Any, after: Any, place: str = "") -> list[str]:
    """List where two answers differ by more than rounding; keys that only ``after`` has may be new.

    Parameters
    ----------
    before, after : object
        Plain data as JSON holds it.
    place : str
        Path to this point, for the messages.
    """
    if isinstance(before, dict) and isinstance(after, dict):
        found = []
        for key in before:
            if key in IGNORED:
                continue
            if key not in after:
                found.append(f"{place}/{key}: gone")
            else:
                found += differences(before[key], after[key], f"{place}/{key}")
        return found
    if isinstance(before, list) and isinstance(after, list):
        if len(before) != len(after):
            return [f"{place}: {len(before)} entries, then {len(after)}"]
        pairs = enumerate(zip(before, after, strict=True))
        return [line for k, (a, b) in pairs for line in differences(a, b, f"{place}[{k}]")]
    if _is_number(before) and _is_number(after):
        room = TOLERANCE * max(abs(before), abs(after), 1.0)
        same = math.isclose(before, after, rel_tol=0.0, abs_tol=room)
    else:
        same = before == after
    return [] if same else [f"{place}: {before!r}, then {after!r}"]


def _is_number(value: Any) -> bool:
    """Whether a value of JSON is a number; true and false are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def compare(before: Path, after: Path) -> int:
    """Print what differs between two files of answers; return 1 where anything does.

    A recording that only one of the two files holds is a difference, too.
    """
    first, second = json.loads(before.read_text()), json.loads(after.read_text())
    both = sorted(set(first) & set(second))
    verdicts, numbers = 0, 0
    for key in both:
        verdicts += first[key]["verdict"] != second[key]["verdict"]
        lines = differences(first[key], second[key])
        numbers += bool(lines)
        for line in lines[:SHOWN]:
            print(f"{key}{line}")
    print(
        f"{len(both)} recordings compared: {len(both) - verdicts} with the same verdict, "
        f"{len(both) - numbers} the same in every word and every number to {TOLERANCE:g}"
    )
    missing = len(set(first) ^ set(second))
    if missing:
        print(f"{missing} recordings are in one file only")
    return int(bool(numbers or missing or not both))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one of the three commands; return the exit status."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    commands = parser.add_subparsers(dest="command", required=True)
    making = commands.add_parser("make", help="make recordings")
    making.add_argument("folder", type=Path)
    making.add_argument("--cases", type=int, default=300)
    making.add_argument("--seed", type=int, default=424242)
    running = commands.add_parser("run", help="diagnose recordings with the code imported here")
    running.add_argument("folder", type=Path)
    running.add_argument("answers", type=Path)
    running.add_argument("--without", action="append", default=[], metavar="EFFECT")
    running.add_argument("--workers", type=int, default=2)
    running.add_argument("--most", type=int, default=None, metavar="N")
    comparing = commands.add_parser("compare", help="print what differs")
    comparing.add_argument("before", type=Path)
    comparing.add_argument("after", type=Path)
    given = parser.parse_args(arguments)
    if given.command == "make":
        make(given.folder, given.cases, given.seed)
    elif given.command == "run":
        run(given.folder, given.answers, given.without, given.workers, given.most)
    else:
        return compare(given.before, given.after)
    return 0


if __name__ == "__main__":
    sys.exit(main())
