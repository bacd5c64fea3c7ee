"""The figures of a campaign in plain words, for docs/proof.md."""

from __future__ import annotations

from pathlib import Path

from cyclosweep_challenge.record.markdown import Plain, table, text

BEGIN, END = "<!-- rigs: begin -->", "<!-- rigs: end -->"
"""Marks in docs/proof.md between which the summary stands."""
WORDS = {
    "C8: dominant effect named": "loud: the largest effect has its right name",
    "C8, friction of the library's family: every effect above a hundredth named, nothing false": (
        "loud, friction of a kind that the library holds: everything above a hundredth of it is "
        "named, nothing false"
    ),
    "C8, friction of another family: dominant effect and those beyond its model error named, "
    "nothing false": (
        "loud, friction of another kind: it is named, and what exceeds the error of its law, "
        "nothing false"
    ),
    "C8: mismatch removed on an unseen programme over what the own law removes, median": (
        "loud: mismatch that the repair removes on a programme not seen, over what the true law "
        "removes, median"
    ),
    "cause deleted from the library: false name": "the cause is not in the library: a false name",
    "nothing missing, autocorrelation 0.9 to 0.99: false alarms": (
        "nothing missing, noise of autocorrelation 0.9 to 0.99: alarms"
    ),
    "nothing missing, ten families of noise together: false alarms": (
        "nothing missing, ten families of noise together: alarms"
    ),
    "C9: verdict right or INSUFFICIENT_DATA": (
        "a dozen to sixty readings by hand: right, or the readings cannot tell"
    ),
    "C9: false names": "a dozen to sixty readings by hand: a false name",
}
"""Figures in plain words; the others keep their names."""


def summary(content: Plain) -> str:
    """Table of what was asked and found, and what of the faint recordings is as before.

    Parameters
    ----------
    content : mapping
        What ``rigs.json`` holds.
    """
    aimed = [f for f in content["new"] if f["target"] != "none" and f["estimate"]["count"]]
    rows = [
        (
            WORDS.get(f["name"], f["name"]),
            text(f["estimate"], 2),
            f["estimate"]["count"],
            f"{f['target']}, {_judged(f['met'])}",
        )
        for f in aimed
    ]
    about, before = content["record"], content["before"]
    done = sum(content["done"].values())
    missed = sum(f["met"] is False for f in aimed)
    fit = sum(row["fits"] for row in before)
    return (
        f"Seed {about['seed']}, {done:,} recordings, code `{about['diagnosis'][:16]}…`, commit "
        f"`{about['commit'][:7]}`. Of {len(aimed)} figures with a target {missed} miss it.\n\n"
        + table(("question", "answer [95 %]", "recordings", "target"), rows)
        + f"\n\nOf {len(before)} figures of faint recordings that this record and the first one "
        f"both have, {fit} agree within their intervals."
    )


def _judged(met: bool | None) -> str:
    """Whether a target was reached, in a word or two."""
    return "too few to say" if met is None else "reached" if met else "missed"


def put_summary(page: Path, content: Plain) -> None:
    """Replace what stands between the marks of a page; a page without marks is left alone.

    Parameters
    ----------
    page : pathlib.Path
        ``docs/proof.md``.
    content : mapping
        What ``rigs.json`` holds.
    """
    words = page.read_text("utf-8") if page.is_file() else ""
    if BEGIN not in words or END not in words:
        return
    start, rest = words.split(BEGIN, 1)
    end = rest.split(END, 1)[1]
    page.write_text(f"{start}{BEGIN}\n\n{summary(content)}\n\n{END}{end}", "utf-8")
