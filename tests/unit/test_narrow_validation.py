"""The validation in a terminal of 60 columns: no word is cut."""

from __future__ import annotations

import io

import pytest
from rich.console import Console

from cyclosweep.reference.validation import report_tables


@pytest.mark.parametrize("width", [60, 80, 100])
def test_no_word_of_the_validation_is_cut(width: int) -> None:
    shown = io.StringIO()
    console = Console(width=width, file=shown)
    for renderable in report_tables():
        console.print(renderable)
    text = shown.getvalue()
    assert max(len(line) for line in text.splitlines()) <= width
    assert "…" not in text
    assert {"reconstruction", "evidence", "published"} <= {w.strip(",") for w in text.split()}
