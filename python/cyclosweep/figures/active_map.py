"""The map of active pins over a turn of the mesh zone (Figs. 7, 9 and 10)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np
import polars as pl

from cyclosweep.design.active_pins import ActivePins, Criterion
from cyclosweep.design.published_figures import MEAN_ACTIVE_PINS, is_paper_drive
from cyclosweep.figures.style import (
    BLUE,
    GREY,
    INK,
    SKY,
    VERMILION,
    new_figure,
    note,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cyclosweep.design.drive import Drive

__all__ = ["map_figure", "turn_axis"]

_ROW_MM = 3.6
"""Height of a hole's row [mm] where there are few."""

_MOST_ROWS_MM = 120.0
"""Height of all rows together [mm] where there are many."""


@styled
def map_figure(drive: Drive, *, criterion: Criterion | None = None) -> Figure:
    """Draw which holes push their pins over a turn of the mesh zone, and how many.

    Parameters
    ----------
    drive : Drive
        A drive whose holes cross the pins' circle.
    criterion : {"published-map", "inside", "statics"}, optional
        What counts as active; the drive's own by default.

    Returns
    -------
    matplotlib.figure.Figure
        Above: active contacts of all discs, the number on each stretch, the mean, and for the
        paper's drive the printed mean. Below: a bar (``gid`` ``window``) for each stretch over
        which a hole is active, H1 on top, the halves apart. By ``published-map`` one disc is
        drawn, which stands for all.

    Raises
    ------
    DesignError
        When no hole ever crosses the pins' circle.
    """
    rule = drive.criterion if criterion is None else criterion
    counts = drive.active_pins(rule)
    windows = drive.hole_windows(rule)
    if rule == "published-map":
        windows = windows.filter(pl.col("disc") == 1)
    discs = drive.disc_count if rule != "published-map" else 1
    rows = discs * drive.output_pin_count
    height = min(_ROW_MM * rows, _MOST_ROWS_MM)
    figure = new_figure(62.0 + height)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(34.0, height))
    _draw_counts(top, drive, counts)
    _draw_windows(bottom, drive, windows, discs)
    top.set_title(f"{drive.name}: active pins by {rule}")
    turn_axis(bottom)
    note(figure, " ".join(_said(drive, rule, counts, windows)))
    return figure


def _said(
    drive: Drive, rule: Criterion, counts: ActivePins, windows: pl.DataFrame
) -> Iterator[str]:
    """Sentences below the picture."""
    most = 0.5 * drive.disc_count * drive.output_pin_count
    discs = {1: "", 2: ", contacts of both discs"}.get(
        drive.disc_count, f", contacts of all {drive.disc_count} discs"
    )
    yield f"Mean {counts.mean:.4g} of {most:g}{discs}; torque transfer efficiency"
    yield f"{counts.torque_transfer_efficiency:.4g}; fewest {counts.minimum}, most"
    yield f"{counts.maximum}."
    if rule != "published-map":
        return
    if is_paper_drive(drive):
        opens = windows.filter(pl.col("hole") == 1)["start_deg"][0]
        yield f"H1 opens at {opens:.1f}°, printed 'almost 66°'."
        left = windows.filter(pl.col("half") == "left", pl.col("start_deg") < 180)
        together = left["start_deg"].max(), left["end_deg"].min()
        yield "All of the left half from {:.1f}° to {:.1f}°,".format(*together)
        yield "printed 'near 90°'."
    if drive.disc_count > 1:
        yield "Every disc has the windows of the first."
    yield "A reconstruction that matches the published map, not the authors' rule."


def turn_axis(panel: Axes) -> None:
    """Mark a panel's horizontal axis as one turn of the mesh zone.

    Parameters
    ----------
    panel : matplotlib.axes.Axes
        The panel.
    """
    panel.set_xlim(0, 360)
    panel.set_xticks(range(0, 361, 45))
    panel.set_xlabel("position of the mesh zone, clockwise from ring pin 0 [deg]")


def _draw_counts(panel: Axes, drive: Drive, counts: ActivePins) -> None:
    """Draw the number of active contacts as steps with the number on each."""
    sectors = counts.sectors
    edges = np.r_[sectors["start_deg"].to_numpy(), sectors["end_deg"].to_numpy()[-1]]
    active = sectors["active"].to_numpy()
    panel.stairs(active, edges, fill=True, color=SKY, alpha=0.45, gid="count")
    panel.stairs(active, edges, color=INK, linewidth=1.0, baseline=None)
    last, most = -1e9, int(active.max())
    for start, end, count in sectors.iter_rows():
        middle = 0.5 * (start + end)
        # A number needs about nine degrees of a single column.
        if end - start >= 9 and middle - last >= 9:
            panel.text(middle, count - 0.02 * most, f"{count}", ha="center", va="top", fontsize=7)
            last = middle
    panel.axhline(counts.mean, color=BLUE, linewidth=1.0, label=f"mean {counts.mean:.4g}")
    if is_paper_drive(drive):
        panel.axhline(
            MEAN_ACTIVE_PINS, color=VERMILION, linewidth=1.0, linestyle="--",
            label=f"mean printed, {MEAN_ACTIVE_PINS:g}",
        )  # fmt: skip
    panel.set_ylim(0, 1.08 * max(most, 1))
    step = max(1, -(-most // 5)) if most % 2 else max(2, 2 * -(-most // 10))
    panel.set_yticks(range(0, most + 1, step))
    panel.set_ylabel("active pins [1]")
    panel.legend(loc="lower center", ncols=2, frameon=True, facecolor="white", edgecolor="none",
                 framealpha=0.9)  # fmt: skip


def _draw_windows(panel: Axes, drive: Drive, windows: pl.DataFrame, discs: int) -> None:
    """Draw a bar for each stretch over which a hole is active, H1 on top."""
    pins = drive.output_pin_count
    for disc, hole, half, start, end in windows.select(
        "disc", "hole", "half", "start_deg", "end_deg"
    ).iter_rows():
        row = (disc - 1) * pins + hole - 1
        colour = BLUE if half == "left" else SKY
        panel.barh(row, end - start, left=start, height=0.72, color=colour, gid="window")
    rows = pins * discs
    names = [
        f"H{hole}" if discs == 1 else f"{disc}: H{hole}"
        for disc in range(1, discs + 1)
        for hole in range(1, pins + 1)
    ]
    step = -(-rows // 40)
    panel.set_yticks(range(0, rows, step), names[::step])
    panel.set_ylim(rows - 0.4, -0.6)
    panel.set_ylabel("hole" if discs == 1 else "disc: hole")
    left = windows.filter(pl.col("half") == "left")["hole"].n_unique()
    for disc in range(discs):
        panel.axhline(disc * pins + left - 0.5, color=GREY, linewidth=0.5, linestyle=":")
        if disc:
            panel.axhline(disc * pins - 0.5, color=INK, linewidth=0.8)
    if discs == 1:
        for place, text in ((left / 2 - 0.5, "left half"), ((left + pins) / 2 - 0.5, "right half")):
            panel.annotate(
                text, (1.01, place), xycoords=("axes fraction", "data"), rotation=270,
                ha="left", va="center", fontsize=6.5,
            )  # fmt: skip
    panel.grid(axis="x")
