"""Comparison with opponents over several records of the same code."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from cyclosweep_challenge.record.contest import OWN
from cyclosweep_challenge.record.markdown import Plain, table, text
from cyclosweep_challenge.scoring.comparison import AT_EQUAL_ALARMS, share_behind
from cyclosweep_challenge.scoring.intervals import Estimate, together
from cyclosweep_challenge.scoring.opponents import OURS
from cyclosweep_challenge.scoring.power import PROGRAMMES

Key = tuple[str, str, str]


def same_code(one: Plain, other: Plain) -> bool:
    """Whether two records were diagnosed, and their recordings made, by the same code."""
    return all(one["record"][key] == other["record"][key] for key in ("diagnosis", "rig"))


def distances(content: Plain, setting: str = "tuned_ahead") -> dict[Key, Estimate]:
    """How far each opponent is behind, by noise, programme and name, in the order of a page."""
    found = {key: o[OWN][setting] for key, o in _keyed(content)}
    return {key: Estimate(**plain) for key, plain in found.items() if plain["count"]}


def _keyed(content: Plain) -> Iterator[tuple[Key, Plain]]:
    """Opponents' curves by noise, programme and name, in the order of a page."""
    for noise in dict.fromkeys(o["noise"] for o in content["opponents"]):
        for programme in PROGRAMMES:
            for o in content["opponents"]:
                if (o["noise"], o["programme"]) == (noise, programme) and o["who"] != OURS:
                    yield (noise, programme, o["who"]), o


def over_all(content: Plain, others: Sequence[Plain]) -> dict[Key, Estimate]:
    """Distances at equal false alarms over all records of the same code, if there are several."""
    seeds = {c["record"]["seed"]: c for c in (content, *others) if same_code(content, c)}
    records = [distances(c) for c in seeds.values()]
    shared = {key: [there[key] for there in records if key in there] for key in distances(content)}
    return {key: together(found) for key, found in shared.items() if len(found) > 1}


def behind_table(content: Plain, others: Mapping[str, Plain]) -> str:
    """Every opponent's distance in every comparison, in other records too, and over all.

    Parameters
    ----------
    content : mapping
        The record's figures.
    others : mapping of str to mapping
        Figures of other records, by the names of their pages.
    """
    columns = {
        "both at 1 %": distances(content),
        "as it is": distances(content, "ahead"),
        **{
            f"both at 1 %, in [{name}]({name}.md)": distances(there)
            for name, there in others.items()
        },
        "both at 1 %, all records": over_all(content, list(others.values())),
    }

    def cell(column: Mapping[Key, Estimate], key: Key) -> str:
        return text(vars(column[key]), 2) if key in column else "–"

    return table(
        ("noise", "programme", "opponent", *columns),
        ((*key, *(cell(c, key) for c in columns.values())) for key, _ in _keyed(content)),
    )


def figures_over_all(content: Plain, others: Sequence[Plain]) -> list[Plain]:
    """Share of opponents that are behind over all records, for each noise and programme.

    These are shown and have no target: docs/challenge.md says which record decides.
    """
    over = over_all(content, others)
    return [
        share_behind(
            f"on {noise} noise",
            f"{programme}, all records",
            AT_EQUAL_ALARMS,
            [e.low > 0.0 for (n, p, _), e in over.items() if (n, p) == (noise, programme)],
            None,
        ).as_dict()
        for noise, programme in dict.fromkeys((n, p) for n, p, _ in over)
    ]
