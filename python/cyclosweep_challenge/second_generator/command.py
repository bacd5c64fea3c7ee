"""Command line: a folder of cases and, apart from them, their truth."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import polars as pl

from cyclosweep_challenge.second_generator.case import Case, make_numbered
from cyclosweep_challenge.second_generator.laws.table import law_table, stranger_table
from cyclosweep_challenge.second_generator.recipes import TIERS


def write_set(tier: str, cases: int, seed: int, out: Path, rows: int = 3000) -> None:
    """Write cases to ``out/case-NNN/``, their truth to ``out/truth.json`` and ``out/truth/``.

    Parameters
    ----------
    tier : str
        Tier of the cases.
    cases : int
        Number of cases.
    seed : int
        Seed of the set; a longer set of the same seed begins with the shorter one.
    out : pathlib.Path
        Folder to write to.
    rows : int
        Readings of each recording.
    """
    answers = {}
    (out / "truth").mkdir(parents=True, exist_ok=True)
    for number in range(cases):
        key = f"case-{number:03d}"
        case = make_numbered(tier, number, seed, rows)
        case.write(out / key)
        answers[key] = {"key": key, **case.truth}
        _write_angles(case, out / "truth" / key)
    (out / "truth.json").write_text(json.dumps(answers, indent=1) + "\n")


def _write_angles(case: Case, stem: Path) -> None:
    """Write true angles of the recording and of the unseen programme."""
    recording = pl.DataFrame({"clean_deg": case.clean_deg})
    recording.write_csv(stem.with_name(stem.name + "-recording.csv"))
    program = {"clean_deg": case.held_out_clean_deg, "read_deg": case.held_out_read_deg}
    pl.DataFrame(program).write_csv(stem.with_name(stem.name + "-program.csv"))


def main() -> None:
    """Write a set of cases."""
    parser = argparse.ArgumentParser(
        prog="python -m cyclosweep_challenge.second_generator", description=__doc__
    )
    parser.add_argument("--laws", action="store_true", help="print the table of laws and stop")
    parser.add_argument("--tier", choices=list(TIERS), default="C8")
    parser.add_argument("--cases", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rows", type=int, default=3000)
    parser.add_argument("--out", type=Path, default=Path("second-generator"))
    given = parser.parse_args()
    if given.laws:
        print(law_table(), stranger_table(), sep="\n\n")
        return
    write_set(given.tier, given.cases, given.seed, given.out, given.rows)
