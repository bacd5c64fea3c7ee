"""`cyclosweep validate`."""

from __future__ import annotations

from collections import Counter
from typing import Annotated

import typer

from cyclosweep.cli.output import AsJson, print_json, print_tables


def validate(
    as_json: AsJson = False,
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="NAME|FILE", help="Check this drive, not the built-in."),
    ] = None,
) -> None:
    """Compare the library with every published fact of the 87:1 case and with other cases.

    Exit status 1 when a fact is not met; facts that the model cannot compute do not count.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.reference.validation import report_json, report_tables

    chosen = None if drive is None else Drive.load(drive)
    report = report_json(chosen)
    if as_json:
        print_json(report)
    else:
        print_tables(report_tables(chosen))
        decided = [fact for fact in report["facts"] if fact["ok"] is not None]
        met = sum(fact["ok"] for fact in decided)
        marks = Counter(fact["mark"] for fact in decided)
        print(
            f"{met} of {len(decided)} facts met, by what they rest on: "
            + ", ".join(f"{mark} {count}" for mark, count in marks.items())
            + f"; {len(report['facts']) - len(decided)} rows only compare or are beyond the model. "
            "What rests on assumed dimensions was chosen to fit: it is no evidence."
        )
    raise typer.Exit(0 if report["ok"] else 1)
