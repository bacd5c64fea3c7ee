"""`cyclosweep plot`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from cyclosweep.cli.output import fail, refuse_output
from cyclosweep.errors import DesignError, InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive
    from cyclosweep.explore.tables import Table

Kind = Literal[
    "disc", "map", "shares", "ring", "twist", "budget", "load-series", "clearance-series", "modes",
    "campbell", "pareto", "parallel", "response",
]  # fmt: skip
Rule = Literal["published-map", "inside", "statics"]


@dataclass(frozen=True)
class _Asked:
    """What the command line says of a picture; names as its options."""

    kind: str
    sources: tuple[str, ...]
    criterion: Rule | None
    mesh_deg: float
    hole: int
    torque: float | None
    load_inertia: float | None
    objective: tuple[str, ...]
    column: tuple[str, ...]
    colour: str | None
    x: str | None
    y: str | None
    z: str | None
    how: Literal["mean", "min", "max"]
    limit: tuple[str, ...]
    variant: tuple[int, ...]

    def one(self) -> str:
        """Return the only source."""
        if len(self.sources) != 1:
            raise InputError(
                f"SOURCE: found {len(self.sources)}, expected one for a picture {self.kind}"
            )
        return self.sources[0]

    def drive(self) -> Drive:
        """Return the drive that is drawn."""
        from cyclosweep.design.drive import Drive

        return Drive.load(self.one())

    def table(self) -> Table:
        """Return the table that is drawn: a folder, a file or a study file, swept on the way."""
        from cyclosweep.sweep.study import Study

        source = self.one()
        return Study.from_toml(source) if source.endswith(".toml") else source


def plot(
    kind: Annotated[Kind, typer.Argument(metavar="KIND", help="Which picture, see below.")],
    source: Annotated[
        list[str],
        typer.Argument(metavar="SOURCE...", help="Drive (.toml or built-in), or study or table."),
    ],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="Picture: .png, .svg or .pdf.")
    ],
    criterion: Annotated[
        Rule | None, typer.Option(help="disc, map: what is active; the drive's own by default.")
    ] = None,
    mesh_deg: Annotated[
        float, typer.Option("--mesh-deg", help="disc, ring: position of the mesh zone [deg].")
    ] = 45.0,
    hole: Annotated[int, typer.Option(help="disc: hole whose path is drawn, from 1.")] = 1,
    torque: Annotated[
        float | None, typer.Option(help="shares, ring: output torque [N m]; rated by default.")
    ] = None,
    load_inertia: Annotated[
        float | None, typer.Option("--load-inertia", help="modes, campbell: at the output [kg m^2]")
    ] = None,
    objective: Annotated[
        list[str] | None,
        typer.Option(metavar="COLUMN", help="pareto: twice; 'max COLUMN' where more is better."),
    ] = None,
    column: Annotated[
        list[str] | None, typer.Option(metavar="COLUMN", help="parallel: an axis each.")
    ] = None,
    colour: Annotated[
        str | None, typer.Option(metavar="COLUMN", help="parallel: colour; the last axis else.")
    ] = None,
    x: Annotated[
        str | None, typer.Option("--x", metavar="COLUMN", help="response: across.")
    ] = None,
    y: Annotated[str | None, typer.Option("--y", metavar="COLUMN", help="response: up.")] = None,
    z: Annotated[
        str | None, typer.Option("--z", metavar="COLUMN", help="response: the result.")
    ] = None,
    how: Annotated[
        Literal["mean", "min", "max"], typer.Option(help="response: of variants at one point.")
    ] = "mean",
    limit: Annotated[
        list[str] | None,
        typer.Option(metavar="TEXT", help="Variants that count, as 'hole_web_mm > 2'; repeatable."),
    ] = None,
    variant: Annotated[
        list[int] | None,
        typer.Option(metavar="N", help="pareto, parallel: variant to mark; repeatable."),
    ] = None,
    dpi: Annotated[float, typer.Option(help="Dots of a PNG in an inch.")] = 300.0,
) -> None:
    """Draw a picture of a drive or of a study.

    Of a drive: disc (holes, pins, path of a hole with its active arcs), map (active pins over a
    turn of the mesh zone), twist (against load, with the free play), shares (who carries the
    load), ring (forces of the ring pins), budget (compliance by parts, several drives),
    load-series and clearance-series (stiffness, play, lost motion, active pins), modes, campbell.

    Of a study, its folder, its .toml, or a table as CSV, Excel or Parquet: pareto, parallel,
    response (a result over two inputs).
    """
    if not 20 <= dpi <= 2400:
        raise InputError(f"--dpi: found {dpi:g}, expected 20 to 2400")
    _refuse(out, source)
    asked = _Asked(
        kind=kind,
        sources=tuple(source),
        criterion=criterion,
        mesh_deg=mesh_deg,
        hole=hole,
        torque=torque,
        load_inertia=load_inertia,
        objective=tuple(objective or ()),
        column=tuple(column or ()),
        colour=colour,
        x=x,
        y=y,
        z=z,
        how=how,
        limit=tuple(limit or ()),
        variant=tuple(variant or ()),
    )
    figure = _KINDS[kind](asked)
    from cyclosweep.figures.style import save

    try:
        save(figure, out, dpi)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)
    print(out)


def _refuse(out: Path, sources: list[str]) -> None:
    """Refuse a file that cannot be written before anything is computed."""
    refuse_output(out, *sources)
    if out.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"--out: found {out}, expected a file ending in .png, .svg or .pdf")


def _disc(asked: _Asked) -> Figure:
    from cyclosweep.figures.disc import disc_figure

    return disc_figure(
        asked.drive(), mesh_deg=asked.mesh_deg, hole=asked.hole, criterion=asked.criterion
    )


def _map(asked: _Asked) -> Figure:
    from cyclosweep.figures.active_map import map_figure

    return map_figure(asked.drive(), criterion=asked.criterion)


def _shares(asked: _Asked) -> Figure:
    from cyclosweep.figures.shares import shares_figure

    return shares_figure(asked.drive(), output_torque_nm=asked.torque)


def _ring(asked: _Asked) -> Figure:
    from cyclosweep.figures.ring import ring_figure

    return ring_figure(asked.drive(), crank_deg=asked.mesh_deg, output_torque_nm=asked.torque)


def _twist(asked: _Asked) -> Figure:
    from cyclosweep.figures.twist import twist_figure

    return twist_figure(asked.drive())


def _budget(asked: _Asked) -> Figure:
    from cyclosweep.choose.comparison import compare
    from cyclosweep.figures.budget import budget_figure

    compared = compare(asked.sources)
    for each in compared.figures:
        if (reason := each.drive.explain()) is not None:
            raise DesignError(f"{each.label}: {reason}")
    return budget_figure(compared.budget)


def _load_series(asked: _Asked) -> Figure:
    from cyclosweep.figures.series import load_series_figure

    return load_series_figure(asked.drive())


def _clearance_series(asked: _Asked) -> Figure:
    from cyclosweep.figures.series import clearance_series_figure

    return clearance_series_figure(asked.drive())


def _modes(asked: _Asked) -> Figure:
    from cyclosweep.figures.train import mode_shapes_figure

    drive = asked.drive()
    train = drive.train(load_inertia_kg_m2=asked.load_inertia)
    return mode_shapes_figure(train.modes(drive.nominal_torque_nm))


def _campbell(asked: _Asked) -> Figure:
    from cyclosweep.design.excitation import excitation_orders
    from cyclosweep.figures.train import campbell_figure

    drive = asked.drive()
    train = drive.train(load_inertia_kg_m2=asked.load_inertia)
    modes = train.modes(drive.nominal_torque_nm)
    return campbell_figure(modes, excitation_orders(drive), drive.input_speed_rpm)


def _pareto(asked: _Asked) -> Figure:
    from cyclosweep.figures.pareto import pareto_figure

    if not asked.objective:
        raise InputError("--objective: none, expected two, such as --objective twist_1tn_deg")
    return pareto_figure(
        asked.table(), asked.objective, limits=asked.limit or None, chosen=asked.variant
    )


def _parallel(asked: _Asked) -> Figure:
    from cyclosweep.figures.parallel import parallel_figure

    if not asked.column:
        raise InputError("--column: none, expected two to twelve, each as --column NAME")
    return parallel_figure(
        asked.table(),
        asked.column,
        colour=asked.colour,
        limits=asked.limit or None,
        chosen=asked.variant,
    )


def _response(asked: _Asked) -> Figure:
    from cyclosweep.figures.response import response_figure

    if asked.x is None or asked.y is None or asked.z is None:
        raise InputError("--x, --y, --z: expected a column each: two inputs and a result")
    return response_figure(
        asked.table(), asked.x, asked.y, asked.z, how=asked.how, limits=asked.limit or None
    )


_KINDS: dict[Kind, Callable[[_Asked], Figure]] = {
    "disc": _disc,
    "map": _map,
    "shares": _shares,
    "ring": _ring,
    "twist": _twist,
    "budget": _budget,
    "load-series": _load_series,
    "clearance-series": _clearance_series,
    "modes": _modes,
    "campbell": _campbell,
    "pareto": _pareto,
    "parallel": _parallel,
    "response": _response,
}
