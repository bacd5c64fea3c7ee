"""Tables and estimates of the page of record."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

Plain = Mapping[str, Any]


def table(heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Markdown table."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    lines += ["| " + " | ".join(str(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def text(e: Plain | None, digits: int = 3) -> str:
    """Estimate with its interval, or a dash."""
    if not e or not e["count"] or e["value"] is None:
        return "–"
    if e["low"] is None or e["high"] is None:
        return f"{e['value']:.{digits}g}"
    return f"{e['value']:.{digits}g} [{e['low']:.{digits}g}, {e['high']:.{digits}g}]"
