"""`cyclosweep simulate`."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cyclosweep.atomic import unfinished
from cyclosweep.cli.output import fail, refuse_table
from cyclosweep.errors import InputError, refuse_no_file

if TYPE_CHECKING:
    from polars import DataFrame

    from cyclosweep.design.drive import Drive
    from cyclosweep.recording import Recording
    from cyclosweep.simulation.model import Model


def simulate(
    model: Annotated[
        str, typer.Argument(metavar="MODEL", help="Built-in drive, drive .toml or model.json.")
    ],
    program: Annotated[Path, typer.Argument(metavar="PROGRAM.csv", help="Load programme.")],
    out: Annotated[Path, typer.Option("--out", metavar="OUT.csv", help="File to write.")],
    predict: Annotated[
        Literal["angle", "torque"], typer.Option(help="What to predict from the other.")
    ] = "angle",
    law: Annotated[
        Literal["published", "components"],
        typer.Option(
            "--model", help="Of a drive: the published model, or the component model's curve."
        ),
    ] = "published",
    crank_deg: Annotated[
        float,
        typer.Option("--crank-deg", help="Crank's angle in the middle, component model only."),
    ] = 0.0,
    largest_load_nm: Annotated[
        float | None,
        typer.Option(
            "--largest-load-nm", metavar="NM", help="Scale the programme to this largest torque."
        ),
    ] = None,
    sheet: Annotated[
        Path | None,
        typer.Option("--sheet", metavar="SHEET.csv", help="Sheet to fill in readings by hand."),
    ] = None,
    lever_arm: Annotated[
        float | None,
        typer.Option("--lever-arm", metavar="M", help="Loads of the sheet as weights in kg."),
    ] = None,
) -> None:
    """Predict the twist of a load programme by a drive's model or by a repaired one.

    With --sheet the programme is also written as a sheet with an empty column for the readings.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.recording.programme import beyond_fit, beyond_rating, scaled_programme, sheet_of
    from cyclosweep.simulation.simulate import simulate as run

    refuse_no_file(program)
    read = (program, _metadata(program), Path(model))
    refuse_table(out, *read)
    if sheet is not None:
        refuse_table(sheet, *read, out, option="--sheet")
        if sheet.exists():
            raise InputError(f"--sheet: {sheet} exists, it may hold readings; give another name")
    elif lever_arm is not None:
        raise InputError("--lever-arm: found without --sheet, whose loads it turns into weights")
    chosen = _model(model)
    programme = _programme(program, chosen)
    if largest_load_nm is not None:
        programme = scaled_programme(programme, largest_load_nm)
    for note in programme.notes:
        print(f"{program}: {note}", file=sys.stderr)
    if isinstance(chosen, Drive):
        warning = beyond_rating(programme, chosen)
    else:
        warning = beyond_fit(programme, chosen.fitted_torque_nm) if predict == "angle" else None
    if warning:
        print(f"Warning: {warning}", file=sys.stderr)
    filled_in = None if sheet is None else sheet_of(programme, lever_arm)
    if law == "components":
        chosen = _of_components(chosen, model, programme.side, crank_deg)
    predicted = run(chosen, programme, predict).to_frame()
    _write(predicted, out)
    print(f"Written: {out} ({predicted.height} rows)")
    if sheet is not None and filled_in is not None:
        _write(filled_in, sheet)
        side = "" if programme.side == "input" else " --side output"
        arm = "" if lever_arm is None else f" --lever-arm {lever_arm:g}"
        settings = sheet.with_suffix(".toml")
        print(f"Fill in the angles of {sheet}. Next: cyclosweep inspect {quote(str(sheet))} "
              f"--drive {quote(model)}{side}{arm} --out {quote(str(settings))}")  # fmt: skip


def _write(table: DataFrame, out: Path) -> None:
    """Write a table whole or not at all."""
    try:
        with unfinished(out) as file:
            table.write_csv(file)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)


def _metadata(program: Path) -> Path:
    """File of metadata that belongs to a programme."""
    from cyclosweep.recording.reading import stem

    return program.with_name(f"{stem(program)}.toml")


def _model(name: str) -> Model | Drive:
    from cyclosweep.design.drive import Drive
    from cyclosweep.simulation.model import Model

    return Model.from_json(name) if name.endswith(".json") else Drive.load(name)


def _of_components(
    drive: Model | Drive, name: str, side: Literal["input", "output"], crank_deg: float
) -> Model:
    """Component model of a drive at the shaft of a programme, its contacts' friction included."""
    from cyclosweep.simulation.model import Model

    if isinstance(drive, Model):
        raise InputError(f"--model: found {name}, a model already, expected a drive")
    return Model.of_components(drive, side, crank_deg, friction=True)


def _programme(path: Path, model: Model | Drive) -> Recording:
    """Read a load programme; without metadata it is taken at the shaft of a repaired model."""
    from cyclosweep.recording import Recording

    programme = Recording.read(path)
    if not len(programme):
        raise InputError(f"{path}: no row has all of its values, expected a torque in each")
    side = getattr(model, "side", None)
    if side is None or _metadata(path).exists():
        return programme
    return dataclasses.replace(programme, side=side)
