"""Pieces of the pages that the package writes: one look, no network, no other file."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape
from importlib.resources import files

__all__ = [
    "Table",
    "broken",
    "bullets",
    "definitions",
    "document",
    "paragraph",
    "section",
    "table_html",
]


@dataclass(frozen=True, slots=True)
class Table:
    """Rows of text under a heading.

    Attributes
    ----------
    title, note : str
        Heading, and what a reader should know about it.
    columns : tuple of str
        Column headings with their units.
    rows : tuple of tuple of str
        Cells.
    words : frozenset of int
        Columns that hold text rather than numbers, besides the first.
    lead : frozenset of int
        Rows that matter most.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""
    words: frozenset[int] = frozenset()
    lead: frozenset[int] = frozenset()


WIDEST = 3
"""Most columns of a table that a phone shows side by side; the cells of others stack there."""


def document(title: str, body: str, *, style: str = "", script: str = "") -> str:
    """Whole page with the common look.

    Parameters
    ----------
    title : str
        What the browser shows in its tab; plain text.
    body : str
        HTML.
    style, script : str
        Rules after the common ones, and code at the end.

    Returns
    -------
    str
    """
    common = files("cyclosweep.page").joinpath("style.css").read_text(encoding="utf-8")
    code = f"<script>{script}</script>" if script else ""
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f'<title>{escape(title)}</title><link rel="icon" href="data:,">'
        f"<style>{common}{style}</style></head>"
        f"<body><main>{body}</main>{code}</body></html>\n"
    )


def section(title: str, content: str) -> str:
    """Section with a heading; nothing where there is no content."""
    return f"<section><h2>{escape(title)}</h2>{content}</section>" if content else ""


def paragraph(title: str, text: str) -> str:
    """Section with one paragraph; nothing where there is no text."""
    return section(title, f"<p>{escape(text)}</p>" if text else "")


def bullets(title: str, items: list[str]) -> str:
    """Section with a bulleted list."""
    listed = "".join(f"<li>{escape(item[:1].upper() + item[1:])}</li>" for item in items)
    return section(title, f"<ul>{listed}</ul>" if listed else "")


def definitions(rows: Iterable[tuple[str, str]]) -> str:
    """List of names and what they are; nothing where there are none."""
    listed = "".join(f"<dt>{broken(k)}</dt><dd>{escape(v)}</dd>" for k, v in rows)
    return f"<dl>{listed}</dl>" if listed else ""


def broken(text: str) -> str:
    """Text as HTML that may break after each underscore of a name."""
    return escape(text).replace("_", "_<wbr>")


def table_html(table: Table | None) -> str:
    """Table with its note; nothing where there is none."""
    if table is None:
        return ""

    stacked = ' class="stacked"' if len(table.columns) > WIDEST else ""

    def cell(tag: str, place: int, text: str) -> str:
        kind = ' class="words"' if place in table.words else ""
        if tag == "td" and stacked and place:
            kind += f' data-name="{escape(table.columns[place])}"'
        return f"<{tag}{kind}>{broken(text)}</{tag}>"

    head = "".join(cell("th", k, text) for k, text in enumerate(table.columns))
    rows = "".join(
        ('<tr class="lead">' if place in table.lead else "<tr>")
        + "".join(cell("td", k, text) for k, text in enumerate(row))
        + "</tr>"
        for place, row in enumerate(table.rows)
    )
    note = f'<p class="soft">{escape(table.note)}</p>' if table.note else ""
    return (
        f'<div class="scroll"><table{stacked}><thead><tr>{head}</tr></thead><tbody>{rows}</tbody>'
        f"</table></div>{note}"
    )
