"""Options and tables that the commands for exploring a study share."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cyclosweep.cli.output import refuse_output
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    import polars as pl

__all__ = [
    "Limits",
    "OutTable",
    "Rows",
    "check_out",
    "plain_rows",
    "say_if_unfinished",
    "write_out",
]

Limits = Annotated[
    list[str] | None,
    typer.Option("--limit", metavar="EXPR", help="Such as 'hole_web_mm > 3'; repeatable."),
]
OutTable = Annotated[
    Path | None,
    typer.Option("--out", metavar="TABLE", help="Write the table, .csv, .xlsx or .parquet."),
]
Rows = Annotated[int, typer.Option("--rows", min=1, help="Rows shown.")]


def check_out(out: Path | None, *sources: str | Path) -> None:
    """Refuse a table that cannot be written, or is one of those that are read, before any work."""
    from cyclosweep.sweep.table_files import writable

    if out is not None:
        writable(out)
        refuse_output(out, *sources)


def say_if_unfinished(folder: Path) -> None:
    """Say on standard error that a study lacks variants; nothing where its folder cannot tell."""
    from cyclosweep.sweep.stored import open_study

    try:
        stored = open_study(folder)
    except InputError:
        return  # no manifest: parts of others are read all the same
    if not stored.complete:
        print(
            f"cyclosweep: {folder}: the study is unfinished, the answer is of "
            f"{stored.rows:,} of {stored.variants:,} variants",
            file=sys.stderr,
        )


def write_out(table: pl.DataFrame, out: Path | None) -> None:
    """Write a table whole or not at all, and say so."""
    from cyclosweep.sweep.table_files import write_table

    if out is not None:
        write_table(table, out)


def plain_rows(table: pl.DataFrame) -> list[dict[str, Any]]:
    """Rows as plain JSON values; what is no finite number is null."""
    return [{name: _plain(value) for name, value in row.items()} for row in table.to_dicts()]


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
