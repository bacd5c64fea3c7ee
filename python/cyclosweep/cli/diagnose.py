"""`cyclosweep diagnose`."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cyclosweep.atomic import write_text
from cyclosweep.cli.output import AsJson, fail, interruptible, print_json, refuse_file
from cyclosweep.errors import DesignError, InputError

if TYPE_CHECKING:
    from cyclosweep.diagnosis import Diagnosis


@dataclass(frozen=True)
class _Job:
    """How every recording of one command is read, diagnosed and written.

    Attributes
    ----------
    meta : Path or None
        How to read the files.
    png, quick, quiet : bool
        Write pictures; leave out report and proof; print nothing.
    options : dict
        Keyword arguments of :func:`cyclosweep.diagnose`.
    """

    meta: Path | None
    png: bool
    quick: bool
    quiet: bool
    options: dict[str, Any]


def diagnose(
    recordings: Annotated[
        list[Path],
        typer.Argument(
            metavar="RECORDING.csv...",
            help="Measured torque and twist: CSV, Excel, MATLAB, TDMS, LabVIEW, JSON.",
        ),
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

    refuse_file(out)
    if tolerance is not None and not 0 < tolerance < math.inf:
        raise InputError(f"tolerance: found {tolerance:g}, expected degrees above zero")
    options = {
        "drive": None if drive is None else Drive.load(drive),
        "tolerance_deg": tolerance,
        "seed": seed,
        "without": without or (),
    }
    job = _Job(meta, png, quick, as_json, options)
    contents: dict[str, Any] = {}
    bad = 0
    for path, folder in _folders(recordings, out).items():
        try:
            with interruptible(f"{len(contents)} of {len(recordings)} recordings diagnosed"):
                contents[stem(path)] = _diagnose_one(path, folder, job)
        except (InputError, DesignError) as error:
            if len(recordings) == 1:
                raise
            bad += 1
            print(f"cyclosweep: {error}", file=sys.stderr)
    if as_json:
        single = len(recordings) == 1
        print_json(next(iter(contents.values())) if single else {"recordings": contents})
    if bad:
        fail(f"{bad} of {len(recordings)} recordings could not be read", 2)


def _folders(recordings: list[Path], out: Path) -> dict[Path, Path]:
    """Folder of the results of each recording: of its name where there are several."""
    from cyclosweep.recording.reading import stem

    if len(recordings) == 1:
        return {recordings[0]: out}
    folders = {path: out / stem(path) for path in recordings}
    if len(set(folders.values())) < len(recordings):
        raise InputError("recordings: two of one name, expected a folder for each in DIR")
    return folders


def _diagnose_one(path: Path, folder: Path, job: _Job) -> dict[str, Any]:
    """Diagnose one recording, write its results and return the content of diagnosis.json."""
    from cyclosweep.diagnosis import diagnose as run
    from cyclosweep.recording import Recording

    recording: Recording = Recording.read(path, job.meta)
    with _status(recording.name) as show:
        found = run(recording, progress=show, full=not job.quick, **job.options)
        if job.quick:
            _write_quick(found, folder)
        else:
            show("writing the report")
            found.write(folder)
        if job.png:
            found.report(folder / "pictures")
    if not job.quiet:
        from cyclosweep.report import print_summary

        print_summary(found.report_data())
        print(f"Written: {folder}" if job.quick else f"Report: {folder / 'report.html'}")
    content: dict[str, Any] = json.loads(found.to_json())
    return content


def _write_quick(found: Diagnosis, folder: Path) -> None:
    """Write diagnosis.json and model.json alone."""
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / "diagnosis.json", found.to_json())
    if found.model is not None:
        write_text(folder / "model.json", found.model.to_json())


@contextmanager
def _status(name: str) -> Iterator[Callable[[str], None]]:
    """Show the step at work on standard error when that is a terminal."""
    if not sys.stderr.isatty():
        yield lambda text: None
        return
    from rich.console import Console

    with Console(stderr=True).status(name) as status:
        yield lambda text: status.update(f"{name}: {text}")
