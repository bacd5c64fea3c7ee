"""`cyclosweep nearest`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.exploring import (
    Limits,
    OutTable,
    Rows,
    check_out,
    plain_rows,
    say_if_unfinished,
    write_out,
)
from cyclosweep.cli.frames import FrameTable
from cyclosweep.cli.output import AsJson, interruptible, print_json, print_tables
from cyclosweep.errors import InputError


def nearest(
    study: Annotated[Path, typer.Argument(metavar="STUDY_DIR", help="Folder of a sweep.")],
    target: Annotated[
        list[str],
        typer.Option("--target", metavar="EXPR=VALUE", help="What is wanted; repeatable."),
    ],
    limit: Limits = None,
    rows: Rows = 10,
    out: OutTable = None,
    as_json: AsJson = False,
) -> None:
    """List the feasible variants that come nearest to wanted values.

    Distances are in standard deviations of each column. `cyclosweep pick STUDY_DIR N` writes the
    drive file of variant N.
    """
    from cyclosweep.explore import nearest_variants
    from cyclosweep.sweep.stored import open_study

    check_out(out)
    stored = open_study(study)
    say_if_unfinished(study)
    wanted = dict(_wanted(text) for text in target)
    with interruptible("nothing was written"):
        found = nearest_variants(study, wanted, count=rows, limits=limit)
    write_out(found, out)
    if as_json:
        print_json(
            {
                "schema": "cyclosweep.nearest/1",
                "study": stored.hash,
                "target": wanted,
                "variants": plain_rows(found),
            }
        )
        return
    if found.is_empty():
        print("no feasible variant within the limits")
        return
    known = [name for name in wanted if name in found.columns]
    columns = dict.fromkeys(["variant", "distance", *known, *stored.axes])
    print_tables([FrameTable("Nearest variants", found.select(*columns))])
    if out is not None:
        print(f"written: {out}")


def _wanted(text: str) -> tuple[str, float]:
    name, _, value = text.rpartition("=")
    try:
        return name.strip(), float(value)
    except ValueError:
        raise InputError(
            f"--target: found {text!r}, expected a column and its value, as eccentricity_mm=0.6"
        ) from None
