"""`cyclosweep report`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.output import interruptible, refuse_output
from cyclosweep.errors import InputError


def report(
    study: Annotated[Path, typer.Argument(metavar="STUDY_DIR", help="Folder of a sweep.")],
    out: Annotated[Path, typer.Option("--out", metavar="REPORT.html", help="File to write.")],
    pareto: Annotated[
        list[str] | None,
        typer.Option(
            "--pareto", metavar="A,B", help="What matters; 'max A' for what is to be great."
        ),
    ] = None,
    limit: Annotated[
        list[str] | None,
        typer.Option("--limit", metavar="EXPR", help="Such as 'hole_web_mm > 3'; repeatable."),
    ] = None,
    variant: Annotated[
        list[int] | None,
        typer.Option("--variant", metavar="N", help="Show this one too; repeatable."),
    ] = None,
    tolerances: Annotated[
        Path | None,
        typer.Option("--tolerances", metavar="TOL.toml", help="How far made pieces deviate."),
    ] = None,
) -> None:
    """Write a study as one page: feasibility, front, what drives what, the best and robust ones.

    The page needs no network and no other file, and stays small whatever the study's size.
    """
    from cyclosweep.cli.best import split_objectives
    from cyclosweep.study_report import report_study
    from cyclosweep.sweep.tolerances import Tolerances

    refuse_output(out)
    if out.suffix.lower() not in (".html", ".htm"):
        raise InputError(f"--out: found {out}, expected a file ending in .html")
    held = None if tolerances is None else Tolerances.from_toml(tolerances)
    with interruptible("nothing was written"):
        report_study(
            study,
            out,
            objectives=split_objectives(pareto or []),
            limits=limit or [],
            variants=variant or [],
            tolerances=held,
        )
    print(f"Written: {out}")
