"""`cyclosweep torque-twist`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cyclosweep.atomic import unfinished
from cyclosweep.cli.output import AsJson, fail, print_json, refuse_table
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from cyclosweep.design.torque_twist import TorqueTwist


def torque_twist(
    drive: Annotated[str, typer.Argument(metavar="DRIVE", help="Built-in drive or drive .toml.")],
    out: Annotated[Path, typer.Option("--out", metavar="OUT.csv", help="File to write.")],
    side: Annotated[
        Literal["input", "output"], typer.Option(help="Shaft that is turned, the other one locked.")
    ] = "input",
    crank_deg: Annotated[
        float, typer.Option("--crank-deg", help="Angle of the crank in the middle of its play.")
    ] = 0.0,
    to_load: Annotated[
        float, typer.Option("--to-load", help="Largest load over the shaft's nominal torque.")
    ] = 4.5,
    points: Annotated[int, typer.Option(help="Equal steps of the turn in each direction.")] = 200,
    as_json: AsJson = False,
) -> None:
    """Write torque over twist of a drive by its component model, free play and both directions."""
    from cyclosweep.design.drive import Drive

    refuse_table(out, drive)
    chosen = Drive.load(drive)
    curve = chosen.torque_twist(side, crank_deg, to_load_tn=to_load, points=points)
    try:
        with unfinished(out) as file:
            curve.table.write_csv(file)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)
    summary = _summary(curve)
    if as_json:
        print_json({"schema": "cyclosweep.torque-twist/1", "file": str(out), **summary})
    else:
        for name, value in summary.items():
            print(f"{name}: {value:.6g}" if isinstance(value, float) else f"{name}: {value}")


def _summary(curve: TorqueTwist) -> dict[str, Any]:
    """What a curve says in a few numbers."""
    line: dict[str, float | None] = {"line_free_play_deg": None, "line_compliance_deg_per_nm": None}
    try:
        fitted = curve.line()
    except InputError:
        pass
    else:
        line = {
            "line_free_play_deg": fitted.free_play_deg,
            "line_compliance_deg_per_nm": fitted.compliance_deg_per_nm,
        }
    return {
        "side": curve.side,
        "nominal_torque_nm": curve.nominal_torque_nm,
        "free_play_below_deg": curve.free_play_deg[0],
        "free_play_above_deg": curve.free_play_deg[1],
        **line,
        "friction_share": curve.friction_share(),
        "reached": curve.reached,
    }
