"""`python -m cyclosweep_challenge.campaign`: make, score, check and print a campaign."""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from cyclosweep_challenge.campaign.page import NAME, write_campaign_page
from cyclosweep_challenge.campaign.parts import STEPS, TINY
from cyclosweep_challenge.campaign.run import BATCH, LIMIT_S, Campaign, run_campaign
from cyclosweep_challenge.campaign.score import outcomes_of, score_of
from cyclosweep_challenge.campaign.verify import verify_campaign
from cyclosweep_challenge.record.run import FLAGS, write_json
from cyclosweep_challenge.runner.folders import alone
from cyclosweep_challenge.runner.work import Options
from cyclosweep_challenge.trial.seal import SealError

SEED = 1_100_000
"""Seed of the campaign of record; no other run uses it or the hundred numbers after it."""
TINY_STEPS = 1


def _scale(word: str) -> float:
    """Factor on the number of recordings, or ``tiny``."""
    if word == "tiny":
        return TINY
    value = float(word)
    if not 0.0 < value < math.inf:
        raise argparse.ArgumentTypeError(f"found {word}, expected tiny or a positive number")
    return value


def _parser() -> argparse.ArgumentParser:
    """Parser of the command line."""
    parser = argparse.ArgumentParser(
        prog="python -m cyclosweep_challenge.campaign",
        description="Make the record across both generators; the same command goes on.",
    )
    add = parser.add_argument
    out = parser.add_mutually_exclusive_group(required=True)
    out.add_argument("--out", type=Path, metavar="DIR", help="folder of the campaign")
    out.add_argument("--page", type=Path, metavar="DIR", help="write the page there again")
    add("--seed", type=int, default=SEED, help="a multiple of a hundred (default %(default)s)")
    add("--scale", type=_scale, default=1.0, metavar="F", help="factor on all sizes, or tiny")
    add("--samples", type=int, default=3000, metavar="N", help="readings of a recording")
    add("--workers", type=int, default=os.cpu_count() or 1, help="processes at a time")
    add("--minutes", type=float, metavar="M", help="begin nothing more after M minutes")
    add("--opponents", choices=("all", "none"), default="all")
    add("--fresh", action="store_true", help="throw away what DIR holds")
    add("--scoreboard", type=Path, metavar="FILE", help="scoreboard.json of the real recordings")
    add("--before", type=Path, metavar="FILE", help="figures of the record before (proof.json)")
    add("--docs", type=Path, metavar="DIR", help="write figures, log and page there")
    add("--verify", type=int, metavar="K", help="check everything, make each K-th case again")
    add("--only-verify", action="store_true", help="check and do nothing else")
    return parser


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command; bad input is one line and status 2."""
    given = _parser().parse_args(arguments)
    try:
        sys.exit(_run(given))
    except (SealError, ValueError) as error:
        print(f"campaign: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("campaign: interrupted; the same command goes on", file=sys.stderr)
        sys.exit(1)


def _run(given: argparse.Namespace) -> int:
    """Run what the command line asks for; return the exit status."""
    screen = Console(stderr=True, width=None if sys.stderr.isatty() else 150)
    if given.page is not None:
        screen.print(f"written: {write_campaign_page(given.page)}")
        return 0
    options = Options(
        workers=max(1, given.workers),
        batch=BATCH,
        limit_s=LIMIT_S,
        diagnose_flags=FLAGS,
        opponents=given.opponents,
        until=math.inf if given.minutes is None else time.monotonic() + 60.0 * given.minutes,
    )
    with alone(given.out):
        campaign = Campaign(
            given.out,
            given.seed,
            given.scale,
            given.samples,
            TINY_STEPS if given.scale <= TINY else STEPS,
            options,
            given.fresh,
        )
        if not given.only_verify:
            _make(campaign, given, screen)
        if given.verify or given.only_verify:
            complaints = verify_campaign(campaign, max(1, given.verify or 1))
            screen.print("\n".join(complaints) or "verified: log, answers and recordings fit")
            return 1 if complaints else 0
    return 0


def _make(campaign: Campaign, given: argparse.Namespace, screen: Console) -> None:
    """Make a campaign, or go on with it, and write what it says."""
    run_campaign(campaign, screen)
    board = given.scoreboard or campaign.out / "scoreboard" / "scoreboard.json"
    before = json.loads(given.before.read_text()) if given.before else None
    score = score_of(campaign, board, before)
    write_json(campaign.out / "score.json", score)
    write_json(campaign.out / "outcomes.json", outcomes_of(campaign))
    shutil.copy(campaign.ledger.file, campaign.out / f"{NAME}-published.jsonl")
    shutil.copy(campaign.out / "score.json", campaign.out / f"{NAME}.json")
    screen.print(f"written: {write_campaign_page(campaign.out)}")
    if given.docs is not None:
        given.docs.mkdir(parents=True, exist_ok=True)
        for name in (f"{NAME}.json", f"{NAME}-published.jsonl"):
            shutil.copy(campaign.out / name, given.docs / name)
        screen.print(f"written: {write_campaign_page(given.docs)}")
