"""How the package's objects look in a notebook: a title and a small table in the page's colours."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape

__all__ = ["html_table"]

# A page without a doctype gives tables the browser's own black and size.
_INHERITED = "color:inherit;font-size:inherit"
_CELL = f"{_INHERITED};padding:0.1em 1.2em 0.1em 0;border:none;text-align:left;background:none"


def html_table(title: str, rows: Mapping[str, object], note: str = "") -> str:
    """HTML of a titled table of two columns, for ``_repr_html_``.

    No colour of its own: text and lines take those of the notebook, light or dark.

    Parameters
    ----------
    title : str
        First line, in bold.
    rows : mapping of str to object
        Name and value of each row; a row without a value (None or an empty text) is left out.
    note : str
        A line below the table.

    Returns
    -------
    str

    Examples
    --------
    >>> "<b>Drive a&lt;b</b>" in html_table("Drive a<b", {"ratio": 87, "shaft": None})
    True
    """
    body = "".join(
        f'<tr style="{_INHERITED};background:none">'
        f'<td style="{_CELL};opacity:0.7">{escape(name)}</td>'
        f'<td style="{_CELL}">{escape(str(value))}</td></tr>'
        for name, value in rows.items()
        if value is not None and value != ""
    )
    below = f'<div style="margin-top:0.3em">{escape(note)}</div>' if note else ""
    return (
        '<div style="color:inherit;line-height:1.35;max-width:60em">'
        f'<div style="border-bottom:1px solid currentColor;margin-bottom:0.3em">'
        f"<b>{escape(title)}</b></div>"
        f'<table style="{_INHERITED};border-collapse:collapse;margin:0">{body}</table>'
        f"{below}</div>"
    )
