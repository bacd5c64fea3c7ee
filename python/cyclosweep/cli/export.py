"""`cyclosweep export`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cyclosweep.cli.output import AsJson, fail, print_json, refuse_output
from cyclosweep.errors import DesignError, InputError, did_you_mean

ENDINGS = (".dxf", ".svg", ".csv", ".step", ".stp")
"""Endings of the files that can be written."""


def export(
    drive: Annotated[str, typer.Argument(metavar="DRIVE", help="Built-in drive or drive .toml.")],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="File to write: .dxf, .svg, .csv, .step.")
    ],
    disc: Annotated[
        int | None,
        typer.Option(help="This disc alone about its centre, from 1; for .csv 1 by default."),
    ] = None,
    chord_error_mm: Annotated[
        float,
        typer.Option(
            "--chord-error-mm", "--chord-error", help="Largest distance from the true profile [mm]."
        ),
    ] = 1e-3,
    without_modification: Annotated[
        bool,
        typer.Option(
            "--without-modification", help="The profile that touches every ring pin, uncut."
        ),
    ] = False,
    min_wall_mm: Annotated[
        float, typer.Option("--min-wall-mm", help="Least wall between holes, profile and bore.")
    ] = 1.0,
    housing_bore_radius_mm: Annotated[
        float | None,
        typer.Option(
            "--housing-bore-radius-mm", help="Radius of the housing's bore, for .dxf and .svg."
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a drive's discs, pins and housing bore as DXF, SVG, CSV of the profile, or STEP.

    Undercut, crossing flanks and thin walls are refused with the reason.
    """
    from cyclosweep import cad
    from cyclosweep.design.drive import Drive

    ending = out.suffix.lower()
    if ending not in ENDINGS:
        meant = did_you_mean(ending, ENDINGS)
        raise InputError(f"--out: found {out}, expected a file in {', '.join(ENDINGS)}{meant}")
    refuse_output(out, drive)
    if housing_bore_radius_mm is not None and (ending not in (".dxf", ".svg") or disc is not None):
        raise InputError(
            "--housing-bore-radius-mm: the housing stands in drawings of the whole drive alone, "
            ".dxf or .svg without --disc"
        )
    chosen, modification = Drive.load(drive), not without_modification
    try:
        if ending == ".csv":
            facts = cad.write_points(
                chosen,
                out,
                disc=1 if disc is None else disc,
                chord_error_mm=chord_error_mm,
                modification=modification,
                min_wall_mm=min_wall_mm,
            )
        elif ending in (".step", ".stp"):
            facts = cad.write_step(
                chosen,
                out,
                disc=disc,
                chord_error_mm=chord_error_mm,
                modification=modification,
                min_wall_mm=min_wall_mm,
            )
        else:
            write = cad.write_dxf if ending == ".dxf" else cad.write_svg
            facts = write(
                chosen,
                out,
                disc=disc,
                chord_error_mm=chord_error_mm,
                modification=modification,
                min_wall_mm=min_wall_mm,
                housing_bore_radius_mm=housing_bore_radius_mm,
            )
    except DesignError as error:
        reason = str(error).removeprefix(f"{chosen.name}: ")
        raise DesignError(f"{drive}: {reason}") from None
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)
    if as_json:
        print_json({"schema": "cyclosweep.export/1", "file": str(out), **facts})
        return
    print(f"file: {out}")
    for name, value in facts.items():
        shown = "the whole drive" if name == "disc" and value is None else value
        print(f"{name}: {shown:.6g}" if isinstance(shown, float) else f"{name}: {shown}")
