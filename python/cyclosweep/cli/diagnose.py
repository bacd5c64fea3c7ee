"""`cyclosweep diagnose`."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cyclosweep.cli.output import (
    AsJson,
    fail,
    folder_named,
    interruptible,
    print_json,
    print_tables,
    refuse_folder,
)
from cyclosweep.display import shown_steps
from cyclosweep.errors import DesignError, InputError, require_matplotlib

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console, ConsoleOptions, RenderableType

    from cyclosweep.diagnosis import Diagnosis
    from cyclosweep.diagnosis.folder import Series


ROOM_OF_VALUES = 76
"""Columns of a terminal that verdict, conditions and values of a folder take."""
SHORTEST_NAME = 16
"""Columns that the name of a recording has in any case."""


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
            metavar="RECORDING.csv|FOLDER...",
            help="Measured torque and twist: CSV, Excel, MATLAB, TDMS, LabVIEW, JSON.",
        ),
    ],
    out: Annotated[
        Path,
        typer.Option("--out", parser=folder_named, metavar="DIR", help="Folder of the results."),
    ],
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
    workers: Annotated[
        int, typer.Option("--workers", min=1, help="Processes that diagnose a folder.")
    ] = 1,
    fresh: Annotated[
        bool, typer.Option("--fresh", help="Diagnose a folder anew, not only what is missing.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Find the physics that the simulation leaves out of a recording.

    Writes diagnosis.json, model.json and report.html: into DIR for one recording, into
    DIR/<stem>/ each for several. For a FOLDER every recording in it is diagnosed, and table.csv,
    table.parquet and index.html compare them. Exit status 0 whatever the verdict, 2 when a file
    is bad input.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.recording.reading import stem

    refuse_folder(out)
    if png:
        require_matplotlib()
    if tolerance is not None and not 0 < tolerance < math.inf:
        raise InputError(f"tolerance: found {tolerance:g}, expected degrees above zero")
    options = {
        "drive": None if drive is None else Drive.load(drive),
        "tolerance_deg": tolerance,
        "seed": seed,
        "without": without or (),
    }
    job = _Job(meta, png, quick, as_json, options)
    if any(path.is_dir() for path in recordings):
        _diagnose_folder(recordings, out, job, workers, fresh)
        return
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
    from cyclosweep.diagnosis.folder import refuse_same_names
    from cyclosweep.recording.reading import stem

    if len(recordings) == 1:
        return {recordings[0]: out}
    refuse_same_names(recordings)
    return {path: out / stem(path) for path in recordings}


def _diagnose_one(path: Path, folder: Path, job: _Job) -> dict[str, Any]:
    """Diagnose one recording, write its results and return the content of diagnosis.json."""
    from cyclosweep.diagnosis import diagnose as run
    from cyclosweep.recording import Recording

    recording: Recording = Recording.read(path, job.meta)
    with shown_steps(recording.name, sys.stderr.isatty()) as show:
        found = run(recording, progress=show, full=not job.quick, **job.options)
        try:
            if job.quick:
                found.write(folder, report=False)
            else:
                show("writing the report")
                found.write(folder)
            if job.png:
                found.report(folder / "pictures")
        except OSError:
            # What was computed is not lost with the folder.
            _show(found, job)
            raise
    _show(found, job)
    if not job.quiet:
        print(f"Written: {folder}" if job.quick else f"Report: {folder / 'report.html'}")
    content: dict[str, Any] = json.loads(found.to_json())
    return content


def _show(found: Diagnosis, job: _Job) -> None:
    """Print the summary of a diagnosis, unless nothing is to be printed."""
    if not job.quiet:
        from cyclosweep.report import print_summary

        print_summary(found.report_data())


def _diagnose_folder(
    recordings: list[Path], out: Path, job: _Job, workers: int, fresh: bool
) -> None:
    """Diagnose all recordings of a folder and print what the table across them shows."""
    from cyclosweep.diagnosis.folder import diagnose_folder, recordings_in

    paths = [
        path for each in recordings for path in (recordings_in(each) if each.is_dir() else [each])
    ]
    with interruptible(f"what is done stays in {out}; repeat the command to go on"):
        series = diagnose_folder(
            paths,
            out,
            meta=job.meta,
            workers=workers,
            resume=not fresh,
            full=not job.quick,
            progress=lambda text: print(text, file=sys.stderr),
            **job.options,
        )
    if job.quiet:
        trends = [{"condition": each.condition, "measure": each.measure, "pairs": each.pairs,
                   "rising": each.rising, "p_value": each.p_value, "text": each.text,
                   "levels": [{"value": level.value, "recordings": level.recordings,
                               "mean": level.mean, "ci95": level.ci95} for level in each.levels]}
                  for each in series.trends]  # fmt: skip
        steps = series.steps and asdict(series.steps) | {"text": series.steps.text}
        print_json({"table": series.table.to_dicts(), "trends": trends, "steps": steps})
    else:
        print_tables([_folder_table(series)], any_width=True)
        for row in series.table.to_dicts():
            if row.get("remarks"):
                print(f"Check first, {row['recording']}: {row['remarks']}")
        for trend in series.trends:
            print(trend.text)
        if series.steps is not None:
            print(series.steps.text)
        print(f"Written: {out / 'index.html'}, table.csv, table.parquet")
    if series.failed:
        fail(
            f"{series.failed} of {len(paths)} recordings have no diagnosis, see "
            f"{out / 'table.csv'}",
            2,
        )


@dataclass(frozen=True)
class _FolderTable:
    """A table that rich prints, where there is less room than it needs as a few lines a recording.

    Attributes
    ----------
    headings : list of str
        The first is the recording's.
    rows : list of list of str
        Cells; the first is the name, whole.
    words : set of str
        Headings of columns of words, which stand at the left.
    """

    headings: list[str]
    rows: list[list[str]]
    words: set[str]

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        """Table, or lines."""
        from rich.measure import Measurement
        from rich.padding import Padding
        from rich.table import Table
        from rich.text import Text

        room = max(options.max_width - ROOM_OF_VALUES, SHORTEST_NAME)
        names = shortened([row[0] for row in self.rows], room)
        rows = [[name, *row[1:]] for name, row in zip(names, self.rows, strict=True)]
        table = Table(box=None, padding=(0, 2, 0, 0), header_style="bold")
        for place, heading in enumerate(self.headings):
            side: Literal["left", "right"] = "left" if heading in self.words else "right"
            longest = max(
                len(word) for text in (heading, *(row[place] for row in rows))
                for word in text.split(" ")
            )  # fmt: skip
            table.add_column(heading, justify=side, no_wrap=place == 0, min_width=longest)
        for row in rows:
            table.add_row(*row)
        if Measurement.get(console, options.update(width=1000), table).minimum <= options.max_width:
            yield table
            return
        for name, *cells in self.rows:
            yield Text(name, style="bold")
            lines = [f"{h}: {c}" for h, c in zip(self.headings[1:], cells, strict=True)]
            yield Padding(Text("\n".join(lines)), (0, 0, 0, 2))


def _folder_table(series: Series) -> _FolderTable:
    """Table across the recordings: conditions, verdict in words, friction, play, compliance."""
    from cyclosweep.report.series_page import heading, verdict_of
    from cyclosweep.report.wording import number
    from cyclosweep.result.series import MEASURES, as_shown
    from cyclosweep.result.words import readable

    rows = series.table.to_dicts()
    measures = [name for name in MEASURES if any(row.get(name) is not None for row in rows)]
    conditions = [readable(condition) for condition in series.conditions]
    lines = []
    for row in rows:
        values = {key: row.get(key) for key in (*series.conditions, *measures)}
        cells = [
            number(as_shown(key, value))
            if isinstance(value, float)
            else str("–" if value is None else value)
            for key, value in values.items()
        ]
        cells.insert(len(series.conditions), verdict_of(row))
        lines.append([str(row["recording"]), *cells])
    words = ["recording", *conditions, "verdict"]
    return _FolderTable([*words, *map(heading, measures)], lines, set(words))


def shortened(names: list[str], room: int) -> list[str]:
    """Names without what all of them begin with, where they are longer than the room for them.

    Examples
    --------
    >>> shortened(["2024-07-12_conic_1", "2024-07-12_conic_2"], 12)
    ['…12_conic_1', '…12_conic_2']
    """
    if len(names) < 2 or max(map(len, names)) <= room:
        return names
    letters = enumerate(zip(*names, strict=False))
    common = next((k for k, each in letters if len(set(each)) > 1), min(map(len, names)))
    cuts = [k + 1 for k, letter in enumerate(names[0][:common]) if letter in "_- "]
    fit = [cut for cut in cuts if max(map(len, names)) - cut < room]
    cut = (fit or cuts[-1:] or [0])[0]
    if cut < 2:
        return names
    return [f"…{name[cut:]}" for name in names]
