"""The page of a record that is the contest with the opponents alone."""

from __future__ import annotations

from collections.abc import Sequence

from cyclosweep.challenge.record.contest import contest_section
from cyclosweep.challenge.record.markdown import Plain
from cyclosweep.challenge.record.origin import origin
from cyclosweep.challenge.record.targets import judged, target_tables
from cyclosweep.challenge.record.together import behind_table, both_figures


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
    over = [] if proof is None else both_figures(content, proof)
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
        "alarms. The last column is for the recordings of both records, if one code diagnosed and "
        "made them all: the two distances, each weighted by its precision.\n\n"
        + behind_table(content, proof)
        + ("\n\n" + judged(over) if over else ""),
        "## Figures\n\nEvery figure for which there are cases here.\n\n"
        + target_tables([f for f in content["figures"] if f["estimate"]["count"]]),
        contest_section(content, "contest"),
    )
    return "\n\n".join(part for part in sections if part) + "\n"
