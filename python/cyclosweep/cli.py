"""The command line: what each command takes and prints; the work is done elsewhere."""

from __future__ import annotations

import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

import typer

from cyclosweep import __version__
from cyclosweep.errors import DesignError, InputError, SweepError

if TYPE_CHECKING:
    from rich.console import RenderableType

__all__ = ["main"]

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    help="Sweep, validate and diagnose the torsional compliance of cycloidal gear drives.",
)

AsJson = Annotated[bool, typer.Option("--json", help="Print one JSON object, nothing else.")]
StudyFile = Annotated[Path, typer.Argument(metavar="STUDY.toml", help="Study file.")]
OutFolder = Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder of the dataset.")]


def _version(wanted: bool) -> None:
    if wanted:
        print(f"cyclosweep {__version__}")
        raise typer.Exit


@app.callback()
def _root(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    """Sweep, validate and diagnose the torsional compliance of cycloidal gear drives."""


@app.command()
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
    from cyclosweep.drive import Drive
    from cyclosweep.reference.validation import report_json, report_tables

    chosen = None if drive is None else Drive.load(drive)
    report = report_json(chosen)
    if as_json:
        _print_json(report)
    else:
        _print(report_tables(chosen))
        decided = [fact for fact in report["facts"] if fact["ok"] is not None]
        met = sum(fact["ok"] for fact in decided)
        print(
            f"{met} of {len(decided)} facts met; "
            f"{len(report['facts']) - len(decided)} rows only compare or are beyond the model"
        )
    raise typer.Exit(0 if report["ok"] else 1)


@app.command()
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
    as_json: AsJson = False,
) -> None:
    """Sweep a study to a folder of Parquet parts; killed, the same command goes on from there."""
    from cyclosweep.shards import sink

    with _interruptible():
        summary = sink(
            _study(study, rows),
            out,
            fresh=fresh,
            workers=workers,
            engine=engine,
            scheduler=scheduler,
        )
    if as_json:
        _print_json({"schema": "cyclosweep.summary/1", "folder": str(out), **summary.to_json()})
    else:
        _print(summary.renderables())
        print(f"{summary.rows:,} variants in {out}")


@app.command()
def shard(
    study: StudyFile,
    out: OutFolder,
    index: Annotated[int, typer.Option("--index", min=0, help="Number of this task, from 0.")],
    of: Annotated[int, typer.Option("--of", min=1, help="How many tasks there are.")],
    as_json: AsJson = False,
) -> None:
    """Compute one task of a batch array; any mix of tasks gives the same dataset."""
    from cyclosweep.shards import shard as run

    with _interruptible():
        summary = run(_study(study, None), out, index=index, of=of)
    if as_json:
        _print_json({"schema": "cyclosweep.summary/1", "folder": str(out), **summary.to_json()})
    else:
        print(f"task {index} of {of}: {summary.rows:,} variants in {out}")


@contextlib.contextmanager
def _interruptible() -> Iterator[None]:
    """Say in one line what Ctrl-C leaves behind; typer would end without a word."""
    try:
        yield
    except KeyboardInterrupt:
        _fail("interrupted; what is whole stays, the same command goes on from there", 1)


def _study(path: Path, rows: int | None) -> Any:
    import dataclasses

    from cyclosweep.study import Study

    study = Study.from_toml(path)
    return study if rows is None else dataclasses.replace(study, space=study.space[:rows])


def _print(renderables: Iterable[RenderableType]) -> None:
    from rich.console import Console

    console = Console()
    for renderable in renderables:
        console.print(renderable)


def _print_json(value: dict[str, Any]) -> None:
    print(json.dumps(value, indent=1))


def main() -> None:
    """Run the command line; every error is one line and an exit status."""
    try:
        app()
    except (InputError, DesignError) as error:
        _fail(error, 2)
    except SweepError as error:
        _fail(error, 1)
    except BrokenPipeError:
        # Whoever read our output has seen enough.
        sys.stderr.close()
        sys.exit(1)
    except OSError as error:
        where = f"{error.filename}: " if error.filename else ""
        _fail(f"{where}{error.strerror or error}", 1)


def _fail(error: object, status: int) -> NoReturn:
    print(f"cyclosweep: {error}", file=sys.stderr)
    sys.exit(status)
