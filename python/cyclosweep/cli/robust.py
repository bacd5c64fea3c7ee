"""`cyclosweep robust`."""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

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
from cyclosweep.errors import InputError, naming

if TYPE_CHECKING:
    import polars as pl

    from cyclosweep.design.drive import Drive
    from cyclosweep.sweep.objective import Objective
    from cyclosweep.sweep.stored import StoredStudy


def robust(
    designs: Annotated[
        list[str],
        typer.Argument(
            metavar="DESIGNS...", help="Folder of a sweep, a table of designs, or drive files."
        ),
    ],
    tolerances: Annotated[
        Path, typer.Option("--tolerances", metavar="FILE.toml", help="How far pieces deviate.")
    ],
    minimise: Annotated[
        str | None, typer.Option("--minimise", metavar="EXPR", help="What is to stay small.")
    ] = None,
    maximise: Annotated[
        str | None, typer.Option("--maximise", metavar="EXPR", help="What is to stay great.")
    ] = None,
    limit: Limits = None,
    percentile: Annotated[
        float, typer.Option("--percentile", help="Pieces [%] at least as good as the figure.")
    ] = 95.0,
    candidates: Annotated[
        int, typer.Option("--candidates", min=1, help="Best variants of a sweep that are tried.")
    ] = 100,
    pieces: Annotated[int, typer.Option("--pieces", min=1, help="Pieces of each design.")] = 1024,
    drive: Annotated[
        str | None, typer.Option("--drive", help="Drive that a table's columns change.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of the deviations.")] = 0,
    rows: Rows = 10,
    out: OutTable = None,
    as_json: AsJson = False,
) -> None:
    """Order designs by how good they stay within manufacturing tolerances.

    Of each design so many pieces are evaluated; the figure is the percentile at the bad end. A
    design of which more than 1 % of the pieces cannot be built or miss a limit comes last. The
    limits of a sweep's own study count, too.
    """
    from cyclosweep.explore import robust_choice
    from cyclosweep.sweep.tolerances import Tolerances

    check_out(out, *designs, tolerances)
    spread = Tolerances.from_toml(tolerances)
    with interruptible("nothing was written"), _naming_deviations(tolerances):
        wanted, base, table, study = _designs(designs, minimise, maximise, limit, candidates, drive)
        found = robust_choice(
            table,
            spread,
            wanted,
            percentile=percentile,
            limits=[*(_limits_of(study) if study is not None else ()), *(limit or ())],
            drive=base,
            count=pieces,
            seed=seed,
            **({} if study is None else _settings_of(study)),
        )
    write_out(found, out)
    if as_json:
        print_json(
            {
                "schema": "cyclosweep.robust/1",
                "objective": str(wanted),
                "tolerances": list(spread.names),
                "pieces": pieces,
                "count": found.height,
                "designs": plain_rows(found.head(rows)),
            }
        )
        return
    names = [name for name in ("drive", "variant") if name in found.columns]
    figures = [name for name in found.columns if name.startswith(f"{wanted.column}_")]
    columns = ["rank", "rank_nominal", *names, "share_ok", *dict.fromkeys(figures)]
    print_tables([FrameTable(str(wanted), found.select(columns).head(rows))])
    more = f", the first {rows} shown" if found.height > rows else ""
    written = f"; written: {out}" if out is not None else ""
    print(f"{found.height:,} designs, {pieces:,} pieces of each{more}{written}")


def _designs(
    given: list[str],
    minimise: str | None,
    maximise: str | None,
    limit: list[str] | None,
    candidates: int,
    drive: str | None,
) -> tuple[Objective, Drive | None, pl.DataFrame | list[Drive], StoredStudy | None]:
    """What is to be small or great, the designs as drawn, and the study they are of."""
    from cyclosweep.choose.best import best_variants
    from cyclosweep.design.drive import Drive
    from cyclosweep.sweep.stored import open_study
    from cyclosweep.sweep.table_files import is_table_name, read_table

    wanted = _objective(minimise, maximise)
    first = Path(given[0])
    if first.is_dir() or is_table_name(first):
        if len(given) > 1:
            raise InputError("expected one folder or table, or several drive files")
        if not first.is_dir():
            base = Drive.load(drive or "reference-87")
            return _stated(wanted), base, read_table(first), None
        if drive is not None:
            raise InputError("--drive: not for the folder of a sweep, which has its own")
        stored = open_study(first)
        say_if_unfinished(first)
        objective = wanted or stored.objective
        best = best_variants(first, _stated(objective), limit, rows=candidates)
        if best.table.is_empty():
            raise InputError(f"{first}: no feasible variant within the limits")
        table = best.table.select("variant", *stored.axes)
        return _stated(objective), stored.drive, table, stored
    if drive is not None:
        raise InputError("--drive: only for a table of designs")
    return _stated(wanted), None, [Drive.load(path) for path in given], None


@contextlib.contextmanager
def _naming_deviations(file: Path) -> Iterator[None]:
    """Name the tolerance file where a deviation does not fit the designs."""
    try:
        yield
    except InputError as error:
        if not str(error).startswith("tolerances."):
            raise
        with naming(file):
            raise


def _limits_of(study: StoredStudy) -> list[str]:
    """Conditions of a study's own limits; said on standard error where one cannot be computed."""
    found = []
    for name, (low, high) in study.limits.items():
        if name in study.own_columns:
            print(f"Not counted: the limit of {name}, a column of your own.", file=sys.stderr)
            continue
        found += [f"{name} >= {low!r}"] if math.isfinite(low) else []
        found += [f"{name} <= {high!r}"] if math.isfinite(high) else []
    return found


def _settings_of(study: StoredStudy) -> dict[str, Any]:
    """Loads, model and solver of a study."""
    return {"loads_tn": study.loads_tn, "model": study.model, "solver": study.solver}


def _objective(minimise: str | None, maximise: str | None) -> Objective | None:
    from cyclosweep.sweep.objective import Objective

    if minimise is not None and maximise is not None:
        raise InputError("found --minimise and --maximise, expected one of them")
    if minimise is None and maximise is None:
        return None
    return Objective(minimise or maximise or "", maximise is not None)


def _stated(objective: Objective | None) -> Objective:
    if objective is None:
        raise InputError("no objective, expected --minimise or --maximise")
    return objective
