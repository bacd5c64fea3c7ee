"""The contests of two records of the same code, taken together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cyclosweep.challenge.record.contest import OWN
from cyclosweep.challenge.record.markdown import Plain, table, text
from cyclosweep.challenge.scoring.figures import ALIKE, share_behind
from cyclosweep.challenge.scoring.intervals import Estimate, together
from cyclosweep.challenge.scoring.power import PROGRAMMES
from cyclosweep.challenge.scoring.rivals import OURS

Key = tuple[str, str, str]


def same_code(one: Plain, other: Plain) -> bool:
    """Whether two records were diagnosed, and their recordings made, by the same code."""
    return all(one["record"][key] == other["record"][key] for key in ("diagnosis", "rig"))


def distances(content: Plain, setting: str = "tuned_ahead") -> dict[Key, Estimate]:
    """How far each opponent is behind, by noise, programme and name, in the order of a page."""
    found = {key: o[OWN][setting] for key, o in _keyed(content)}
    return {key: Estimate(**plain) for key, plain in found.items() if plain["count"]}


def _keyed(content: Plain) -> Iterator[tuple[Key, Plain]]:
    for noise in dict.fromkeys(o["noise"] for o in content["opponents"]):
        for programme in PROGRAMMES:
            for o in content["opponents"]:
                if (o["noise"], o["programme"]) == (noise, programme) and o["who"] != OURS:
                    yield (noise, programme, o["who"]), o


def both(contest: Plain, proof: Plain) -> dict[Key, Estimate]:
    """Distances over both records, alike; none where their code is not the same."""
    if not same_code(contest, proof):
        return {}
    here, there = distances(contest), distances(proof)
    return {key: together([here[key], there[key]]) for key in here if key in there}


def behind_table(contest: Plain, proof: Plain | None) -> str:
    """Every opponent's distance in every comparison, in the proof too, and over both."""
    columns = {
        "alike": distances(contest),
        "as it is": distances(contest, "ahead"),
        "alike in the proof": {} if proof is None else distances(proof),
        "alike, both": {} if proof is None else both(contest, proof),
    }

    def cell(column: Mapping[Key, Estimate], key: Key) -> str:
        return text(vars(column[key]), 2) if key in column else "–"

    return table(
        ("noise", "programme", "opponent", *columns),
        ((*key, *(cell(c, key) for c in columns.values())) for key, _ in _keyed(contest)),
    )


def both_figures(contest: Plain, proof: Plain) -> list[Plain]:
    """Share of opponents that are behind over both records, for each noise and programme."""
    over = both(contest, proof)
    return [
        share_behind(
            f"on {noise} noise",
            f"{programme}, both records",
            ALIKE,
            [e.low > 0.0 for (n, p, _), e in over.items() if (n, p) == (noise, programme)],
            1.0,
        ).as_dict()
        for noise, programme in dict.fromkeys((n, p) for n, p, _ in over)
    ]
