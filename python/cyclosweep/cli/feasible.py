"""`cyclosweep feasible`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.exploring import (
    Limits,
    OutTable,
    check_out,
    plain_rows,
    say_if_unfinished,
    write_out,
)
from cyclosweep.cli.frames import FrameTable
from cyclosweep.cli.output import AsJson, interruptible, print_json, print_tables


def feasible(
    study: Annotated[
        Path, typer.Argument(metavar="STUDY", help="Study file, or folder of a sweep.")
    ],
    limit: Limits = None,
    out: OutTable = None,
    as_json: AsJson = False,
) -> None:
    """Say which ranges of the inputs give feasible designs, and what rules the others out.

    A study file is swept on the way. `--out` has the share of feasible variants for each
    interval of each input.
    """
    from cyclosweep.explore import feasible_ranges
    from cyclosweep.sweep.study import Study

    check_out(out)
    is_file = study.suffix.lower() == ".toml"
    if not is_file:
        say_if_unfinished(study)
    with interruptible("nothing was written"):
        found = feasible_ranges(Study.from_toml(study) if is_file else study, limit)
    write_out(found.intervals, out)
    if as_json:
        print_json(
            {
                "schema": "cyclosweep.feasible/1",
                "rows": found.rows,
                "feasible": found.feasible,
                "inputs": plain_rows(found.inputs),
                "intervals": plain_rows(found.intervals),
                "rules": plain_rows(found.rules),
            }
        )
        return
    tables = [FrameTable("Ranges", found.inputs)]
    if found.rules.height:
        tables.append(FrameTable("No feasible variant has", found.rules))
    print_tables(tables)
    share = found.feasible / max(found.rows, 1)
    written = f"; written: {out}" if out is not None else ""
    print(f"{found.feasible:,} of {found.rows:,} variants are feasible, {share:.1%}{written}")
