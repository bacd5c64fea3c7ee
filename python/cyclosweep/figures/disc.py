"""The disc with its holes and pins, and the path of one hole with its active arcs (Fig. 8)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.design.active_pins import Criterion
from cyclosweep.design.disc_profile import disc_profile
from cyclosweep.errors import DesignError, InputError
from cyclosweep.figures.style import (
    BLUE,
    FAINT,
    GREY,
    INK,
    ORANGE,
    above,
    new_figure,
    note,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = ["disc_figure"]

Reals = npt.NDArray[np.float64]

_MOST_LABELS = 16
"""Output pins up to which each carries its hole's name: more would overlap."""

_CHORD_ERROR = 5e-5
"""Largest distance of the drawn outline from the profile, in radii of the ring pins' circle: on
paper 0.002 mm, less than a tenth of a dot at 900 dpi."""

_ARC_POINTS = 241
"""Points of a drawn arc, its ends included."""


@styled
def disc_figure(
    drive: Drive,
    *,
    mesh_deg: float = 45.0,
    hole: int = 1,
    criterion: Criterion | None = None,
) -> Figure:
    """Draw disc 1 with its holes and pins, and one hole's path with its active arcs.

    Parameters
    ----------
    drive : Drive
        A drive that can be built.
    mesh_deg : float
        Position of the mesh zone in the upper panel [deg], clockwise from ring pin 0.
    hole : int
        Hole whose path the lower panel shows; H1 is that of the left half nearest ring pin 0.
    criterion : {"published-map", "inside", "statics"}, optional
        What counts as active; the drive's own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Above: ring pin 0 on top, angles clockwise, to scale; full pins are active at that
        position. Below: the hypotrochoid of the hole's centre unrolled along the pins' circle,
        one turn of the mesh zone dark, its active arcs thick (``gid`` ``active-arc``).

    Raises
    ------
    DesignError
        When the drive cannot be built.
    InputError
        For a hole or an angle that is not there.

    Notes
    -----
    Where the ring pins' radius is given, the first hole stands at ``hole_clocking_deg``, as in the
    component model and in what :mod:`cyclosweep.cad` writes; without it half a pitch further, as in
    the published model. What is active is then by the rule applied to the holes that are drawn.
    """
    if (reason := drive.explain()) is not None:
        raise DesignError(f"{drive.name}: {reason}")
    if not math.isfinite(mesh_deg):
        raise InputError(f"mesh_deg: found {mesh_deg:g}, expected a finite number")
    if not 1 <= hole <= drive.output_pin_count:
        raise InputError(f"hole: found {hole}, expected 1 to {drive.output_pin_count}")
    rule = drive.criterion if criterion is None else criterion
    if drive.ring_pin_radius_mm is not None:
        # Cut, drawn and solved by the component model half a pitch from the published pattern.
        clocking = drive.hole_clocking_deg - 180 / drive.output_pin_count
        drive = drive.replace(hole_clocking_deg=clocking)
    windows = drive.hole_windows(rule).filter(pl.col("disc") == 1)
    figure = new_figure(142.0)
    top, bottom = figure.subplots(2, 1, height_ratios=(2.6, 1))
    has_profile = _draw_disc(top, drive, mesh_deg % 360.0, windows)
    _draw_path(bottom, drive, hole, windows)
    top.set_title(f"{drive.name}: disc 1, mesh zone at {mesh_deg:g}°")
    bottom.set_title(f"Path of hole H{hole}'s centre: {rule}", pad=15)
    text = (
        f"Ring pin 0 on top, angles clockwise. e = {drive.eccentricity_mm:g} mm, holes "
        f"{_hole_diameter(drive):.4g} mm, pins {drive.output_pin_diameter_mm:g} mm."
    )
    if has_profile:
        text += " Holes as cut: those of the published model stand half a pitch further."
    else:
        text += " The ring pins' radius is not given: the root circle stands for the profile."
    note(figure, text)
    return figure


def _hole_diameter(drive: Drive) -> float:
    """Diameter of a hole [mm], clearance included."""
    clearance = drive.hole_clearance_mm or 0.0
    bushed = drive.output_pin_diameter_mm + 2 * drive.bush_wall_mm
    return bushed + 2 * (drive.eccentricity_mm + clearance)


def _seen(points: Reals) -> tuple[Reals, Reals]:
    """Across and up of points along and across ring pin 0: that pin on top, angles clockwise."""
    return points[:, 1], points[:, 0]


def _unit(angle_rad: float) -> Reals:
    return np.array([math.cos(angle_rad), math.sin(angle_rad)])


def _draw_disc(panel: Axes, drive: Drive, mesh_deg: float, windows: pl.DataFrame) -> bool:
    """Draw disc 1 in its ring; return whether its profile could be drawn."""
    from matplotlib.patches import Circle

    theta = math.radians(mesh_deg)
    turned = -theta / drive.ratio
    centre = drive.eccentricity_mm * _unit(theta)
    ring, pin_radius = drive.ring_pin_circle_radius_mm, drive.ring_pin_radius_mm

    def circle(at: Reals, radius: float, **look: Any) -> None:
        panel.add_patch(Circle((at[1], at[0]), radius, **look))

    outline = _outline(drive)
    if outline is None:
        circle(centre, drive.disc_outer_radius_mm, facecolor="#eef1f4", edgecolor=INK)
    else:
        spin = np.array(
            [[math.cos(turned), math.sin(turned)], [-math.sin(turned), math.cos(turned)]]
        )
        across, up = _seen(outline @ spin + centre)
        panel.fill(across, up, facecolor="#eef1f4", edgecolor=INK, linewidth=0.6, gid="profile")
    circle(centre, drive.disc_bore_radius_mm, facecolor="white", edgecolor=INK)
    pitch = math.tau / (drive.ratio + 1)
    for k in range(drive.ratio + 1):
        at = ring * _unit(k * pitch)
        look = {"facecolor": INK if k == 0 else FAINT, "edgecolor": GREY, "linewidth": 0.3}
        circle(at, pin_radius or 0.25 * pitch * ring, **look)
    origin = np.zeros(2)
    look_line = {"fill": False, "edgecolor": GREY, "linewidth": 0.5, "linestyle": (0, (6, 2, 1, 2))}
    circle(origin, drive.output_pin_circle_radius_mm, **look_line)
    _draw_holes(panel, drive, theta, windows)
    panel.plot(0, 0, "+", color=INK, markersize=5, markeredgewidth=0.6)
    outside = ring + (pin_radius or 0.25 * pitch * ring)
    arrow = _unit(theta)
    panel.annotate(
        "",
        xy=(1.10 * outside * arrow[1], 1.10 * outside * arrow[0]),
        xytext=(1.01 * outside * arrow[1], 1.01 * outside * arrow[0]),
        arrowprops={"arrowstyle": "-|>", "color": ORANGE, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
    )
    panel.text(
        1.14 * outside * arrow[1],
        1.14 * outside * arrow[0],
        "mesh zone",
        ha="left" if arrow[1] > 0.15 else "right" if arrow[1] < -0.15 else "center",
        va="bottom" if arrow[0] > 0 else "top",
        fontsize=6.5,
    )
    panel.set_aspect("equal")
    panel.set_xlim(-1.2 * outside, 1.2 * outside)
    panel.set_ylim(-1.12 * outside, 1.16 * outside)
    panel.set_xlabel("across ring pin 0 [mm]")
    panel.set_ylabel("along ring pin 0 [mm]")
    return outline is not None


def _outline(drive: Drive) -> Reals | None:
    """Profile of a disc about its own centre; None where the ring pins' radius is not given."""
    if drive.ring_pin_radius_mm is None:
        return None
    return disc_profile(
        drive.ratio,
        ring_pin_circle_radius_mm=drive.ring_pin_circle_radius_mm,
        ring_pin_radius_mm=drive.ring_pin_radius_mm,
        eccentricity_mm=drive.eccentricity_mm,
        chord_error_mm=_CHORD_ERROR * drive.ring_pin_circle_radius_mm,
    )


def _draw_holes(panel: Axes, drive: Drive, theta: float, windows: pl.DataFrame) -> None:
    """Draw holes, bushes and pins, active pins filled."""
    from matplotlib.patches import Circle

    turn = math.degrees(theta)
    active = set(
        windows.filter(pl.col("start_deg") <= turn, pl.col("end_deg") > turn)["index"].to_list()
    )
    number = _numbers(drive)
    count = drive.output_pin_count
    bushed = 0.5 * drive.output_pin_diameter_mm + drive.bush_wall_mm
    for index in range(count):
        centre = drive.hole_locus([turn], index).select("x_mm", "y_mm").to_numpy()[0]
        pin = centre - drive.eccentricity_mm * _unit(theta)
        hole = Circle((centre[1], centre[0]), 0.5 * _hole_diameter(drive))
        hole.set(facecolor="white", edgecolor=INK, linewidth=0.6)
        panel.add_patch(hole)
        if drive.bush_wall_mm > 0:
            bush = Circle((pin[1], pin[0]), bushed)
            bush.set(facecolor="white", edgecolor=GREY, linewidth=0.5)
            panel.add_patch(bush)
        is_active = index in active
        shaft = Circle((pin[1], pin[0]), 0.5 * drive.output_pin_diameter_mm)
        shaft.set(facecolor=BLUE if is_active else FAINT, edgecolor=INK, linewidth=0.5)
        shaft.set_gid("active-pin" if is_active else "idle-pin")
        panel.add_patch(shaft)
        if drive.output_pin_bore_mm > 0:
            bore = Circle((pin[1], pin[0]), 0.5 * drive.output_pin_bore_mm)
            bore.set(facecolor="white", edgecolor=INK, linewidth=0.4)
            panel.add_patch(bore)
        if count <= _MOST_LABELS and drive.output_pin_bore_mm == 0:
            panel.text(
                pin[1], pin[0], f"H{number[index]}", ha="center", va="center_baseline",
                fontsize=_label_size(drive), color="white" if is_active else INK,
            )  # fmt: skip


def _label_size(drive: Drive) -> float:
    """Size of type that fits into a pin [pt], three letters wide."""
    of_panel = drive.output_pin_diameter_mm / (2.4 * drive.ring_pin_circle_radius_mm)
    return min(6.5, 75.0 * of_panel * 72 / 25.4 / 2.1)


def _numbers(drive: Drive) -> dict[int, int]:
    """Number of each hole by its index; statics make every hole active once a turn."""
    table = drive.hole_windows("statics").unique(["index"])
    return dict(table.select("index", "hole").iter_rows())


def _draw_path(panel: Axes, drive: Drive, hole: int, windows: pl.DataFrame) -> None:
    """Draw a hole's path about the pins' circle, unrolled where the hole runs."""
    index = next(place for place, number in _numbers(drive).items() if number == hole)
    radius = drive.output_pin_circle_radius_mm
    standing = math.radians(drive.hole_clocking_deg + (index + 0.5) * 360 / drive.output_pin_count)

    def unrolled(theta_deg: Reals) -> tuple[Reals, Reals]:
        path = drive.hole_locus(theta_deg, index)
        mean = standing - np.radians(theta_deg) / drive.ratio
        angle = np.arctan2(path["y_mm"].to_numpy(), path["x_mm"].to_numpy())
        off = (angle - mean + math.pi) % math.tau - math.pi
        return radius * (mean - standing + off), path["radius_mm"].to_numpy() - radius

    beyond = 0.45 * 360
    panel.axhline(0, color=GREY, linewidth=0.6, linestyle=(0, (6, 2, 1, 2)), label="pins' circle")
    panel.plot(*unrolled(np.linspace(-beyond, 360 + beyond, 961)), color=FAINT, linewidth=0.9)
    panel.plot(
        *unrolled(np.linspace(0, 360, 721)), color=INK, linewidth=0.9, label="one turn",
        gid="path",
    )  # fmt: skip
    chosen = windows.filter(pl.col("hole") == hole)
    for k, (start, end) in enumerate(chosen.select("start_deg", "end_deg").iter_rows()):
        panel.plot(
            *unrolled(np.linspace(start, end, _ARC_POINTS)), color=BLUE, linewidth=3.0,
            solid_capstyle="butt", gid="active-arc", label="active" if k == 0 else None,
        )  # fmt: skip
    for turn in (0.0, 90.0, 180.0, 270.0, 360.0):
        at, up = (values[0] for values in unrolled(np.array([turn])))
        panel.plot(at, up, "o", color=INK, markersize=2.5)
        middle = -radius * math.radians(turn) / drive.ratio
        outwards = 8 * np.array([at - middle, up]) / math.hypot(at - middle, up)
        panel.annotate(
            f"{turn:g}°", (at, up), xytext=tuple(outwards), textcoords="offset points",
            fontsize=6, ha="right" if outwards[0] < -4 else "left" if outwards[0] > 4 else "center",
            va="center",
        )  # fmt: skip
    panel.set_xlabel("along the pins' circle [mm]")
    panel.set_ylabel("outwards of it [mm]")
    panel.margins(x=0.02, y=0.28)
    above(panel, columns=3)
