"""The page of the whole proof, from its figures and its log."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cyclosweep_challenge.record.contest import contest_section
from cyclosweep_challenge.record.markdown import Plain, table, text
from cyclosweep_challenge.record.origin import origin
from cyclosweep_challenge.record.real import real_drive
from cyclosweep_challenge.record.targets import judged, target_tables
from cyclosweep_challenge.record.together import figures_over_all
from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.scoring.comparison import OPPONENTS
from cyclosweep_challenge.scoring.power import PROGRAMMES


def proof_page(
    content: Plain, log: Sequence[Plain], notes: str, contests: Mapping[str, Plain]
) -> str:
    """Page of record.

    Parameters
    ----------
    content : mapping
        What ``proof.json`` holds.
    log : sequence of mapping
        Lines of its log.
    notes : str
        What was written by hand about it.
    contests : mapping of str to mapping
        Figures of the pages on which the contest was run again, by name.
    """
    tables, about = content["tables"], content["record"]
    sections = (
        _head(content, log),
        _targets(content, contests),
        _alarms(tables["false_alarms"]),
        contest_section(content, "proof"),
        _naming(content, tables),
        _calibration(content),
        _unknowns(tables),
        real_drive(content["measured"]),
        "## What the misses teach\n\n" + (notes or "Nothing has been written yet."),
        _checking(about),
    )
    return "\n\n".join(sections) + "\n"


def _head(content: Plain, log: Sequence[Plain]) -> str:
    """Title and origin."""
    return (
        "# The proof: concealed physics, committed answers, opponents, and a real drive\n\n"
        "Written by `make proof-faint` from the run of record; not edited by hand. What is "
        "concealed and how, and what the tiers mean: [challenge.md](../docs/challenge.md). "
        "Every figure stands with its 95 % interval in brackets: exact (Clopper and Pearson) for "
        "shares, by bootstrap for the rest.\n\n"
        + origin(
            content,
            log,
            "proof",
            f"`make proof-faint RECORD_SEED={content['record']['seed']}`, with "
            "`CYCLOSWEEP_MEASURED` naming the folder of the real drive's loops",
        )
    )


def _targets(content: Plain, contests: Mapping[str, Plain]) -> str:
    """Table of targets, and those of the contests."""
    parts = ["## The table of targets\n\n" + target_tables(content["figures"])]
    if contests:
        parts.append(
            "The contest with the opponents was run again, with other recordings and more of them "
            "to set thresholds on. How many of them are behind stands below and, without a "
            "target, over all records of one code. Which record decides which comparison, and "
            "when that was settled: [challenge.md](../docs/challenge.md)."
        )
    for name, there in contests.items():
        compared = [
            f
            for f in there["figures"]
            if f["name"].startswith(OPPONENTS) and f["estimate"]["count"]
        ]
        parts.append(
            f"Seed {there['record']['seed']}, [{name}.md]({name}.md):\n\n" + judged(compared)
        )
    over = figures_over_all(content, list(contests.values()))
    if over:
        parts.append("All records:\n\n" + judged(over))
    return "\n\n".join(parts)


def _alarms(rows: Sequence[Plain]) -> str:
    """Table of false alarms by family of noise."""
    programmes = ("rich", "middle", "poor", "oneway")

    def cell(e: Plain) -> str:
        return f"{round(e['value'] * e['count'])} of {e['count']}" if e["count"] else "–"

    body = []
    for row in rows:
        said = row["said"]
        e = row["all"]
        body.append(
            (
                row["family"],
                cell(e),
                f"{100 * e['value']:.2f} %" if e["count"] else "–",
                f"{100 * e['high']:.2f} %" if e["count"] else "–",
                *(cell(row[p]) for p in programmes),
                said.get("NOTHING_MISSING", 0),
                said.get("INSUFFICIENT_DATA", 0),
                said.get("DATA_FAULT", 0) + said.get("FAILURE", 0),
            )
        )
    return (
        "## False alarms\n\n"
        "An alarm is IDENTIFIED, AMBIGUOUS or UNKNOWN_PHYSICS where nothing is missing. The upper "
        "bound is the exact two-sided 95 % one.\n\n"
        + table(
            (
                "family",
                "alarms",
                "share",
                "upper bound",
                *programmes,
                "nothing missing",
                "insufficient data",
                "fault or failure",
            ),
            body,
        )
    )


def _naming(score: Plain, tables: Plain) -> str:
    """Tables of what was named, by stratum and effect."""
    verdicts = ("IDENTIFIED", "AMBIGUOUS", "UNKNOWN_PHYSICS", "NOTHING_MISSING")
    parts = [
        "## Naming\n\n"
        "`named right` is IDENTIFIED with exactly the true set. For recordings without a member "
        "of the vocabulary (C5) and for aliases (C7) it cannot be.\n\n"
        + table(
            ("stratum", "cases", "found", "named right", *(v.lower() for v in verdicts), "other"),
            (
                (
                    r["stratum"],
                    r["found"]["count"],
                    text(r["found"], 2),
                    text(r["named_right"], 2) if not r["stratum"].startswith(("C5", "C7")) else "",
                    *(r["said"].get(v, 0) for v in verdicts),
                    sum(n for v, n in r["said"].items() if v not in verdicts),
                )
                for r in tables["tiers"]
            ),
        ),
        "### Single effects in the open, by effect\n\nShare named right.\n\n"
        + table(
            ("effect", *(f"{p}, d = {d}" for p in PROGRAMMES for d in (6, 10, 20))),
            (
                (
                    cause,
                    *(
                        text(row[f"d{d}"], 2)
                        for p in PROGRAMMES
                        for row in tables["single_effects"]
                        if row["programme"] == p and row["cause"] == cause
                        for d in (6, 10, 20)
                    ),
                )
                for cause in VOCABULARY
            ),
        ),
    ]
    for programme, rows in score["confusion"].items():
        parts.append(
            f"### Who is taken for whom, {programme} programme, d above 9\n\n" + _matrix(rows)
        )
    return "\n\n".join(parts)


def _matrix(rows: Sequence[Plain]) -> str:
    """Confusion matrix."""
    if not rows:
        return "No cases."
    names = [n for n in rows[0] if n != "cause"]
    used = [n for n in names if any(r[n] for r in rows)]
    return table(
        ("at work \\ said", *(n.replace("_", " ") for n in used)),
        ((r["cause"].replace("_", " "), *(r[n] or "" for n in used)) for r in rows),
    )


def _calibration(score: Plain) -> str:
    """Table of stated probabilities against frequencies."""
    return (
        "## Stated probabilities\n\n"
        + table(
            ("stated, mean", "came true [95 %]", "explanations"),
            ((f"{b['stated']:.3f}", text(b), b["count"]) for b in score["calibration"]),
        )
        + "\n\nThe calibration error in the table of targets is the mean distance of the two, "
        "weighted by explanations; even probabilities exactly as stated would show the second "
        "figure there by chance."
    )


def _unknowns(tables: Plain) -> str:
    """Tables of causes that are not on the list."""
    parts = ["## Causes that are not on the list"]
    for key, words in (
        ("aliens", "On nobody's list"),
        ("removed", "Taken out of the library before the diagnosis"),
    ):
        parts.append(
            f"### {words}\n\n"
            + table(
                ("cause", "cases", "found", "recognised", "given a false name", "which"),
                (
                    (
                        r["cause"],
                        r["found"]["count"],
                        text(r["found"], 2),
                        text(r["recognised"], 2),
                        text(r["false_name"], 2),
                        ", ".join(f"{n} {k}" for n, k in r["names"].items()),
                    )
                    for r in tables[key]
                ),
            )
        )
    return "\n\n".join(parts)


def _checking(about: Plain) -> str:
    """How to check a record."""
    return f"""## How to check this

For someone who distrusts all of it:

1. **Another seed gives the same picture.** `make proof` makes a smaller run of another seed in
   about ten minutes and lays every figure beside the record's; `PROOF_SEED=...` picks the
   seed, a multiple of ten. The whole record again: `make proof-faint RECORD_SEED=...
   RECORD_OUT=...`; the contests with the opponents: `make proof-contest CONTEST_SEED=...
   CONTEST_OUT=...` and `make proof-contest-poor CONTEST_POOR_SEED=... CONTEST_POOR_OUT=...`. Each
   may be stopped and called again, or run in pieces with `RECORD_FLAGS="--minutes M"`: all parts
   grow together, and what is finished is scored. They write their pages into `proof`: `git diff`
   shows what is different, `git checkout proof` takes it back.
2. **The answers were fixed before anything was diagnosed.** The root over the answers of each
   slice stands in the log before that slice is diagnosed, every line of the log holds the hash of
   the line before, and the last one's hash is printed above.
   `python -m cyclosweep_challenge.record --out DIR --only-verify --verify 20` checks the log, its
   order, the answers and the kept diagnoses, and makes every twentieth recording and answer again
   from the seed (the same versions of the libraries, and a like processor, give the same bytes).
   It needs the record's folder, which holds thousands of files and is not in this repository; a
   hash also covers a random nonce, so that a run of one's own has other roots for the same answers.
   The diagnosis is a process of its own in a folder with nothing but copies of recordings:
   `python/cyclosweep_challenge/runner/diagnosing.py`.
3. **The rig shares nothing with what it tests.** `tests/unit/challenge/test_import_rule.py`: the
   generator imports NumPy, SciPy, Polars and itself, and nothing that diagnoses imports the
   challenge. Other equations, too: [challenge.md](../docs/challenge.md) says how each cause is
   made.
4. **Nothing was tuned on these seeds.** Records use seeds from 100,000 on (`RECORD_SEED` in
   `python/cyclosweep_challenge/runner/run.py`), development used seeds below 10,000. What earlier
   records of other seeds, whole or partial, showed was repaired before this one was begun; the
   measured drive is the same in every record, and no unseen evidence. The hash of the
   code that diagnosed is written down before the first recording is made
   (`{about["diagnosis"][:16]}…`), and a record whose code has changed is refused, so that no
   record mixes versions. `git log` shows what came after.
5. **The opponents got a fair chance.** `python/cyclosweep_challenge/opponents/`: the baseline is
   taken out of their columns, and their thresholds are set on the same recordings with nothing
   missing. To see both with thresholds set in the same way, read `ahead, both at 1 %`.
"""
