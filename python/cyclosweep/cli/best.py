"""`cyclosweep best`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cyclosweep.cli.exploring import check_out, plain_rows, say_if_unfinished
from cyclosweep.cli.frames import FrameTable
from cyclosweep.cli.output import AsJson, interruptible, print_json, print_tables
from cyclosweep.errors import InputError, naming

if TYPE_CHECKING:
    import polars as pl

    from cyclosweep.sweep.stored import StoredStudy

SHOWN = 10
"""Rows printed where no other number is asked for."""


def best(
    study: Annotated[Path, typer.Argument(metavar="STUDY_DIR", help="Folder of a sweep.")],
    pareto: Annotated[
        list[str] | None,
        typer.Option(
            "--pareto", metavar="A,B", help="Front over these; 'max A' for what is to be great."
        ),
    ] = None,
    minimise: Annotated[
        str | None, typer.Option("--minimise", metavar="EXPR", help="Instead of the study's own.")
    ] = None,
    maximise: Annotated[str | None, typer.Option("--maximise", metavar="EXPR")] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option("--limit", metavar="EXPR", help="Such as 'hole_web_mm > 3'; repeatable."),
    ] = None,
    rows: Annotated[int, typer.Option("--rows", min=1, help="Rows shown.")] = SHOWN,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="TABLE", help="Write all columns, .csv, .xlsx or .parquet."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """List a study's best variants by one objective, or its Pareto front over several.

    Objectives and limits are columns or expressions of columns. Infeasible variants do not count.
    `cyclosweep pick STUDY_DIR N` writes the drive file of variant N.
    """
    from cyclosweep.choose.best import best_variants
    from cyclosweep.explore import pareto_front
    from cyclosweep.sweep.stored import open_study
    from cyclosweep.sweep.table_files import write_table

    check_out(out)
    stored = open_study(study)
    say_if_unfinished(study)
    goals = _goals(pareto, minimise, maximise, stored)
    with interruptible("nothing was written"), naming(study):
        if pareto:
            table = pareto_front(study, goals, limit)
            count = f"{table.height:,} variants on the front"
        else:
            found = best_variants(study, goals[0], limit, rows=rows)
            table = found.table
            count = f"{found.within:,} variants within the limits"
            if found.ties > 1:
                count += f"; {found.ties:,} share the best value"
    if out is not None:
        write_table(table, out)
    shown = [each.split(" ", 1)[1] for each in goals]
    columns = list(dict.fromkeys(["variant", *shown, *stored.axes]))
    if as_json:
        content = plain_rows(table.head(rows))
        print_json(
            {
                "schema": "cyclosweep.best/1",
                "study": stored.hash,
                "objectives": goals,
                "count": table.height if pareto else found.within,
                "variants": content,
            }
        )
        return
    if table.is_empty():
        print("no feasible variant within the limits")
        return
    shown_rows = _with_units(table.head(rows).select(columns), stored)
    print_tables([FrameTable(", ".join(goals), shown_rows)])
    more = f", the first {rows} shown" if pareto and table.height > rows else ""
    print(f"{count}{more}" + (f"; written: {out}" if out is not None else ""))


def _goals(
    pareto: list[str] | None, minimise: str | None, maximise: str | None, stored: StoredStudy
) -> list[str]:
    """Objectives as ``min A`` or ``max A``."""
    if sum(given is not None and given != [] for given in (pareto, minimise, maximise)) > 1:
        raise InputError("found two of --pareto, --minimise and --maximise, expected one")
    if pareto:
        goals = split_objectives(pareto)
        if len(goals) < 2:
            raise InputError(f"--pareto: found {pareto[0]!r}, expected two or more, as A,B")
        return goals
    if minimise is not None or maximise is not None:
        return [f"min {minimise}" if minimise is not None else f"max {maximise}"]
    if stored.objective is None:
        raise InputError(
            f"{stored.folder}: the study has no objective, expected --minimise, --maximise or "
            "--pareto"
        )
    return [f"{'max' if stored.objective.maximise else 'min'} {stored.objective.column}"]


def split_objectives(given: list[str]) -> list[str]:
    """Objectives of ``--pareto``, each as ``min A`` or ``max A``."""
    texts = [text.strip() for each in given for text in _split(each)]
    return [text if text.startswith(("min ", "max ")) else f"min {text}" for text in texts]


def _split(text: str) -> list[str]:
    """Parts between the commas that stand in no brackets."""
    parts, depth = [""], 0
    for sign in text:
        depth += (sign == "(") - (sign == ")")
        if sign == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += sign
    return [part for part in parts if part.strip()]


def _with_units(table: pl.DataFrame, stored: StoredStudy) -> pl.DataFrame:
    """The same table with the unit below each name."""
    units = {name: stored.columns.get(name, {}).get("unit", "1") for name in table.columns}
    return table.rename({name: f"{name}\n{unit}" for name, unit in units.items() if unit != "1"})
