"""`cyclosweep new`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.choose.templates import Kind, template
from cyclosweep.cli.output import refuse_drive_name
from cyclosweep.errors import InputError


def new(
    kind: Annotated[Kind, typer.Argument(help="What to begin.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE.toml", help="File to write.")
    ] = None,
) -> None:
    """Print or write a commented file to begin with: a drive, a study, a recording's, an event.

    It is valid as it is. A file that exists is not overwritten.
    """
    from cyclosweep.atomic import write_text

    text = template(kind)
    if out is None:
        print(text, end="")
        return
    if kind == "drive":
        refuse_drive_name(out)
    if out.exists():
        raise InputError(f"{out}: exists already, expected the name of a new file")
    write_text(out, text)
    print(f"Written: {out}")
