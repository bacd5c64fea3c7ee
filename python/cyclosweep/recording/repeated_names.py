"""Rows that repeat the names or units of the columns, as files put together have them."""

import re
from dataclasses import replace

from cyclosweep.recording.csv_text import CsvText

LISTED = 3
"""Lines that are listed one by one."""


def without_repeated_names(text: CsvText) -> CsvText:
    """Turn lines that repeat names or units of the columns into comments, which are passed over.

    The text keeps its lines, so that messages name those of the file.

    Parameters
    ----------
    text : CsvText
        The text; a note is added to its notes.

    Returns
    -------
    CsvText
        The same where nothing is repeated.
    """
    above, body = text.content[: text.start], text.content[text.start :]
    lines = [line.strip() for line in above.split(b"\n")[text.line - 1 : text.body_line]]
    # Where blanks divide the cells, those below the names have become one tabulator each.
    lines += [re.sub(rb"[ \t]+", b"\t", line) for line in lines if text.separator == "\t"]
    found: list[int] = []
    for line in dict.fromkeys(lines):
        if not line or line.startswith(b"#") or line not in body:
            continue
        repeated = re.compile(rb"(?m)^" + re.escape(line) + rb"(?=[ \t]*\r?$)")
        found += [body.count(b"\n", 0, place.start()) for place in repeated.finditer(body)]
        body = repeated.sub(lambda match: b"#" + match[0], body)
    if not found:
        return text
    numbers = [text.body_line + 1 + count for count in sorted(found)]
    named = ", ".join(map(str, numbers[:LISTED]))
    more = f" and {len(numbers) - LISTED} more" if len(numbers) > LISTED else ""
    text.notes.append(
        f"Names or units of the columns stand again in line{'s' * (len(numbers) > 1)} {named}"
        f"{more}: passed over."
    )
    return replace(text, content=above + body)
