"""`cyclosweep inspect`."""

from __future__ import annotations

import dataclasses
import os
import shutil
import textwrap
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cyclosweep.atomic import write_text
from cyclosweep.cli.output import AsJson, print_json, refuse_overwriting
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from cyclosweep.recording.inspection import ColumnFacts, Inspection
    from cyclosweep.recording.metadata import TableOptions
    from cyclosweep.recording.proposed import Known

_NARROWEST = 40


def inspect(
    recording: Annotated[
        Path, typer.Argument(metavar="RECORDING", help="CSV, Excel, MATLAB, TDMS, LabVIEW, JSON.")
    ],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="META.toml", help="Write the metadata file.")
    ] = None,
    drive: Annotated[
        str | None,
        typer.Option("--drive", metavar="NAME|FILE", help="Drive: tells unit and side by it."),
    ] = None,
    side: Annotated[
        Literal["input", "output"] | None, typer.Option(help="Shaft of torque and angle.")
    ] = None,
    torque: Annotated[
        str | None, typer.Option("--torque", metavar="COLUMN", help="Column of the torque.")
    ] = None,
    angle: Annotated[
        str | None, typer.Option("--angle", metavar="COLUMN", help="Column of the angle.")
    ] = None,
    torque_unit: Annotated[
        str | None, typer.Option("--torque-unit", metavar="UNIT", help="Such as 'lbf in'.")
    ] = None,
    angle_unit: Annotated[
        str | None, typer.Option("--angle-unit", metavar="UNIT", help="Such as mrad or turns.")
    ] = None,
    lever_arm: Annotated[
        float | None, typer.Option("--lever-arm", metavar="M", help="Lever arm of a force [m].")
    ] = None,
    nm_per_a: Annotated[
        float | None, typer.Option("--nm-per-a", metavar="K", help="Torque of one ampere [N m/A].")
    ] = None,
    counts: Annotated[
        float | None,
        typer.Option("--counts-per-turn", metavar="N", help="Counts of one turn of the shaft."),
    ] = None,
    sheet: Annotated[
        str | None, typer.Option("--sheet", metavar="NAME", help="Sheet, group or structure.")
    ] = None,
    header_row: Annotated[
        int | None, typer.Option("--header-row", metavar="N", min=1, help="Row of the names.")
    ] = None,
    missing: Annotated[
        list[str] | None,
        typer.Option("--missing", metavar="TEXT", help="Cell of a row to pass over; repeatable."),
    ] = None,
    settings: Annotated[
        Path | None,
        typer.Option("--meta", metavar="META.toml", help="Settings in force; else those beside."),
    ] = None,
    ignore_settings: Annotated[
        bool, typer.Option("--ignore-settings", help="Go by the recording alone.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Replace META.toml.")] = False,
    as_json: AsJson = False,
) -> None:
    """Show what is understood of a recording, and write the metadata file to diagnose it with.

    With the metadata file of the same stem beside the recording, `cyclosweep diagnose RECORDING
    --out DIR` follows. Nothing is written where a column could be two things. Where that file
    exists already, the recording is shown as diagnose reads it, and what it suggests otherwise is
    listed.
    """
    from cyclosweep.recording.inspection import inspect as look
    from cyclosweep.recording.metadata import TableOptions

    if out is not None:
        if out.is_dir() or not out.parent.is_dir():
            raise InputError(f"--out: found {out}, expected a file in a folder that exists")
        refuse_overwriting(out, force=force)
        if out.exists() and recording.exists() and out.samefile(recording):
            raise InputError(f"--out: {out} is the recording itself, expected another file")
    for name, value in (("lever-arm", lever_arm), ("counts-per-turn", counts)):
        if value is not None and not value > 0:
            raise InputError(f"--{name}: found {value:g}, expected a number above zero")
    options = TableOptions(sheet=sheet, header_row=header_row, missing=missing or [])
    in_force = _settings(recording, settings, ignore_settings)
    known = _known(recording, in_force, out, drive, side, options)
    known = dataclasses.replace(
        known,
        torque_unit=torque_unit,
        angle_unit=angle_unit,
        lever_arm_m=lever_arm,
        nm_per_a=nm_per_a,
        counts_per_turn=counts,
    )
    found = look(recording, known, {"torque_nm": torque, "angle_deg": angle}, out, in_force)
    if as_json:
        print_json(found.as_dict())
    else:
        _print(found)
    if found.proposal.open and out is not None:
        raise InputError(f"{out}: not written. {found.proposal.open[0]}")
    if out is not None:
        write_text(out, found.toml)
    if as_json:
        return
    if out is None and found.settings and not found.suggested and not found.stops:
        print(f"\nNext: {_next(recording, found.settings, found)}")
    elif out is None:
        state = "incomplete" if found.proposal.open else "--out writes it"
        print(f"\nProposed metadata file ({state}):\n")
        _print_proposal(found.toml, _width())
    else:
        print(f"\nWritten: {out}")
        if not found.proposal.open and found.recording and not found.recording.is_program:
            print(f"Next: {_next(recording, out, found)}")


def _settings(recording: Path, given: Path | None, ignored: bool) -> Path | None:
    """Metadata file in force: the one given, or the one of the recording's name beside it."""
    from cyclosweep.recording.columns import metadata_path

    if ignored and given is not None:
        raise InputError("--ignore-settings: found --meta, too, expected one of them")
    return None if ignored else metadata_path(recording, given)


def _known(
    recording: Path,
    settings: Path | None,
    out: Path | None,
    drive: str | None,
    side: Literal["input", "output"] | None,
    options: TableOptions,
) -> Known:
    """Load the drive; drive and side of the settings in force count, too."""
    from cyclosweep.design.drive import Drive
    from cyclosweep.recording.metadata import Metadata
    from cyclosweep.recording.proposed import Known
    from cyclosweep.recording.reading import stem

    beside = recording.with_name(f"{stem(recording)}.toml")
    file: Path | None = None
    if settings is not None:
        meta = Metadata.read(settings)
        side = side or meta.side
        if drive is None and meta.drive is not None:
            drive = meta.drive
            if (settings.parent / drive).is_file():
                drive = str(settings.parent / drive)
    if drive is not None and drive.endswith(".toml"):
        file = Path(drive)
    chosen = None if drive is None else Drive.load(drive)
    name = drive if file is None else _shorter(file, (out or beside).parent)
    return Known(chosen, name, side, table=options)


def _shorter(file: Path, folder: Path) -> str:
    """Path of the drive file from the folder of the metadata, or its whole path if shorter."""
    return min(os.path.relpath(file, folder), str(file.resolve()), key=len)


def _next(recording: Path, out: Path, found: Inspection) -> str:
    """Command that diagnoses the recording."""
    from cyclosweep.recording.reading import stem

    beside = out.resolve() == recording.with_name(f"{stem(recording)}.toml").resolve()
    meta = "" if beside else f" --meta {quote(str(out))}"
    drive = "" if "drive" in found.proposal.meta else " --drive DRIVE"
    folder = quote(f"out/{stem(recording)}")
    return f"cyclosweep diagnose {quote(str(recording))}{meta}{drive} --out {folder}"


def _print(found: Inspection) -> None:
    """Print what was understood, as narrow as the terminal is."""
    width = _width()
    print(found.path)
    if found.settings is not None:
        _paragraph("settings in force", str(found.settings), width)
    if found.stops is not None:
        _paragraph("with them alone diagnose stops", found.stops, width)
    print("\nColumns")
    for column in found.columns:
        for line in textwrap.wrap(
            _column_line(column), width, initial_indent="  ", subsequent_indent="      "
        ):
            print(line)
    if found.unread_columns:
        _paragraph("numbers, not read", ", ".join(found.unread_columns), width)
    if found.text_columns:
        _paragraph("text, not read", ", ".join(found.text_columns), width)
    if found.facts:
        print("\nUnderstood")
        for label, text in found.facts.items():
            _paragraph(label, text, width)
    _list("Recognised", found.notes, width)
    faults = found.recording.faults if found.recording else ()
    _list("Remarks", [f"{f.verdict}: {f.reason}" if f.verdict else f.reason for f in faults], width)
    _list("Check first", found.proposal.checks, width)
    _list("The file suggests otherwise", found.suggested, width)
    _list("Assumed", found.proposal.assumed, width)
    _list("To be said first", found.proposal.open, width)


def _width() -> int:
    """Columns of the terminal."""
    return max(shutil.get_terminal_size((100, 24)).columns, _NARROWEST)


def _print_proposal(toml: str, width: int) -> None:
    """Print the metadata file, its comments as narrow as the terminal is.

    Parameters
    ----------
    toml : str
        The file.
    width : int
        Columns of the terminal.
    """
    for line in toml.splitlines():
        if line.startswith("# "):
            line = textwrap.fill(
                line[2:], width, initial_indent="# ", subsequent_indent="# ",
                break_long_words=False, break_on_hyphens=False,
            )  # fmt: skip
        print(line)


def _column_line(column: ColumnFacts) -> str:
    """One column in a line."""
    unit = f" [{column.unit}]" if column.unit and column.unit not in column.name else ""
    role = f" = {column.role}" if column.role and column.role != column.name else ""
    missing = f", {column.missing} missing" if column.missing else ""
    step = f", steps of {column.step:.3g}" if column.step else ", constant"
    return f"{column.name}{unit}{role}: {column.low:.5g} to {column.high:.5g}{step}{missing}"


def _paragraph(label: str, text: str, width: int) -> None:
    """Print a labelled text."""
    for line in textwrap.wrap(
        f"{label}: {text}", width, initial_indent="  ", subsequent_indent="      "
    ):
        print(line)


def _list(title: str, texts: list[str], width: int) -> None:
    """Print a titled list, if there is something in it."""
    if not texts:
        return
    print(f"\n{title}")
    for text in texts:
        for line in textwrap.wrap(text, width, initial_indent="  - ", subsequent_indent="    "):
            print(line)
