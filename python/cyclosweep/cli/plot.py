"""`cyclosweep plot`."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import typer

from cyclosweep.cli.output import fail
from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Kind = Literal["disc", "map", "twist"]


class _Asked(NamedTuple):
    """What the command line says of a picture.

    Attributes
    ----------
    sources : tuple of str
        Drives or tables.
    criterion : str or None
        What counts as active.
    mesh_deg, hole
        Position of the mesh zone [deg], number of the hole.
    """

    sources: tuple[str, ...]
    criterion: Literal["published-map", "inside", "statics"] | None
    mesh_deg: float
    hole: int


def plot(
    kind: Annotated[Kind, typer.Argument(help="Which picture.")],
    source: Annotated[list[str], typer.Argument(metavar="SOURCE...", help="Drive, .toml.")],
    out: Annotated[
        Path, typer.Option("--out", metavar="FILE", help="Picture: .png, .svg or .pdf.")
    ],
    criterion: Annotated[
        Literal["published-map", "inside", "statics"] | None,
        typer.Option(help="What counts as an active pin; the drive's own by default."),
    ] = None,
    mesh_deg: Annotated[
        float, typer.Option("--mesh-deg", help="Position of the mesh zone [deg].")
    ] = 45.0,
    hole: Annotated[int, typer.Option(help="Hole whose path is drawn, from 1.")] = 1,
    dpi: Annotated[float, typer.Option(help="Dots of a PNG in an inch.")] = 300.0,
) -> None:
    """Draw a picture of a drive or of a study.

    disc: disc, holes and pins, path of a hole with its active arcs. map: active pins over a turn
    of the mesh zone. twist: twist against load with the free play.
    """
    if not 20 <= dpi <= 2400:
        raise InputError(f"--dpi: found {dpi:g}, expected 20 to 2400")
    _refuse(out, source)
    from cyclosweep.figures.style import save

    figure = _KINDS[kind](_Asked(tuple(source), criterion, mesh_deg, hole))
    try:
        save(figure, out, dpi)
    except OSError as error:
        fail(f"{out}: {error.strerror or error}", 1)
    print(out)


def _refuse(out: Path, sources: list[str]) -> None:
    """Refuse a file that cannot be written before anything is computed."""
    for source in sources:
        if Path(source).exists() and out.exists() and out.samefile(source):
            raise InputError(f"--out: found {out}, which is read, expected another file")
    if out.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"--out: found {out}, expected a file ending in .png, .svg or .pdf")
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"--out: found {out}, expected a file in a folder that exists")


def _disc(asked: _Asked) -> Figure:
    from cyclosweep.design.drive import Drive
    from cyclosweep.figures.disc import disc_figure

    drive = Drive.load(_one(asked))
    return disc_figure(drive, mesh_deg=asked.mesh_deg, hole=asked.hole, criterion=asked.criterion)


def _map(asked: _Asked) -> Figure:
    from cyclosweep.design.drive import Drive
    from cyclosweep.figures.active_map import map_figure

    return map_figure(Drive.load(_one(asked)), criterion=asked.criterion)


def _twist(asked: _Asked) -> Figure:
    from cyclosweep.design.drive import Drive
    from cyclosweep.figures.twist import twist_figure

    return twist_figure(Drive.load(_one(asked)))


def _one(asked: _Asked) -> str:
    if len(asked.sources) != 1:
        raise InputError(f"SOURCE: found {len(asked.sources)} drives, expected one")
    return asked.sources[0]


_KINDS: dict[Kind, Callable[[_Asked], Figure]] = {"disc": _disc, "map": _map, "twist": _twist}
