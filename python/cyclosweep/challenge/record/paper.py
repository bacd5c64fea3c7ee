"""The page of record: docs/proof.md and docs/proof.json from a record's folder."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cyclosweep.challenge.noise import NOISES
from cyclosweep.challenge.record.contest import contest_section, write_pictures
from cyclosweep.challenge.record.markdown import Plain, table, text
from cyclosweep.challenge.record.parts import Size
from cyclosweep.challenge.record.real import real_drive
from cyclosweep.challenge.scoring.intervals import share
from cyclosweep.challenge.scoring.power import PROGRAMMES
from cyclosweep.challenge.specimen import VOCABULARY

NOTES = "proof-notes.md"


def write_paper(record: Path, docs: Path) -> Path:
    """Write ``proof.md``, ``proof.json``, ``proof-published.jsonl`` and the pictures.

    What ``proof-notes.md`` in the same folder says is taken over word for word, with a remark
    above it where it does not name the record's seed.

    Parameters
    ----------
    record : pathlib.Path
        Folder of the record, scored.
    docs : pathlib.Path
        Where the page goes.
    """
    docs.mkdir(parents=True, exist_ok=True)
    score = json.loads((record / "score.json").read_text())
    outcomes = json.loads((record / "outcomes.json").read_text())
    about = json.loads((record / "record.json").read_text())
    published = record / "PUBLISHED.jsonl"
    lines = published.read_text() if published.exists() else ""
    log = [json.loads(line) for line in lines.splitlines()]
    measured_file = record / "measured" / "measured.json"
    measured = json.loads(measured_file.read_text()) if measured_file.exists() else []
    tables = {
        "false_alarms": _alarm_rows(outcomes),
        "tiers": _tier_rows(outcomes),
        "single_effects": _effect_rows(outcomes),
        "aliens": _unknown_rows(outcomes, "C5-alien"),
        "removed": _unknown_rows(outcomes, "C5-removed"),
    }
    (docs / "proof-published.jsonl").write_text(lines)
    write_pictures(score, docs)
    sections = (
        _head(score, about, log),
        _targets(score),
        _alarms(tables["false_alarms"]),
        contest_section(score),
        _naming(score, tables),
        _calibration(score),
        _unknowns(tables),
        real_drive(measured),
        "## What the misses teach\n\n" + _notes(docs / NOTES, about["seed"]),
        _checking(about),
    )
    page = docs / "proof.md"
    page.write_text("\n\n".join(sections) + "\n", encoding="utf-8")
    content = score | {"record": about, "tables": tables, "measured": measured}
    (docs / "proof.json").write_text(json.dumps(content, indent=1) + "\n")
    return page


def _notes(file: Path, seed: int) -> str:
    """What was written by hand about this record; words about another one say so."""
    if not file.exists():
        return "Nothing has been written yet."
    words = file.read_text().strip()
    if f"seed {seed}" in words:
        return words
    return f"**Not yet rewritten for the record of seed {seed} above.**\n\n{words}"


def _part(hits: int, count: int) -> dict[str, Any]:
    """Share with its exact interval as plain data."""
    return dict(vars(share(hits, count))) if count else {"value": None, "count": 0}


def _head(score: Plain, about: Plain, log: Sequence[Plain]) -> str:
    machine = about["machine"]
    done = score["about"]["parts"]
    libraries = ", ".join(f"{k} {v}" for k, v in machine["libraries"].items() if v)
    rows = [
        (
            "command",
            f"`make proof-record RECORD_SEED={about['seed']}`, with `CYCLOSWEEP_MEASURED` naming "
            "the folder of the real drive's loops",
        ),
        ("seed", f"{about['seed']} and the four numbers after it, one for each part"),
        ("begun, ended", f"{log[0]['time'][:16]}, {log[-1]['time'][:16]} UTC" if log else "–"),
        (
            "machine",
            f"{machine['processor']}, {machine['cores']} cores, {machine['memory_gb']} GB, "
            f"{machine['system']}, Python {machine['python']}",
        ),
        ("libraries", libraries),
        ("commit", f"`{about['commit'] or 'unknown'}`"),
        ("code that diagnoses, SHA-256", f"`{about['diagnosis']}`"),
        ("code that makes recordings, SHA-256", f"`{about['rig']}`"),
        ("head of the log, SHA-256", f"`{score['about']['root']}`"),
    ]
    counted = [
        (part.name, f"{done.get(part.name, 0):,}", f"{part.cases:,}", part.what)
        for part in Size(**about["size"]).parts()
        if part.cases
    ]
    return (
        "# The proof: concealed physics, sealed answers, opponents, and a real drive\n\n"
        "Written by `make proof-record` from the run of record; not edited by hand. What is "
        "concealed and how, and what the tiers mean: [challenge.md](challenge.md). Every figure "
        "stands with its 95 % interval in brackets: exact (Clopper and Pearson) for shares, by "
        "bootstrap for the rest.\n\n"
        + table(("", ""), rows)
        + "\n\n"
        + table(("part", "done", "planned", "what"), counted)
        + "\n\nAll numbers are in [proof.json](proof.json), the root of every slice of sealed "
        "answers with the time of its publication in "
        "[proof-published.jsonl](proof-published.jsonl)."
    )


def _reached(figure: Plain) -> str:
    if figure["met"] is None:
        return "" if figure["target"] == "none" else "too few cases"
    if figure["met"]:
        return "reached"
    return "required only" if figure["met_required"] else "**missed**"


def _targets(score: Plain) -> str:
    aimed = [f for f in score["figures"] if f["target"] != "none"]
    others = [f for f in score["figures"] if f["target"] == "none"]
    missed = sum(f["met"] is False for f in aimed)
    failed = sum(f["met_required"] is False for f in aimed)
    return (
        "## The table of targets\n\n"
        f"{len(aimed)} figures have a target, {missed} miss it, {failed} miss what is required. "
        "None is left out.\n\n"
        + table(
            ("figure", "reached [95 %]", "cases", "target", "required", ""),
            (
                (
                    f["name"],
                    text(f["estimate"]),
                    f["estimate"]["count"],
                    f["target"],
                    f["required"] or "",
                    _reached(f),
                )
                for f in aimed
            ),
        )
        + "\n\nBeside them, without a target:\n\n"
        + table(
            ("figure", "reached [95 %]", "cases"),
            ((f["name"], text(f["estimate"]), f["estimate"]["count"]) for f in others),
        )
    )


def _alarm_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
    rows = []
    for family in NOISES:
        there = [o for o in outcomes if o["tier"] == "C6" and o["noise"] == family]
        row: dict[str, Any] = {"family": family, "all": _alarmed(there)}
        for programme in ("rich", "middle", "poor", "oneway"):
            row[programme] = _alarmed([o for o in there if o["programme"] == programme])
        row["said"] = dict(Counter(o["verdict"] for o in there))
        rows.append(row)
    return rows


ALARMS = ("IDENTIFIED", "AMBIGUOUS", "UNKNOWN_PHYSICS")


def _alarmed(there: Sequence[Plain]) -> dict[str, Any]:
    return _part(sum(o["verdict"] in ALARMS for o in there), len(there))


def _alarms(rows: Sequence[Plain]) -> str:
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


def _right(o: Plain) -> bool:
    return o["verdict"] == "IDENTIFIED" and set(o["named"]) == set(o["causes"])


def _tier_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
    rows = []
    concealed = {"C0", "C1", "C2", "C3", "C4", "C5-alien", "C5-removed", "C7"}
    for stratum in sorted({o["stratum"] for o in outcomes if o["tier"] in concealed}, key=_by_d):
        there = [o for o in outcomes if o["stratum"] == stratum]
        rows.append(
            {
                "stratum": stratum,
                "found": _alarmed(there),
                "named_right": _part(sum(map(_right, there)), len(there)),
                "said": dict(Counter(o["verdict"] for o in there)),
            }
        )
    return rows


def _by_d(stratum: str) -> tuple[str, float]:
    kind, _, d = stratum.partition("/d=")
    return kind, float(d.split("+")[-1]) if d else 0.0


def _effect_rows(outcomes: Sequence[Plain]) -> list[dict[str, Any]]:
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
                row[f"d{d}"] = _part(sum(map(_right, there)), len(there))
            rows.append(row)
    return rows


def _naming(score: Plain, tables: Plain) -> str:
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
    if not rows:
        return "No cases."
    names = [n for n in rows[0] if n != "cause"]
    used = [n for n in names if any(r[n] for r in rows)]
    return table(
        ("at work \\ said", *(n.replace("_", " ") for n in used)),
        ((r["cause"].replace("_", " "), *(r[n] or "" for n in used)) for r in rows),
    )


def _calibration(score: Plain) -> str:
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


def _unknown_rows(outcomes: Sequence[Plain], tier: str) -> list[dict[str, Any]]:
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
                "recognised": _part(sum(o["recognised"] for o in here), len(here)),
                "false_name": _part(sum(bool(false_names(o)) for o in here), len(here)),
                "names": dict(wrong.most_common(3)),
            }
        )
    return rows


def _unknowns(tables: Plain) -> str:
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
    return f"""## How to check this

For someone who distrusts all of it:

1. **Another seed gives the same picture.** `make proof` makes a smaller run of another seed in
   about ten minutes and lays every figure beside the record's; `PROOF_SEED=...` picks the
   seed, a multiple of ten. The whole record again: `make proof-record RECORD_SEED=...
   RECORD_OUT=...`. It may be stopped and called again, or run in pieces with
   `RECORD_FLAGS="--minutes M"`: all parts grow together, and what is finished is scored.
2. **The answers were sealed before anything was diagnosed.** The root over the answers of each
   slice stands in the log before that slice is diagnosed, every line of the log holds the hash of
   the line before, and the last one's hash is printed above.
   `python -m cyclosweep.challenge.record --out DIR --only-verify --verify 20` checks the log, its
   order, the seals and the kept diagnoses, and makes every twentieth recording and answer again
   from the seed (the same versions of the libraries, and a like processor, give the same bytes).
   It needs the record's folder, which holds thousands of files and is not in this repository; a
   hash also covers a random nonce, so that a run of one's own has other roots for the same answers.
   The diagnosis is a process of its own in a folder with nothing but copies of recordings:
   `python/cyclosweep/challenge/diagnosing.py`.
3. **The rig shares nothing with what it tests.** `tests/unit/challenge/test_import_rule.py`: the
   generator imports NumPy, SciPy, Polars and itself, and nothing that diagnoses imports the
   challenge. Other equations, too: [challenge.md](challenge.md) says how each cause is made.
4. **Nothing was tuned on these seeds.** Records use seeds from 100,000 on (`RECORD_SEED` in
   `python/cyclosweep/challenge/runner/run.py`), development used seeds below 10,000. What earlier
   records of other seeds, whole or partial, showed was repaired before this one was begun; the
   measured drive is the same in every record, and no unseen evidence. The hash of the
   code that diagnosed is written down before the first recording is made
   (`{about["diagnosis"][:16]}…`), and a record whose code has changed is refused, so that no
   record mixes versions. `git log` shows what came after.
5. **The opponents got a fair chance.** `python/cyclosweep/challenge/opponents/`: the baseline is
   taken out of their columns, and their thresholds are set on the same recordings with nothing
   missing. To see both with thresholds set in the same way, read the column `ahead alike`.
"""
