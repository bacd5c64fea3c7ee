"""`cyclosweep sweep` and `cyclosweep shard`."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cyclosweep.cli.output import (
    AsJson,
    folder_named,
    interruptible,
    print_json,
    print_tables,
    refuse_folder,
)
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from cyclosweep.sweep.study import Study

LEFT = "what is whole stays, the same command goes on from there"

StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="Study file.")]
OutFolder = Annotated[
    Path,
    typer.Option("--out", parser=folder_named, metavar="DIR", help="Folder of the dataset."),
]


def sweep(
    study: StudyFile,
    out: OutFolder,
    rows: Annotated[
        int | None, typer.Option("--rows", min=1, help="Only the first N variants.")
    ] = None,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Delete what an earlier sweep left in the folder.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option("--workers", min=1, help="Parts computed at a time.")
    ] = None,
    engine: Annotated[
        Literal["threads", "processes", "dask"], typer.Option(help="Where parts are computed.")
    ] = "threads",
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="Address of a running Dask scheduler.")
    ] = None,
    yes: Annotated[
        bool, typer.Option("--yes", help="Begin even where the disk has no room for all of it.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Sweep a study to a folder of Parquet parts; killed, the same command goes on from there."""
    from cyclosweep.sweep.executors import executor_of
    from cyclosweep.sweep.shards import sink

    refuse_folder(out)
    executor_of(engine, workers=workers, scheduler=scheduler)
    with interruptible(LEFT):
        swept = _study(study, rows)
        _say_size(swept, out, fresh=fresh, yes=yes)
        summary = sink(
            swept,
            out,
            fresh=fresh,
            workers=workers,
            engine=engine,
            scheduler=scheduler,
        )
    if as_json:
        print_json({"schema": "cyclosweep.summary/1", "folder": str(out), **summary.to_json()})
    else:
        print_tables(summary.renderables())
        print(f"{summary.rows:,} variants in {out}")


def shard(
    study: StudyFile,
    out: OutFolder,
    index: Annotated[int, typer.Option("--index", min=0, help="Number of this task, from 0.")],
    of: Annotated[int, typer.Option("--of", min=1, help="How many tasks there are.")],
    as_json: AsJson = False,
) -> None:
    """Compute one task of a batch array; any mix of tasks gives the same dataset."""
    from cyclosweep.sweep.dataset import dataset_of
    from cyclosweep.sweep.shards import shard as run

    refuse_folder(out)
    with interruptible(LEFT):
        swept = _study(study, None)
        summary = run(swept, out, index=index, of=of)
    if index >= (parts := dataset_of(swept, out).part_count):
        print(
            f"cyclosweep: the study has {parts:,} part{'s' * (parts != 1)}: from task {parts:,} on "
            "there is nothing to do",
            file=sys.stderr,
        )
    if as_json:
        print_json({"schema": "cyclosweep.summary/1", "folder": str(out), **summary.to_json()})
    else:
        print(f"task {index} of {of}: {summary.rows:,} variants in {out}")


def _study(path: Path, rows: int | None) -> Study:
    from cyclosweep.sweep.study import Study

    study = Study.from_toml(path)
    if rows is None:
        return study
    if rows > len(study.space):
        print(
            f"cyclosweep: --rows: {rows:,} asked for, {path} has {len(study.space):,}",
            file=sys.stderr,
        )
    return dataclasses.replace(study, space=study.space[:rows])


def _say_size(study: Study, out: Path, *, fresh: bool, yes: bool) -> None:
    """Say how much a sweep has to do; refuse, or ask, where the disk has no room for it."""
    from cyclosweep.sweep.dataset import dataset_of
    from cyclosweep.sweep.size import estimate, rows_left

    dataset_of(study, out).check(resume=True, fresh=fresh)
    size = estimate(study, out, None if fresh else rows_left(study, out))
    if size.fits or yes:
        print(f"{size} in {out}", file=sys.stderr)
        return
    refusal = f"{out}: no room for {size}; --rows takes fewer variants, --yes begins all the same"
    if not (sys.stdin.isatty() and sys.stderr.isatty()):
        raise InputError(refusal)
    if not typer.confirm(f"{out}: no room for {size}. Begin all the same?", err=True):
        raise InputError(refusal)
