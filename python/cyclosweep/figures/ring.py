"""Forces of the loaded ring pins, as lines on the ring and over the pins' positions."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cyclosweep.errors import InputError
from cyclosweep.figures.style import (
    COLOURS,
    FAINT,
    GREY,
    INK,
    new_figure,
    note,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = ["ring_figure"]

Reals = npt.NDArray[np.float64]

_LONGEST = 0.42
"""Length of the largest force over the ring pins' circle radius [1]."""


@styled
def ring_figure(
    drive: Drive, *, crank_deg: float = 0.0, output_torque_nm: float | None = None
) -> Figure:
    """Draw the forces of all discs on the ring pins by the component model.

    Parameters
    ----------
    drive : Drive
        A drive with a component model.
    crank_deg : float
        Angle of the crank [deg], clockwise from ring pin 0.
    output_torque_nm : float, optional
        Load [N m], rated by default.

    Returns
    -------
    matplotlib.figure.Figure
        Above: a line from each loaded ring pin along the force on it, all at one scale, ring pin 0
        on top. Below: forces over the pins' positions (``gid`` ``force``).

    Raises
    ------
    DesignError
        When the drive cannot be built or has no component model.
    InputError
        For an angle or a load that is no such number.
    """
    if not math.isfinite(crank_deg):
        raise InputError(f"crank_deg: found {crank_deg:g}, expected a finite number")
    state = drive.loaded(output_torque_nm, math.radians(crank_deg))
    forces = np.abs(state.ring_pin_forces_n)
    figure = new_figure(128.0)
    top, bottom = figure.subplots(2, 1, height_ratios=(2.3, 1))
    _draw_ring(top, drive, math.radians(crank_deg), forces)
    pitch = 360 / (drive.ratio + 1)
    for disc, each in enumerate(forces):
        at = np.flatnonzero(each > 0)
        bottom.vlines(at * pitch, 0, each[at], color=COLOURS[disc], linewidth=1.2, gid="force")
        bottom.plot(
            at * pitch, each[at], "os^D"[disc], color=COLOURS[disc], markersize=2.6,
            label=f"disc {disc + 1}: {len(at)} pins", linestyle="none",
        )  # fmt: skip
    bottom.set_xlim(-4, 364)
    bottom.set_xticks(range(0, 361, 45))
    bottom.set_ylim(bottom=0, top=1.3 * forces.max())
    bottom.set_xlabel("position of the ring pin, clockwise from ring pin 0 [deg]")
    bottom.set_ylabel("force [N]")
    bottom.legend(loc="upper center", ncols=drive.disc_count, columnspacing=1)
    torque = drive.output_torque_nm if output_torque_nm is None else output_torque_nm
    top.set_title(f"{drive.name}: ring pins at {torque:.4g} N m")
    note(
        figure,
        f"Component model, crank at {crank_deg:g}°. Arrows: eccentricity of each disc. Largest "
        f"force {forces.max():.4g} N, {int((forces > 0).any(axis=0).sum())} of {drive.ratio + 1} "
        "pins loaded.",
    )
    return figure


def _draw_ring(panel: Axes, drive: Drive, crank_rad: float, forces: Reals) -> None:
    """Draw the ring with a line along the force on each pin."""
    from matplotlib.collections import LineCollection, PatchCollection
    from matplotlib.patches import Circle

    ring, e, pins = drive.ring_pin_circle_radius_mm, drive.eccentricity_mm, drive.ratio + 1
    at = math.tau * np.arange(pins) / pins
    centres = ring * np.column_stack([np.cos(at), np.sin(at)])
    radius = drive.ring_pin_radius_mm or 0.0
    patches = [Circle((y, x), radius) for x, y in centres]
    panel.add_collection(PatchCollection(patches, facecolor=FAINT, edgecolor=GREY, linewidth=0.3))
    scale = _LONGEST * ring / forces.max()
    reach = ring
    for disc, each in enumerate(forces):
        theta = crank_rad + math.tau * disc / drive.disc_count
        unit = np.array([math.cos(theta), math.sin(theta)])
        away = centres - e * pins * unit
        away /= np.linalg.norm(away, axis=1, keepdims=True)
        loaded = np.flatnonzero(each > 0)
        # From the pin's centre, along the force of the disc on it, away from the pitch point.
        ends = centres[loaded] + scale * each[loaded, None] * away[loaded]
        reach = max(reach, float(np.abs(ends).max()))
        lines = np.stack([centres[loaded][:, ::-1], ends[:, ::-1]], axis=1)
        drawn = LineCollection(list(lines), colors=COLOURS[disc], linewidths=1.1)
        drawn.set_gid(f"forces-{disc + 1}")
        panel.add_collection(drawn)
        panel.annotate(
            "", xy=(0.5 * ring * unit[1], 0.5 * ring * unit[0]), xytext=(0, 0),
            arrowprops={"arrowstyle": "-|>", "color": COLOURS[disc], "lw": 1.4, "shrinkA": 0},
        )  # fmt: skip
        panel.text(0.6 * ring * unit[1], 0.6 * ring * unit[0], f"disc {disc + 1}", ha="center",
                   va="center", fontsize=6.5)  # fmt: skip
    panel.plot(0, 0, "+", color=INK, markersize=5, markeredgewidth=0.6)
    panel.plot(centres[0, 1], centres[0, 0], "o", color=INK, markersize=2.5)
    rounded = _round(0.5 * forces.max())
    length = scale * rounded
    reach *= 1.06
    left, low = -reach, -reach
    panel.plot([left, left + length], [low, low], color=INK, linewidth=1.6, solid_capstyle="butt")
    panel.text(left, low + 0.04 * ring, f"{rounded:g} N", va="bottom", fontsize=6.5)
    panel.set_aspect("equal")
    panel.set_xlim(-1.02 * reach, 1.02 * reach)
    panel.set_ylim(-1.04 * reach, 1.02 * reach)
    panel.set_axis_off()


def _round(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten up to a value."""
    magnitude = 10.0 ** math.floor(math.log10(value))
    return max(step * magnitude for step in (1, 2, 5) if step * magnitude <= value)
