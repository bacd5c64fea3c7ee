"""The page of a record that is the contest with the opponents alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cyclosweep.challenge.record.contest import OWN, contest_section
from cyclosweep.challenge.record.markdown import Plain, table, text
from cyclosweep.challenge.record.origin import origin
from cyclosweep.challenge.record.targets import target_tables
from cyclosweep.challenge.scoring.power import PROGRAMMES
from cyclosweep.challenge.scoring.rivals import OURS


def contest_page(content: Plain, log: Sequence[Plain], notes: str, proof: Plain | None) -> str:
    """Page of the contest.

    Parameters
    ----------
    content : mapping
        What ``contest.json`` holds.
    log : sequence of mapping
        Lines of its log.
    notes : str
        What was written by hand about it.
    proof : mapping or None
        What ``proof.json`` holds: the contest within the whole proof, to lay beside.
    """
    seed = content["record"]["seed"]
    sections = (
        "# The contest: who finds what is concealed, at one false alarm in a hundred\n\n"
        "Written by `make proof-contest`; not edited by hand. The contest of "
        "[proof.md](proof.md) once more, on other recordings, with more of them with nothing "
        "missing: the threshold of a detector at one false alarm in a hundred is set by a handful "
        "of them, and so decides how sure a comparison can be. The costly opponents (LassoCV, "
        "bagged STLSQ, Gaussian process) see no more of them than in the proof. Seals, log and "
        "checks are those of the proof. Every figure stands with its 95 % interval in "
        "brackets.\n\n"
        + origin(content, log, "contest", f"`make proof-contest CONTEST_SEED={seed}`"),
        notes,
        "## Who is behind\n\n"
        "Share of recordings of d = 3 to 10 that the diagnosis finds and the opponent does not, "
        "less the share that the opponent alone finds, on the same files. The opponent stands at "
        "the threshold that one in a hundred recordings with nothing missing and that noise "
        "exceeds; the diagnosis at the same (alike), or as it is, where it raises fewer "
        "alarms.\n\n" + _behind(content, proof),
        "## Figures\n\nEvery figure for which there are cases here.\n\n"
        + target_tables([f for f in content["figures"] if f["estimate"]["count"]]),
        contest_section(content, "contest"),
    )
    return "\n\n".join(part for part in sections if part) + "\n"


def _behind(content: Plain, proof: Plain | None) -> str:
    """Every opponent's distance in every comparison, beside that in the proof."""
    before = {} if proof is None else dict(_keyed(proof))
    rows = []
    for key, o in _keyed(content):
        there = before.get(key)
        rows.append(
            (
                *key,
                text(o[OWN]["tuned_ahead"], 2),
                text(o[OWN]["ahead"], 2),
                "–" if there is None else text(there[OWN]["tuned_ahead"], 2),
            )
        )
    other = "–" if proof is None else f"alike in proof.md, seed {proof['record']['seed']}"
    return table(("noise", "programme", "opponent", "alike", "as it is", other), rows)


def _keyed(content: Plain) -> Iterator[tuple[tuple[str, str, str], Plain]]:
    """Opponents of a score by noise, programme and name, in the order of the page."""
    noises = dict.fromkeys(o["noise"] for o in content["opponents"])
    for noise in noises:
        for programme in PROGRAMMES:
            for o in content["opponents"]:
                if (o["noise"], o["programme"]) == (noise, programme) and o["who"] != OURS:
                    yield (noise, programme, o["who"]), o
