"""`cyclosweep modes` and `cyclosweep shock`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cyclosweep.cli.frames import FrameTable
from cyclosweep.cli.output import (
    AsJson,
    folder_named,
    print_json,
    print_tables,
    refuse_folder,
)
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    import polars as pl

MOST_DIMENSIONS = 8
"""Dimensions of a mode that fit on a screen; ``--json`` has them all."""

DriveName = Annotated[str, typer.Argument(metavar="DRIVE", help="Built-in drive or drive file.")]


def modes(
    drive: DriveName,
    as_json: AsJson = False,
    model: Annotated[
        str,
        typer.Option("--model", metavar="published|components|FILE.json", help="Whose springs."),
    ] = "published",
    load_inertia: Annotated[
        float | None,
        typer.Option("--load-inertia", help="At the output [kg m^2]; without it it is locked."),
    ] = None,
    input_inertia: Annotated[
        float | None, typer.Option("--input-inertia", help="Motor [kg m^2]; the drive's own.")
    ] = None,
    eccentric_inertia: Annotated[
        float | None, typer.Option("--eccentric-inertia", help="With the input shaft [kg m^2].")
    ] = None,
    input_shaft_stiffness: Annotated[
        float | None, typer.Option("--input-shaft-stiffness", help="Before it [N m/rad].")
    ] = None,
    flange_inertia: Annotated[
        float | None, typer.Option("--flange-inertia", help="Before a coupling [kg m^2].")
    ] = None,
    coupling_stiffness: Annotated[
        float | None, typer.Option("--coupling-stiffness", help="To the load [N m/rad].")
    ] = None,
    without_efficiency: Annotated[
        bool, typer.Option("--without-efficiency", help="Leave eta out of the compliance.")
    ] = False,
    speed: Annotated[
        float | None,
        typer.Option("--speed", help="Highest input speed [rpm] at which orders excite modes."),
    ] = None,
) -> None:
    """Natural frequencies of a drive's torsional train, who holds their energy, what excites them.

    Small oscillations under a load that keeps the play closed.
    """
    from cyclosweep.design.drive import Drive
    from cyclosweep.design.drive_modes import dimension_sensitivities
    from cyclosweep.design.drive_modes import modes as modes_of
    from cyclosweep.design.excitation import campbell, excitation_orders

    chosen = Drive.load(drive)
    springs = _springs(model)
    named: Any = model
    options: dict[str, Any] = {
        "with_efficiency": not without_efficiency,
        "load_inertia_kg_m2": load_inertia,
        "input_inertia_kg_m2": input_inertia,
        "eccentric_inertia_kg_m2": eccentric_inertia,
        "input_shaft_stiffness_nm_per_rad": input_shaft_stiffness,
        "flange_inertia_kg_m2": flange_inertia,
        "coupling_stiffness_nm_per_rad": coupling_stiffness,
    }
    found = modes_of(chosen, springs, **options)
    moved = dimension_sensitivities(chosen, named, **options) if springs is model else None
    orders = excitation_orders(chosen)
    fastest = chosen.input_speed_rpm if speed is None else speed
    meetings = campbell(found, orders, fastest)
    if as_json:
        print_json(
            {
                "drive": chosen.name,
                "frequencies_hz": found.frequencies_hz.tolist(),
                "modes": found.table().to_dicts(),
                "energy_shares": found.energy_shares.to_dicts(),
                "sensitivities": found.sensitivities.to_dicts(),
                "dimension_sensitivities": None if moved is None else moved.to_dicts(),
                "excitation_orders": orders.to_dicts(),
                "excited_at": meetings.to_dicts(),
            }
        )
        return
    dimensions = [] if moved is None else [_largest(moved)]
    print_tables(
        [
            FrameTable("natural frequencies and shapes", found.table()),
            FrameTable("who holds the energy; percent per percent of it", found.summary()),
            *[FrameTable("percent per percent of a dimension", table) for table in dimensions],
            FrameTable(f"excited below {fastest:g} rpm", meetings),
        ]
    )


def shock(
    drive: DriveName,
    event: Annotated[Path, typer.Argument(metavar="EVENT.toml", help="What happens.")],
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            parser=folder_named,
            metavar="DIR",
            help="Folder for the tables and the picture.",
        ),
    ],
    as_json: AsJson = False,
) -> None:
    """Follow a drive's torsional train through an event: peak torques, impacts, shock factor.

    Writes transient.parquet, events.csv, shock.json and, where matplotlib is installed, shock.png.
    """
    from cyclosweep.atomic import unfinished, write_text
    from cyclosweep.design.drive import Drive
    from cyclosweep.design.events import Event, transient
    from cyclosweep.figures.train import save_transient

    chosen = Drive.load(drive)
    what = Event.from_toml(event).of_drive(chosen)
    train = chosen.train(_springs(what.model), with_efficiency=True, **what.parts)
    refuse_folder(out)
    try:
        run = transient(train, what)
    except InputError as error:
        raise InputError(f"{event}: {str(error).removeprefix('event: ')}") from None
    out.mkdir(parents=True, exist_ok=True)
    content: dict[str, Any] = {
        "schema": "cyclosweep.shock/1",
        "drive": chosen.name,
        "event": what.model_dump(mode="json"),
        "peak_torques_nm": run.peak_torques_nm,
        "peak_times_s": run.peak_times_s,
        "static_torques_nm": run.static_torques_nm,
        "shock_factors": run.shock_factors,
        "shock_factor": run.shock_factor,
        "impacts": len(run.impacts),
        "friction_losses_j": run.friction_losses_j,
    }
    with unfinished(out / "transient.parquet") as file:
        run.table.write_parquet(file)
    with unfinished(out / "events.csv") as file:
        run.events.write_csv(file)
    write_text(out / "shock.json", json.dumps(content, indent=1) + "\n")
    pictured = save_transient(run, out / "shock.png")
    if as_json:
        print_json(content)
        return
    print_tables([FrameTable(f"{chosen.name}: {what.kind}", run.summary())])
    factor = "none, no torque is static" if run.shock_factor is None else f"{run.shock_factor:.3f}"
    print(f"shock factor {factor}; {len(run.impacts)} impacts in {what.duration_s:g} s")
    print(f"{out}: transient.parquet, events.csv, shock.json{', shock.png' if pictured else ''}")


def _springs(model: str) -> Any:
    """Whose springs an option means: a name, or a calibrated model from its file."""
    if not model.endswith(".json"):
        return model
    from cyclosweep.simulation.model import Model

    return Model.from_json(model)


def _largest(moved: pl.DataFrame) -> pl.DataFrame:
    """Dimensions that move a frequency by a hundredth of their own change or more."""
    import polars as pl

    shown = moved.filter(pl.col("percent_per_percent").abs() >= 0.01)
    return shown.group_by("mode", maintain_order=True).head(MOST_DIMENSIONS).drop("hz_per_unit")
