"""The page of a record that is the contest with the opponents alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cyclosweep_challenge.record.contest import contest_section
from cyclosweep_challenge.record.markdown import Plain
from cyclosweep_challenge.record.origin import origin
from cyclosweep_challenge.record.targets import judged, target_tables
from cyclosweep_challenge.record.together import behind_table, figures_over_all


def contest_page(
    name: str, content: Plain, log: Sequence[Plain], notes: str, others: Mapping[str, Plain]
) -> str:
    """Page of the contest.

    Parameters
    ----------
    name : str
        Name of the page, and of the make target after ``proof-``.
    content : mapping
        What ``<name>.json`` holds.
    log : sequence of mapping
        Lines of its log.
    notes : str
        What was written by hand about it.
    others : mapping of str to mapping
        Figures of the other pages of record, by name, to lay beside.
    """
    seed, programme = content["record"]["seed"], content["record"]["size"].get("programme")
    over = figures_over_all(content, list(others.values()))
    where = f" on {programme} programmes" if programme else ""
    variable = f"{name.replace('-', '_').upper()}_SEED"
    sections = (
        f"# The contest{where}: who finds what is concealed, at one false alarm in a hundred\n\n"
        f"Written by `make proof-{name}`; not edited by hand. The contest of "
        "[proof.md](proof.md) once more, on other recordings, with more of them with nothing "
        "missing: the threshold of a detector at one false alarm in a hundred is set by a handful "
        "of them, and so decides how sure a comparison can be. The costly opponents (LassoCV, "
        "bagged STLSQ, Gaussian process) see no more of them than in the proof. Seals, log and "
        "checks are those of the proof. Every figure stands with its 95 % interval in "
        "brackets.\n\n" + origin(content, log, name, f"`make proof-{name} {variable}={seed}`"),
        notes,
        "## Who is behind\n\n"
        "Share of recordings of d = 3 to 10 that the diagnosis finds and the opponent does not, "
        "less the share that the opponent alone finds, on the same files. The opponent stands at "
        "the threshold that one in a hundred recordings with nothing missing and that noise "
        "exceeds; the diagnosis at the same (both at 1 %), or as it is, where it raises fewer "
        "alarms. The last column is for the recordings of all records that one code made and "
        "diagnosed: their distances, each weighted by its precision, as if their intervals were "
        "symmetric and normal. To take records together was decided after the first two were "
        "read; these figures stand beside the others, and no target is theirs. Which record "
        "decides which comparison, and when that was settled: "
        "[challenge.md](../docs/challenge.md).\n\n"
        + behind_table(content, others)
        + ("\n\n" + judged(over) if over else ""),
        f"## Figures\n\nEvery figure for which there are cases here{_only(programme)}.\n\n"
        + target_tables([f for f in content["figures"] if f["estimate"]["count"]]),
        contest_section(content, name),
    )
    return "\n\n".join(part for part in sections if part) + "\n"


def _only(programme: str | None) -> str:
    """Sentence on figures that name no programme, where the record has one programme only."""
    if not programme:
        return ""
    return (
        f". Those that name no programme are of {programme} ones here; their targets are for rich "
        "and poor ones together"
    )
