"""How many opponents are behind the diagnosis: criteria of the contest."""

from __future__ import annotations

from collections.abc import Sequence

from cyclosweep_challenge.scoring.criterion import Criterion, criterion
from cyclosweep_challenge.scoring.curves import DETECTED, Curve, needed_by
from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate, share_of
from cyclosweep_challenge.scoring.opponents import OURS, OpponentCurve, Setting
from cyclosweep_challenge.scoring.power import PROGRAMMES

OPPONENTS = "opponents at 1 %"
"""How criteria begin that count the opponents left behind by the share found."""
AS_IT_IS = "as it is"
AT_EQUAL_ALARMS = "at its own 1 %"
"""How the diagnosis meets its opponents: untouched, or with its evidence tuned as theirs is."""


def contest(curves: Sequence[Curve], opponents: Sequence[OpponentCurve]) -> list[Criterion]:
    """Count the opponents that the diagnosis leaves behind on identical files."""
    criteria = []
    for noise in dict.fromkeys(["white", *(c.noise for c in opponents)]):
        for programme in PROGRAMMES:
            here = [c for c in opponents if (c.programme, c.noise) == (programme, noise)]
            if here or noise == "white":
                settings = [c.own for c in here if c.who != OURS]
                tuned = [c.own.needed for c in here if c.who == OURS]
                criteria += _behind(f"on {noise} noise", programme, settings, 1.0)
                criteria += _slower(
                    f"on {noise} noise",
                    programme,
                    settings,
                    needed_by(curves, DETECTED, programme, noise),
                    tuned[0] if tuned else NOTHING,
                )
    for programme in PROGRAMMES:
        seen = [c for c in opponents if (c.programme, c.noise) == (programme, "white")]
        every = [c.every for c in seen if c.every is not None and c.who != OURS]
        if every:
            criteria += _behind("over all ten families of noise", programme, every, None)
    return criteria


def _behind(
    where: str, programme: str, settings: Sequence[Setting], wanted: float | None
) -> list[Criterion]:
    """Share of opponents that are behind, threshold and recordings drawn again.

    Detection power is compared at one false alarm in a hundred: that comparison is required. As
    it is, the diagnosis stands at half of that or less, and what it finds there is wanted too.
    """
    return [
        share_behind(where, programme, words, behind, wanted)
        for words, behind in (
            (AS_IT_IS, [s.ahead.low > 0.0 for s in settings]),
            (AT_EQUAL_ALARMS, [s.tuned_ahead.low > 0.0 for s in settings]),
        )
    ]


def share_behind(
    where: str, programme: str, words: str, behind: Sequence[bool], wanted: float | None
) -> Criterion:
    """Share of opponents that are behind the diagnosis as it is, or at equal false alarms."""
    return criterion(
        f"{OPPONENTS} {where} behind the diagnosis {words}, {programme}",
        share_of(behind),
        at_least=wanted,
        must=wanted if words == AT_EQUAL_ALARMS else None,
    )


def _slower(
    where: str,
    programme: str,
    settings: Sequence[Setting],
    as_it_is: Estimate,
    equal_alarms: Estimate,
) -> list[Criterion]:
    """Share of opponents that need a larger d for nine detections in ten, by the estimates."""
    return [
        criterion(
            f"by d for 90 % alone, {OPPONENTS} {where} behind the diagnosis {words}, {programme}",
            share_of([s.needed.value > ours.value for s in settings if ours.count]),
        )
        for words, ours in ((AS_IT_IS, as_it_is), (AT_EQUAL_ALARMS, equal_alarms))
    ]
