"""The figures of a campaign: targets, tables and counts, as plain data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from cyclosweep_challenge.campaign.figures import LOUD_D, faint_figures, new_figures
from cyclosweep_challenge.campaign.real import real_board, real_figures
from cyclosweep_challenge.campaign.result import Result
from cyclosweep_challenge.campaign.rivals import rivals
from cyclosweep_challenge.campaign.run import Campaign
from cyclosweep_challenge.record.compare import pairs
from cyclosweep_challenge.runner.diagnosing import read_diagnosis
from cyclosweep_challenge.scoring.criteria import timing
from cyclosweep_challenge.scoring.criterion import Criterion
from cyclosweep_challenge.scoring.intervals import share_of
from cyclosweep_challenge.scoring.score import as_json

SCHEMA = "cyclosweep.campaign-score/1"


def score_of(campaign: Campaign, board: Path, before: dict[str, Any] | None) -> dict[str, Any]:
    """Score what is finished of a campaign.

    Parameters
    ----------
    campaign : Campaign
        The campaign.
    board : pathlib.Path
        ``scoreboard.json`` of the real recordings; it may be absent.
    before : dict or None
        Figures of the record before, with which those of faint recordings are compared.

    Returns
    -------
    dict
        Plain data that JSON can hold.
    """
    results = campaign.results()
    real = real_board(board)
    new = [*new_figures(results), *real_figures(real)]
    faint = [*faint_figures(results), *_times(campaign, results)]
    content = {
        "schema": SCHEMA,
        "record": campaign.about,
        "head": campaign.ledger.head,
        "done": {part.name: campaign.ledger.done(part.name) for part in campaign.parts},
        "parts": [
            {"name": p.name, "generator": p.generator, "what": p.what, "decides": p.decides}
            for p in campaign.parts
        ],
        "new": [one.as_dict() for one in new],
        "faint": [one.as_dict() for one in faint],
        "before": _compared(faint, before),
        "tables": {
            "verdicts": _verdicts(results),
            "causes": _causes(results),
            "rivals": rivals(results, campaign.replies()),
        },
        "real": real,
    }
    plain: dict[str, Any] = as_json(content)
    return plain


def outcomes_of(campaign: Campaign) -> list[dict[str, Any]]:
    """One row a recording: answer and diagnosis side by side, as plain data."""
    rows: list[dict[str, Any]] = as_json([asdict(result) for result in campaign.results()])
    return rows


def _times(campaign: Campaign, results: Sequence[Result]) -> list[Criterion]:
    """Time of the verdict alone and of the whole report, of faint recordings."""
    quick = {r.outcome.key: r.outcome for r in results if r.part == "open"}
    files = campaign.whole.glob("*/diagnosis.json") if campaign.whole.exists() else ()
    whole = {f"open/{f.parent.name}": read_diagnosis(campaign.whole, f.parent.name) for f in files}
    there = {key: found for key, found in whole.items() if key in quick}
    agree = [
        found.get("verdict") == quick[key].verdict
        and tuple(e["name"] for e in found.get("effects") or []) == quick[key].named
        for key, found in there.items()
    ]
    return timing(
        [r.outcome.elapsed_s for r in results],
        [float(found["challenge_elapsed_s"]) for found in there.values()],
        agree,
    )


def _compared(faint: Sequence[Criterion], before: dict[str, Any] | None) -> list[dict[str, Any]]:
    """Figures of the record before beside those of now, and whether they fit."""
    if before is None:
        return []
    ours = {"figures": [one.as_dict() for one in faint]}
    return [
        {"name": pair.name, "now": pair.ours, "before": pair.record, "fits": pair.fits}
        for pair in pairs(as_json(ours), before)
    ]


def _verdicts(results: Sequence[Result]) -> list[dict[str, Any]]:
    """Verdicts, right names and false names of every part and kind."""
    rows = []
    for part, stratum in dict.fromkeys((r.part, r.outcome.stratum) for r in results):
        there = [r for r in results if (r.part, r.outcome.stratum) == (part, stratum)]
        rows.append(
            {
                "part": part,
                "kind": stratum,
                "cases": len(there),
                "said": dict(Counter(r.outcome.verdict for r in there)),
                "right": vars(share_of([r.right for r in there])),
                "false_name": vars(share_of([r.false_name for r in there])),
            }
        )
    return sorted(rows, key=lambda row: (str(row["part"]), str(row["kind"])))


def _causes(results: Sequence[Result]) -> list[dict[str, Any]]:
    """How each effect fares alone, by generator and visibility, and whose name it is given."""
    kinds = (
        ("first", "d = 6 to 20", "open", 5.5),
        ("first", "loud", "loud-single", LOUD_D),
        ("second", "d = 10 to 60", "foreign", 0.0),
        ("second", "loud", "foreign-loud", LOUD_D),
    )
    rows = []
    for generator, words, part, least in kinds:
        alone = [r for r in results if r.part == part and len(r.causes) == 1]
        there = [r for r in alone if r.causes[0].d > least]
        for cause in sorted({r.causes[0].name for r in there}):
            some = [r for r in there if r.causes[0].name == cause]
            false = Counter(n for r in some for n in r.names if n != cause)
            rows.append(
                {
                    "generator": generator,
                    "visibility": words,
                    "cause": cause,
                    "right": vars(share_of([r.right for r in some])),
                    "false": dict(false.most_common()),
                }
            )
    return rows
