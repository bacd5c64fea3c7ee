"""Frames as tables of a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import polars as pl
    from rich.table import Table

__all__ = ["titled"]


def titled(title: str, frame: pl.DataFrame) -> Table:
    """Table of a frame, numbers to five digits.

    Parameters
    ----------
    title : str
        What stands above it.
    frame : polars.DataFrame
        Rows and columns.

    Returns
    -------
    rich.table.Table
    """
    from rich import box
    from rich.table import Table

    table = Table(title=title, title_justify="left", box=box.SIMPLE)
    rows = [[_text(value) for value in row] for row in frame.iter_rows()]
    for k, (name, dtype) in enumerate(frame.schema.items()):
        if dtype.is_numeric():  # headings are broken where there is no room, numbers never
            longest = max((len(row[k]) for row in rows), default=1)
            table.add_column(name, justify="right", overflow="fold", min_width=longest)
        else:
            table.add_column(name, overflow="fold")
    for row in rows:
        table.add_row(*row)
    return table


def _text(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
