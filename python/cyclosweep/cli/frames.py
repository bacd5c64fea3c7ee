"""Frames as tables of a terminal."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    import polars as pl
    from rich.console import Console, ConsoleOptions
    from rich.table import Table

__all__ = ["FrameTable"]

HEADING = 16
"""Width to which a heading is broken at its underscores and spaces, in signs."""
TEXT = 24
"""Width above which a column of words is broken, in signs."""
BETWEEN = 3
"""Signs between two columns."""


@dataclass(frozen=True)
class FrameTable:
    """A frame that rich prints as wide as there is room, numbers to five digits.

    Columns beyond it follow below, each time after the first column. Headings are broken at
    underscores and spaces alone, and numbers never.

    Parameters
    ----------
    title : str
        What stands above it.
    frame : polars.DataFrame
        Rows and columns.
    """

    title: str
    frame: pl.DataFrame

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Table]:
        """Tables, one below the other, that are no wider than the console."""
        columns = [_Column.of(self.frame, name) for name in self.frame.columns]
        for number, block in enumerate(_blocks(columns, options.max_width)):
            yield self._table(block, self.title if number == 0 else None)

    def _table(self, columns: Sequence[_Column], title: str | None) -> Table:
        """Table of some of the columns."""
        from rich import box
        from rich.table import Table

        table = Table(title=title, title_justify="left", box=box.SIMPLE)
        for column in columns:
            table.add_column(
                column.heading,
                justify="right" if column.numeric else "left",
                overflow="fold",
                min_width=column.width,
            )
        for row in zip(*(column.cells for column in columns), strict=True):
            table.add_row(*row)
        return table


@dataclass(frozen=True)
class _Column:
    """Heading and cells of a column, and the width below which a number or a word is broken."""

    heading: str
    cells: tuple[str, ...]
    numeric: bool
    width: int

    @classmethod
    def of(cls, frame: pl.DataFrame, name: str) -> _Column:
        """Column of a frame."""
        cells = tuple(_text(value) for value in frame[name])
        numeric = frame.schema[name].is_numeric()
        heading = "\n".join(
            line for part in name.split("\n") for line in _broken_at_underscores(part)
        )
        longest = max((len(cell) for cell in cells), default=1)
        shown = longest if numeric else min(longest, TEXT)
        width = max(shown, *(len(line) for line in heading.split("\n")))
        return cls(heading, cells, numeric, width)


def _blocks(columns: Sequence[_Column], room: int) -> Iterator[list[_Column]]:
    """Columns that stand side by side; each block begins with the first column."""
    first, *others = columns
    margin = 1 + BETWEEN + first.width
    block, taken = [first], margin
    for column in others:
        if len(block) > 1 and taken + BETWEEN + column.width > room:
            yield block
            block, taken = [first], margin
        block.append(column)
        taken += BETWEEN + column.width
    yield block


def _broken_at_underscores(name: str) -> list[str]:
    """Lines of a heading; a word that is longer than a line stays whole."""
    lines = textwrap.wrap(
        name.replace("_", "_ "), HEADING, break_long_words=False, break_on_hyphens=False
    )
    return [line.replace("_ ", "_") for line in lines] or [""]


def _text(value: object) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.5g}" if isinstance(value, float) else str(value)
