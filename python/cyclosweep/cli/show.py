"""`cyclosweep show`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.exploring import check_out
from cyclosweep.cli.output import AsJson, print_json, print_tables


def show(
    drives: Annotated[
        list[str], typer.Argument(metavar="DRIVE...", help="Built-in drives or drive files.")
    ],
    everything: Annotated[
        bool, typer.Option("--all", help="Of several drives, inputs that agree too.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="TABLE", help="Write the numbers, .csv, .xlsx or .parquet."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show a drive's numbers, its compliance by parts, and what to be careful about.

    Several drives stand side by side. A drive that gives the numbers of the component model is
    computed by both models. Exit status 2 where one of them cannot be built.
    """
    from cyclosweep.choose.comparison import compare
    from cyclosweep.choose.comparison_text import renderables
    from cyclosweep.sweep.table_files import write_table

    check_out(out)
    found = compare(drives)
    if out is not None:
        write_table(found.table, out)
    if as_json:
        print_json(json.loads(found.to_json()))
    else:
        print_tables(renderables(found, everything=everything))
        if out is not None:
            print(f"Written: {out}")
    if any(remark.level == "error" for each in found.figures for remark in each.remarks):
        raise typer.Exit(2)
