"""`python -m cyclosweep_challenge.record`: make, score, check and print a record."""

from __future__ import annotations

import argparse
import math
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console

from cyclosweep_challenge.measured.run import SIZES_DEG, run_measured
from cyclosweep_challenge.record.compare import compare
from cyclosweep_challenge.record.paper import write_pages, write_paper
from cyclosweep_challenge.record.parts import CONTEST, CONTEST_POOR, COUNTS, FULL, SUBSET
from cyclosweep_challenge.record.run import FLAGS, Record, RecordOptions, run_record
from cyclosweep_challenge.record.verify import verify_log, verify_record
from cyclosweep_challenge.runner.folders import alone
from cyclosweep_challenge.runner.run import RECORD_SEED
from cyclosweep_challenge.runner.work import Options, OutOfTimeError
from cyclosweep_challenge.trial.seal import SealError

MEASURED = "CYCLOSWEEP_MEASURED"
"""Environment variable with the folder of measured ramps."""


def _parser() -> argparse.ArgumentParser:
    """Parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m cyclosweep_challenge.record",
        description="Make the run of record, or go on with it; the same command goes on.",
    )
    add = parser.add_argument
    out = parser.add_mutually_exclusive_group(required=True)
    out.add_argument("--out", type=Path, metavar="DIR", help="folder of the record")
    out.add_argument(
        "--pages", type=Path, metavar="DIR", help="write the pages there again, from their figures"
    )
    out.add_argument(
        "--verify-log",
        type=Path,
        metavar="FILE",
        help="check a published log, and the figures beside it, without the record's folder",
    )
    add("--seed", type=int, default=RECORD_SEED, help="a multiple of ten (default %(default)s)")
    add("--workers", type=int, default=os.cpu_count() or 1, help="processes at a time")
    add("--minutes", type=float, metavar="M", help="begin nothing more after M minutes")
    kind = parser.add_mutually_exclusive_group()
    for name, size, words in (
        ("subset", SUBSET, "a sample of about ten minutes"),
        ("contest", CONTEST, "the contest alone, with more to set thresholds on"),
        ("contest-poor", CONTEST_POOR, "the contest on poor programmes alone"),
    ):
        kind.add_argument(
            f"--{name}", dest="base", action="store_const", const=size, default=FULL, help=words
        )
    for name in COUNTS:
        add(f"--{name.replace('_', '-')}", type=int, metavar="N", help="another size")
    add("--opponents", choices=("all", "cheap", "none"), default="all")
    add("--keep-recordings", action="store_true", help="do not delete what is diagnosed")
    add("--fresh", action="store_true", help="throw away what DIR holds")
    add("--measured", type=Path, metavar="DIR", help=f"measured ramps (default ${MEASURED})")
    add("--drive", type=Path, metavar="FILE", help="drive file of the measured drive")
    add("--docs", type=Path, metavar="DIR", help="write page, figures and pictures there")
    add("--against", type=Path, metavar="FILE", help="compare with a proof.json")
    add("--verify", type=int, metavar="K", help="check everything, make each K-th case again")
    add("--only-verify", action="store_true", help="check and do nothing else")
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; bad input is one line and status 2."""
    given = _parser().parse_args(arguments)
    try:
        sys.exit(_run(given))
    except (SealError, ValueError) as error:
        print(f"record: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print(f"record: interrupted; the same command goes on from {given.out}", file=sys.stderr)
        sys.exit(1)


def _run(given: argparse.Namespace) -> int:
    """Run what the command line asks for; return the exit status."""
    # What is piped or stored is not cut to the 80 columns of no terminal.
    screen = Console(stderr=True, width=None if sys.stderr.isatty() else 150)
    if given.pages is not None:
        for page in write_pages(given.pages):
            screen.print(f"written: {page}")
        return 0
    if given.verify_log is not None:
        return _report(
            _verify_log(given.verify_log), "lines, order and head of the log fit", screen
        )
    if not given.only_verify:
        _make(given, screen)
    if given.verify or given.only_verify:
        complaints = verify_record(given.out, max(1, given.verify or 1))
        return _report(complaints, "hashes, order, answers and recordings fit", screen)
    return 0


def _report(complaints: Sequence[str], good: str, screen: Console) -> int:
    """Print what does not fit, or that all does; return the exit status."""
    screen.print("\n".join(complaints) or f"verified: {good}")
    return 1 if complaints else 0


def _verify_log(log: Path) -> list[str]:
    """Check a log, with the figures of its page where they lie beside it."""
    figures = log.with_name(log.name.replace("-published.jsonl", ".json"))
    return verify_log(log, figures if figures != log and figures.exists() else None)


def _make(given: argparse.Namespace, screen: Console) -> None:
    """Make a record, or go on with it, and write its pages."""
    sizes = {name: getattr(given, name) for name in COUNTS}
    size = replace(
        given.base, **{name: value for name, value in sizes.items() if value is not None}
    )
    until = math.inf if given.minutes is None else time.monotonic() + 60.0 * given.minutes
    options = Options(
        workers=max(1, given.workers),
        diagnose_flags=FLAGS,
        opponents=given.opponents,
        until=until,
    )
    with alone(given.out):
        how = RecordOptions(options, given.keep_recordings)
        record = Record(given.out, given.seed, size, how, given.fresh)
        if not size.is_contest:
            _real_drive(given, options, screen)
        run_record(record, screen)
        if given.docs is not None:
            page = write_paper(given.out, given.docs)
            screen.print(f"written: {page}")
        if given.against is not None:
            compare(given.out, given.against, screen)


def _real_drive(given: argparse.Namespace, options: Options, screen: Console) -> None:
    """Run the measured loops where they are given, or say why not."""
    source = given.measured or (Path(os.environ[MEASURED]) if os.environ.get(MEASURED) else None)
    if source is None or given.drive is None:
        screen.print(
            f"real drive: skipped without --drive and --measured or ${MEASURED}; "
            "examples/measured-13-to-1/README.md says where the data are"
        )
        return
    sizes, files = ((0.1, 0.4), 2) if given.base is SUBSET else (SIZES_DEG, None)
    try:
        rows = run_measured(
            source,
            given.out / "measured",
            given.drive,
            sizes_deg=sizes,
            options=options,
            most_files=files,
            console=screen,
        )
    except OutOfTimeError:
        screen.print("real drive: the time is over; the same command goes on")
        return
    if not rows:
        screen.print(f"real drive: skipped, no torque ramps in {source}")
