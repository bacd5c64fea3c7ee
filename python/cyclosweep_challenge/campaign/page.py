"""The page of a campaign, from its figures and its log alone."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from cyclosweep_challenge.campaign.summary import put_summary
from cyclosweep_challenge.record.markdown import Plain, table, text
from cyclosweep_challenge.record.targets import judged

NAME = "rigs"
"""Name of the page, its figures and its log."""
VERDICTS = (
    "IDENTIFIED",
    "MOSTLY_EXPLAINED",
    "AMBIGUOUS",
    "UNKNOWN_PHYSICS",
    "NOTHING_MISSING",
    "INSUFFICIENT_DATA",
)
RIVALS = {
    "kennedy_ohagan": "Gaussian-process discrepancy (Kennedy and O'Hagan)",
    "bic_subset": "best subset by BIC, textbook library",
    "bic_subset_project": "best subset by BIC, the project's library",
    "bic_subset_whitened": "best subset by BIC, the project's library and whitening",
    "lasso_cv": "LassoCV, textbook library",
    "lasso_cv_project": "LassoCV, the project's library",
    "lasso_cv_whitened": "LassoCV, the project's library and whitening",
    "stlsq": "STLSQ, textbook library",
    "stlsq_project": "STLSQ, the project's library",
    "stlsq_whitened": "STLSQ, the project's library and whitening",
}
"""Opponents in words."""


def campaign_page(content: Plain, log: Sequence[Plain], notes: str = "") -> str:
    """Page of a campaign.

    Parameters
    ----------
    content : mapping
        What ``rigs.json`` holds.
    log : sequence of mapping
        Lines of its log.
    notes : str
        What was written by hand about it.
    """
    return (
        "\n\n".join(
            (
                "# The record across both generators: loud, faint and foreign recordings",
                _head(),
                _origin(content, log),
                _parts(content),
                _targets(content),
                _before(content["before"]),
                _rivals(content["tables"]["rivals"]),
                _causes(content["tables"]["causes"]),
                _verdicts(content["tables"]["verdicts"]),
                _real(content["real"]),
                "## What the misses teach\n\n" + (notes or "Nothing has been written yet."),
            )
        )
        + "\n"
    )


def _head() -> str:
    """What the page is."""
    return (
        "Written by `make proof-record` from its run; not edited by hand. The *first* generator "
        "solves the reference drive at contact level with laws that the library nearly holds; the "
        "laws of the *second* come from the literature and were written without a look at the "
        "library. How recordings are made, concealed and sealed: "
        "[challenge.md](../docs/challenge.md). Figures stand with their 95 % interval in brackets: "
        "exact (Clopper and Pearson) for shares, by bootstrap for the rest. *Named right* is "
        "exactly the true set of effects: under IDENTIFIED for the figures of the first records, "
        "under IDENTIFIED or MOSTLY_EXPLAINED for loud recordings and foreign laws."
    )


def _origin(content: Plain, log: Sequence[Plain]) -> str:
    """Where the figures come from."""
    about = content["record"]
    machine = about["machine"]
    made = f"`make proof-record CAMPAIGN_SEED={about['seed']} CAMPAIGN_SCALE={about['scale']:g}`"
    return table(
        ("", ""),
        (
            ("command", made),
            ("begun, ended", f"{log[0]['time'][:16]}, {log[-1]['time'][:16]} UTC" if log else "–"),
            (
                "machine",
                f"{machine['processor']}, {machine['cores']} cores, {machine['memory_gb']} GB, "
                f"{machine['system']}, Python {machine['python']}",
            ),
            ("libraries", ", ".join(f"{k} {v}" for k, v in machine["libraries"].items() if v)),
            ("commit", f"`{about['commit'] or 'unknown'}`"),
            ("code that diagnoses, SHA-256", f"`{about['diagnosis']}`"),
            ("code that makes recordings, SHA-256", f"`{about['rig']}`"),
            ("head of the log, SHA-256", f"`{content['head']}`"),
        ),
    )


def _parts(content: Plain) -> str:
    """What was recorded, and what so many recordings can decide."""
    planned, done = content["record"]["parts"], content["done"]
    return (
        "## What was recorded\n\n"
        + table(
            ("part", "generator", "done", "planned", "what", "what so many can decide"),
            (
                (
                    part["name"],
                    part["generator"],
                    done[part["name"]],
                    planned[part["name"]],
                    part["what"],
                    part["decides"],
                )
                for part in content["parts"]
            ),
        )
        + "\n\nWhat can be decided is stated for a scale of one. Each part grew in steps; every "
        "step's answers were committed to in [the log](rigs-published.jsonl) before it was "
        "diagnosed."
    )


def _targets(content: Plain) -> str:
    """Figures with targets, new and old, and those without."""
    parts = ["## Targets"]
    for title, figures in (
        ("Loud recordings, foreign laws, correlated noise, few readings", content["new"]),
        ("Faint recordings of the first generator", content["faint"]),
    ):
        aimed = [f for f in figures if f["target"] != "none" and f["estimate"]["count"]]
        others = [f for f in figures if f["target"] == "none" and f["estimate"]["count"]]
        absent = [f["name"] for f in figures if not f["estimate"]["count"]]
        missed = sum(f["met"] is False for f in aimed)
        open_ = sum(f["met"] is None for f in aimed)
        parts.append(
            f"### {title}\n\n{len(aimed)} figures have a target: {missed} miss it, {open_} rest on "
            f"too few recordings to say.\n\n{judged(aimed)}\n\nWithout a target:\n\n"
            + table(
                ("figure", "reached [95 %]", "cases"),
                ((f["name"], text(f["estimate"]), f["estimate"]["count"]) for f in others),
            )
            + (f"\n\nNot measured: {'; '.join(absent)}." if absent else "")
        )
    return "\n\n".join(parts)


def _before(rows: Sequence[Plain]) -> str:
    """Whether faint recordings lost anything since the record before."""
    title = "## Faint recordings beside the record before"
    if not rows:
        return f"{title}\n\nNot compared."
    apart = [row for row in rows if not row["fits"]]
    return (
        f"{title}\n\n{len(rows) - len(apart)} of {len(rows)} figures that both records have agree "
        "within their intervals ([proof.md](proof.md); about one in twenty would not by chance). "
        "Those that do not:\n\n"
        + (
            table(
                ("figure", "now", "before"),
                ((row["name"], text(row["now"]), text(row["before"])) for row in apart),
            )
            if apart
            else "none."
        )
    )


def _rivals(rows: Sequence[Plain]) -> str:
    """Detectors on identical files, by library."""
    if not rows:
        return "## What the library adds, and what the search adds\n\nNo opponents took part."
    return (
        "## What the library adds, and what the search adds\n\n"
        "The same regressions with a library of textbook columns, with the project's own library, "
        "and with that library and the project's whitening, on identical files; single effects of "
        "every visibility in the parts *open* and *foreign*, recordings with nothing missing of "
        "the parts *null* (ten families of noise) and *foreign-null*. *Found at 5 %* is at a "
        "threshold that one in twenty of those exceeds; so few recordings decide no rarer level."
        "\n\n"
        + table(
            (
                "generator",
                "detector",
                "false alarms at its defaults",
                "found at its defaults",
                "found at 5 %",
                "named right at its defaults",
                "recordings: nothing, single",
            ),
            (
                (
                    row["generator"],
                    RIVALS.get(row["who"], row["who"]),
                    text(row["alarms"], 2),
                    text(row["found"], 2),
                    text(row["found_tuned"], 2),
                    text(row["named_right"], 2),
                    f"{row['alarms']['count']}, {row['found']['count']}",
                )
                for row in rows
            ),
        )
    )


def _causes(rows: Sequence[Plain]) -> str:
    """Single effects by name."""
    return "## Single effects by name\n\n" + table(
        ("generator", "visibility", "effect", "cases", "named right", "other names given"),
        (
            (
                row["generator"],
                row["visibility"],
                row["cause"].replace("_", " "),
                row["right"]["count"],
                text(row["right"], 2),
                ", ".join(f"{n.replace('_', ' ')} {k}" for n, k in row["false"].items()),
            )
            for row in rows
        ),
    )


def _verdicts(rows: Sequence[Plain]) -> str:
    """Verdicts of every kind of recording."""
    return "## Verdicts\n\n" + table(
        (
            "part",
            "kind",
            "cases",
            *(v.lower().replace("_", " ") for v in VERDICTS),
            "other",
            "named right",
            "false name",
        ),
        (
            (
                row["part"],
                row["kind"],
                row["cases"],
                *(row["said"].get(v, "") for v in VERDICTS),
                sum(n for v, n in row["said"].items() if v not in VERDICTS) or "",
                text(row["right"], 2),
                text(row["false_name"], 2),
            )
            for row in rows
        ),
    )


def _real(board: Plain) -> str:
    """Scoreboard of real recordings."""
    title = "## Real recordings beside it"
    if not board:
        return f"{title}\n\nThe scoreboard was not run: its recordings were absent."
    parts = [
        f"{title}\n\n{board['right']} of {board['judged']} lines of the scoreboard are right "
        f"(`make scoreboard` says what each asks); diagnosed on "
        f"{board['date']}, code `{board['code'][:12]}`."
    ]
    parts.append(
        table(("check over several lines", "right", "asks", "found"), board["over_several"])
    )
    parts += [
        f"### {group}\n\n{table(board['heads'], rows)}" for group, rows in board["groups"].items()
    ]
    return "\n\n".join(parts)


def write_campaign_page(docs: Path) -> Path:
    """Write the page again from the figures, the log and the notes beside it, and the summary.

    Parameters
    ----------
    docs : pathlib.Path
        Folder of ``rigs.json``.
    """
    content = json.loads((docs / f"{NAME}.json").read_text())
    lines = (docs / f"{NAME}-published.jsonl").read_text().splitlines()
    notes = docs / f"{NAME}-notes.md"
    words = notes.read_text().strip() if notes.exists() else ""
    file = docs / f"{NAME}.md"
    file.write_text(campaign_page(content, [json.loads(line) for line in lines], words), "utf-8")
    put_summary(docs.parent / "docs" / "proof.md", content)
    return file
