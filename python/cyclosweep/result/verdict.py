"""The verdicts of a diagnosis."""

from typing import Literal

Verdict = Literal[
    "IDENTIFIED",
    "AMBIGUOUS",
    "MOSTLY_EXPLAINED",
    "UNKNOWN_PHYSICS",
    "NOTHING_MISSING",
    "INSUFFICIENT_DATA",
    "DATA_FAULT",
]
"""What a diagnosis concludes; docs/diagnosis.md says what each verdict means."""
