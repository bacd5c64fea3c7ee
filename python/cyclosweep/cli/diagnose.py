"""`cyclosweep simulate` and `cyclosweep diagnose`."""

from __future__ import annotations

import dataclasses
import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cyclosweep.atomic import unfinished, write_text
from cyclosweep.cli.output import AsJson, fail, interruptible, print_json
from cyclosweep.errors import DesignError, InputError

if TYPE_CHECKING:
    from cyclosweep.design.drive import Drive
    from cyclosweep.recording import Recording
    from cyclosweep.simulation.simulate import Model


def simulate(
    model: Annotated[
        str, typer.Argument(metavar="MODEL", help="Built-in drive, drive .toml or model.json.")
    ],
    program: Annotated[Path, typer.Argument(metavar="PROGRAM.csv", help="Load programme.")],
    out: Annotated[Path, typer.Option("--out", metavar="OUT.csv", help="File to write.")],
    predict: Annotated[
        Literal["angle", "torque"], typer.Option(help="What to predict from the other.")
    ] = "angle",
) -> None:
    """Predict the twist of a load programme by the published or by a repaired model."""
    from cyclosweep.recording import Recording
    from cyclosweep.recording.reading import stem
    from cyclosweep.simulation.simulate import simulate as run

    inputs = [program, program.with_name(f"{stem(program)}.toml"), Path(model)]
    if any(path.exists() and out.exists() and path.samefile(out) for path in inputs):
        raise InputError(f"--out: found {out}, which is read, expected another file")
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"--out: found {out}, expected a file in a folder that exists")
    chosen = _model(model)
    programme = Recording.read(program)
    if hasattr(chosen, "side") and not program.with_name(f"{stem(program)}.toml").exists():
        programme = dataclasses.replace(programme, side=chosen.side)
    table = run(chosen, programme, predict).to_frame()
    try:
        with unfinished(out) as file:
            table.write_csv(file)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)


def _model(name: str) -> Model | Drive:
    from cyclosweep.design.drive import Drive
    from cyclosweep.simulation.simulate import Model

    return Model.from_json(name) if name.endswith(".json") else Drive.load(name)


def diagnose(
    recordings: Annotated[
        list[Path], typer.Argument(metavar="RECORDING.csv...", help="Measured torque and twist.")
    ],
    out: Annotated[Path, typer.Option("--out", metavar="DIR", help="Folder of the results.")],
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="NAME|FILE", help="The drive, if not in the metadata."),
    ] = None,
    meta: Annotated[
        Path | None, typer.Option("--meta", metavar="META.toml", help="How to read the files.")
    ] = None,
    tolerance: Annotated[
        float | None,
        typer.Option("--tolerance", metavar="DEG", help="Size below which nothing matters."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of every random draw.")] = 0,
    without: Annotated[
        list[str] | None,
        typer.Option("--without", metavar="EFFECT", help="Do not consider this effect."),
    ] = None,
    png: Annotated[bool, typer.Option("--png", help="Write the report's pictures too.")] = False,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick", help="Verdict, effects and model alone: no report, self-check or held-out."
        ),
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Find the physics that the simulation leaves out of a recording.

    Writes diagnosis.json, model.json and report.html: into DIR for one recording, into
    DIR/<stem>/ each for several. Exit status 0 whatever the verdict, 2 when a file is bad input.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.recording.reading import stem

    if tolerance is not None and not tolerance > 0:
        raise InputError(f"tolerance: found {tolerance:g}, expected degrees above zero")
    known = None if drive is None else Drive.load(drive)
    folders = [out / stem(path) if len(recordings) > 1 else out for path in recordings]
    if len(set(folders)) < len(folders):
        raise InputError("recordings: two of one name, expected a folder for each in DIR")
    contents: dict[str, Any] = {}
    bad = 0
    for path, folder in zip(recordings, folders, strict=True):
        try:
            with interruptible(f"{len(contents)} of {len(recordings)} recordings diagnosed"):
                contents[stem(path)] = _diagnose_one(
                    path,
                    folder,
                    meta,
                    png=png,
                    quick=quick,
                    quiet=as_json,
                    drive=known,
                    tolerance_deg=tolerance,
                    seed=seed,
                    without=without or (),
                )
        except (InputError, DesignError) as error:
            if len(recordings) == 1:
                raise
            bad += 1
            print(f"cyclosweep: {error}", file=sys.stderr)
    if as_json:
        print_json(
            next(iter(contents.values())) if len(recordings) == 1 else {"recordings": contents}
        )
    if bad:
        fail(f"{bad} of {len(recordings)} recordings could not be read", 2)


def _diagnose_one(
    path: Path,
    folder: Path,
    meta: Path | None,
    *,
    png: bool,
    quick: bool,
    quiet: bool,
    **options: Any,
) -> dict[str, Any]:
    from cyclosweep.diagnosis import diagnose as run
    from cyclosweep.recording import Recording

    recording: Recording = Recording.read(path, meta)
    with _saying(recording.name) as say:
        found = run(recording, progress=say, full=not quick, **options)
        if quick:
            folder.mkdir(parents=True, exist_ok=True)
            write_text(folder / "diagnosis.json", found.to_json())
            if found.model is not None:
                write_text(folder / "model.json", found.model.to_json())
        else:
            say("writing the report")
            found.write(folder)
        if png:
            found.report(folder / "pictures")
    if not quiet:
        from cyclosweep.report import print_summary

        print_summary(found.report_data())
        print(f"Report: {folder / 'report.html'}" if not quick else f"Written: {folder}")
    content: dict[str, Any] = json.loads(found.to_json())
    return content


@contextmanager
def _saying(name: str) -> Iterator[Callable[[str], None]]:
    """Show the step at work on standard error when that is a terminal."""
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console

    with Console(stderr=True).status(name) as status:
        yield lambda text: status.update(f"{name}: {text}")
