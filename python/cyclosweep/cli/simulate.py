"""`cyclosweep simulate`."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cyclosweep.atomic import unfinished
from cyclosweep.cli.output import fail
from cyclosweep.errors import InputError

if TYPE_CHECKING:
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
) -> None:
    """Predict the twist of a load programme by a drive's model or by a repaired one."""
    from cyclosweep.simulation.simulate import simulate as run

    if not program.is_file():
        raise InputError(f"{program}: no such file")
    _refuse_output(out, (program, _metadata(program), Path(model)))
    chosen = _model(model)
    programme = _programme(program, chosen)
    if law == "components":
        chosen = _of_components(chosen, model, programme.side, crank_deg)
    table = run(chosen, programme, predict).to_frame()
    try:
        with unfinished(out) as file:
            table.write_csv(file)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)


def _refuse_output(out: Path, inputs: tuple[Path, ...]) -> None:
    """Refuse to write over a file that is read, or where no file can be."""
    if any(path.exists() and out.exists() and path.samefile(out) for path in inputs):
        raise InputError(f"--out: found {out}, which is read, expected another file")
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"--out: found {out}, expected a file in a folder that exists")


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
    side = getattr(model, "side", None)
    if side is None or _metadata(path).exists():
        return programme
    return dataclasses.replace(programme, side=side)
