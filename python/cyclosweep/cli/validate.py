"""`cyclosweep validate`."""

from __future__ import annotations

from typing import Annotated

import typer

from cyclosweep.cli.output import AsJson, print_json, print_tables


def validate(
    as_json: AsJson = False,
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="NAME|FILE", help="Check this drive, not the built-in."),
    ] = None,
    broken_models: Annotated[
        bool,
        typer.Option(
            "--broken-models", help="Add which rows deliberate errors in the model break."
        ),
    ] = False,
) -> None:
    """Compare the library with every published fact of the 87:1 case and with other cases.

    What the paper prints of its own drive is asked only of a drive of 87:1.
    Exit status 1 when a row that counts disagrees and nothing in it explains why, or when a
    deliberate error breaks no row.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.reference.validation import report_json, report_tables, summary

    chosen = None if drive is None else Drive.load(drive)
    report = report_json(chosen, broken_models=broken_models)
    if as_json:
        print_json(report)
    else:
        print_tables(report_tables(chosen, broken_models=broken_models))
        print(summary(report["counts"], chosen))
    raise typer.Exit(0 if report["ok"] else 1)
