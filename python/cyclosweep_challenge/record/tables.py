"""Tables of a record's outcomes, as plain data."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Any

from cyclosweep_challenge.record.markdown import Plain
from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.scoring.intervals import share
from cyclosweep_challenge.scoring.outcome import ALARMS
from cyclosweep_challenge.scoring.power import PROGRAMMES


def tables_of(outcomes: Sequence[Plain]) -> dict[str, list[dict[str, Any]]]:
    """Every table of a record's page that follows from its outcomes one by one."""
    return {
        "false_alarms": _alarm_rows(outcomes),
        "tiers": _tier_rows(outcomes),
        "single_effects": _effect_rows(outcomes),
        "aliens": _unknown_rows(outcomes, "C5-alien"),
        "removed": _unknown_rows(outcomes, "C5-removed"),
    }


def _share(hits: int, count: int) -> dict[str, Any]:
    """Share with its exact interval as plain data."""
    return dict(vars(share(hits, count))) if count else {"value": None, "count": 0}


def _alarm_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
    """False alarms by family of noise and programme."""
    rows = []
    for family in NOISES:
        there = [o for o in outcomes if o["tier"] == "C6" and o["noise"] == family]
        row: dict[str, Any] = {"family": family, "all": _alarmed(there)}
        for programme in ("rich", "middle", "poor", "oneway"):
            row[programme] = _alarmed([o for o in there if o["programme"] == programme])
        row["said"] = dict(Counter(o["verdict"] for o in there))
        rows.append(row)
    return rows


def _alarmed(there: Sequence[Plain]) -> dict[str, Any]:
    """Share of cases with an alarm."""
    return _share(sum(o["verdict"] in ALARMS for o in there), len(there))


def _right(o: Plain) -> bool:
    """Whether exactly the true set was identified."""
    return o["verdict"] == "IDENTIFIED" and set(o["named"]) == set(o["causes"])


def _tier_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
    """What was found and named, by stratum."""
    rows = []
    concealed = {"C0", "C1", "C2", "C3", "C4", "C5-alien", "C5-removed", "C7"}
    for stratum in sorted({o["stratum"] for o in outcomes if o["tier"] in concealed}, key=_by_d):
        there = [o for o in outcomes if o["stratum"] == stratum]
        rows.append(
            {
                "stratum": stratum,
                "found": _alarmed(there),
                "named_right": _share(sum(map(_right, there)), len(there)),
                "said": dict(Counter(o["verdict"] for o in there)),
            }
        )
    return rows


def _by_d(stratum: str) -> tuple[str, float]:
    """Order of strata: by kind, then by d."""
    kind, _, d = stratum.partition("/d=")
    return kind, float(d.split("+")[-1]) if d else 0.0


def _effect_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
    """Share named right, by effect, programme and d."""
    rows = []
    for programme in PROGRAMMES:
        for cause in VOCABULARY:
            row: dict[str, Any] = {"programme": programme, "cause": cause}
            for d in (6, 10, 20):
                there = [
                    o
                    for o in outcomes
                    if o["tier"] == "C0"
                    and o["noise"] == "white"
                    and o["programme"] == programme
                    and o["causes"] == [cause]
                    and round(o["d"]) == d
                ]
                row[f"d{d}"] = _share(sum(map(_right, there)), len(there))
            rows.append(row)
    return rows


def _unknown_rows(outcomes: Sequence[Plain], tier: str) -> list[dict[str, Any]]:
    """What became of causes off the list, by cause."""
    there = [o for o in outcomes if o["tier"] == tier]

    def false_names(o: Plain) -> list[str]:
        return [n for n in o["named"] if n in VOCABULARY and n not in o["causes"]]

    rows = []
    for cause in sorted({c for o in there for c in o["causes"]}):
        here = [o for o in there if cause in o["causes"]]
        wrong = Counter(name for o in here for name in false_names(o))
        rows.append(
            {
                "cause": cause,
                "found": _alarmed(here),
                "recognised": _share(sum(o["recognised"] for o in here), len(here)),
                "false_name": _share(sum(bool(false_names(o)) for o in here), len(here)),
                "names": dict(wrong.most_common(3)),
            }
        )
    return rows
