"""What the library adds and what the search adds: regressions with either library, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cyclosweep_challenge.campaign.result import Result
from cyclosweep_challenge.scoring.intervals import NOTHING, share_of

OURS = "the diagnosis"
"""Its row beside those of the opponents."""
TUNED = 0.05
"""False alarms at which detectors are compared besides their defaults: the few recordings with
nothing missing decide no rarer level [-]."""
GROUPS = (("first", ("null",), ("open",)), ("second", ("foreign-null",), ("foreign",)))
"""Generator, its part with nothing missing, and its part of single effects."""


def rivals(
    results: Sequence[Result], replies: Mapping[str, Mapping[str, Any]]
) -> list[dict[str, Any]]:
    """Rows of a table: detectors on identical files of either generator.

    Parameters
    ----------
    results : sequence of Result
        Everything that is diagnosed.
    replies : mapping
        Replies of the opponents by key of the recording.
    """
    seen = [r for r in results if r.outcome.key in replies]
    names = sorted({name for reply in replies.values() for name in reply})
    rows = []
    for generator, null_parts, single_parts in GROUPS:
        nulls = [r for r in seen if r.part in null_parts]
        single = [r for r in seen if r.part in single_parts]
        if not single:
            continue
        rows.append(_ours(generator, nulls, single))
        for name in names:
            quiet = [replies[r.outcome.key] for r in nulls if name in replies[r.outcome.key]]
            loud = [(r, replies[r.outcome.key]) for r in single if name in replies[r.outcome.key]]
            rows.append(
                _row(generator, name, [q[name] for q in quiet], [(r, w[name]) for r, w in loud])
            )
    return rows


def _ours(generator: str, nulls: Sequence[Result], single: Sequence[Result]) -> dict[str, Any]:
    """Row of the diagnosis, in the form of an opponent's."""
    quiet = [{"score": r.outcome.excess, "flagged": r.outcome.alarm, "named": ()} for r in nulls]
    loud = [
        (r, {"score": r.outcome.excess, "flagged": r.outcome.alarm, "named": r.outcome.named})
        for r in single
    ]
    return _row(generator, OURS, quiet, loud)


def _row(
    generator: str,
    name: str,
    quiet: Sequence[Mapping[str, Any]],
    loud: Sequence[tuple[Result, Mapping[str, Any]]],
) -> dict[str, Any]:
    """Shares of one detector at its defaults, and found at equal false alarms."""
    found_tuned = NOTHING
    if len(quiet) * TUNED >= 1.0:
        scores = np.array([reply["score"] for reply in quiet], dtype=float)
        limit = float(np.quantile(scores, 1.0 - TUNED, method="higher"))
        found_tuned = share_of([reply["score"] > limit for _, reply in loud])
    names_any = any(reply["named"] is not None for _, reply in loud)
    right = [
        bool(reply["flagged"])
        and {cause.name for cause in result.causes} == set(reply["named"] or ())
        for result, reply in loud
    ]
    return {
        "generator": generator,
        "who": name,
        "alarms": vars(share_of([reply["flagged"] for reply in quiet])),
        "found": vars(share_of([reply["flagged"] for _, reply in loud])),
        "found_tuned": vars(found_tuned),
        "named_right": vars(share_of(right)) if names_any else None,
    }
