"""The table of targets: what was wanted, what was reached, none left out."""

from __future__ import annotations

from collections.abc import Sequence

from cyclosweep_challenge.record.markdown import Plain, table, text

CANNOT_FAIL = "exact aliases called untestable"
"""How figures of earlier records begin that no diagnosis could miss: it lists these aliases under
every recording, whatever it reads. They are counted no longer and shown on no page."""


def _reached(figure: Plain) -> str:
    if figure["met"] is None:
        return "" if figure["target"] == "none" else "too few cases"
    if figure["met"]:
        return "reached"
    return "required only" if figure["met_required"] else "**missed**"


def judged(figures: Sequence[Plain]) -> str:
    """Table of figures beside their targets."""
    return table(
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
            for f in figures
        ),
    )


def target_tables(figures: Sequence[Plain]) -> str:
    """Figures with a target, how many miss it, and the figures without one.

    None is left out but those that no diagnosis could miss.
    """
    counted = [f for f in figures if not f["name"].startswith(CANNOT_FAIL)]
    aimed = [f for f in counted if f["target"] != "none"]
    others = [f for f in counted if f["target"] == "none"]
    missed = sum(f["met"] is False for f in aimed)
    failed = sum(f["met_required"] is False for f in aimed)
    return (
        f"{len(aimed)} figures have a target, {missed} miss it, {failed} miss what is required. "
        "None is left out, except those that no diagnosis could miss "
        f"(“{CANNOT_FAIL}”: it lists them under every recording).\n\n"
        + judged(aimed)
        + "\n\nBeside them, without a target:\n\n"
        + table(
            ("figure", "reached [95 %]", "cases"),
            ((f["name"], text(f["estimate"]), f["estimate"]["count"]) for f in others),
        )
    )
