"""Table of the laws and where they are published, in Markdown."""

from __future__ import annotations

from cyclosweep_challenge.second_generator.laws import strangers
from cyclosweep_challenge.second_generator.laws.catalogue import LAWS
from cyclosweep_challenge.second_generator.laws.law import Law

RULE = "----------"
"""Underline of the heading of references in a docstring."""


def citation(law: Law) -> str:
    """Where a law is published, in one line: a docstring's references, or the text as it is."""
    return " ".join(law.source.rpartition(RULE)[2].split())


def law_table() -> str:
    """Laws of every effect, one a line."""
    lines = ["| effect | law | published in |", "|---|---|---|"]
    lines += [f"| `{law.effect}` | {law.name} | {citation(law)} |" for law in LAWS]
    return "\n".join(lines)


def stranger_table() -> str:
    """Causes outside the vocabulary, one a line."""
    lines = ["| cause | what it is |", "|---|---|"]
    lines += [f"| `{law.effect}` | {' '.join(law.source.split())} |" for law in strangers.LAWS]
    return "\n".join(lines)
