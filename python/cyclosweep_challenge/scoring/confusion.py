"""Confusion matrix of single effects."""

from __future__ import annotations

from collections.abc import Sequence

import polars as pl

from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.scoring.outcome import Outcome

OTHER = ("several", "ambiguous", "unknown", "nothing", "failure")


def said_of(outcome: Outcome) -> str:
    """Column of the matrix for one diagnosis: a name, or why there is none."""
    if outcome.verdict == "IDENTIFIED":
        if len(outcome.named) == 1:
            return outcome.named[0] if outcome.named[0] in VOCABULARY else "ambiguous"
        return "several"
    return {
        "AMBIGUOUS": "ambiguous",
        "MOSTLY_EXPLAINED": "unknown",
        "UNKNOWN_PHYSICS": "unknown",
        "NOTHING_MISSING": "nothing",
        "INSUFFICIENT_DATA": "nothing",
    }.get(outcome.verdict, "failure")


def confusion(outcomes: Sequence[Outcome]) -> pl.DataFrame:
    """Count, for each single cause at work, what the diagnosis answered.

    Returns
    -------
    polars.DataFrame
        A row a cause (``cause``), a column for each name of the vocabulary and each of
        ``OTHER``, counts as values; rows without cases left out.
    """
    rows: dict[str, dict[str, int]] = {}
    for outcome in outcomes:
        if len(outcome.causes) == 1:
            row = rows.setdefault(outcome.causes[0], dict.fromkeys((*VOCABULARY, *OTHER), 0))
            row[said_of(outcome)] += 1
    order = [n for n in VOCABULARY if n in rows] + sorted(n for n in rows if n not in VOCABULARY)
    return pl.DataFrame(
        [{"cause": name, **rows[name]} for name in order],
        schema={"cause": pl.String} | dict.fromkeys((*VOCABULARY, *OTHER), pl.Int64),
    )
