"""The figures of a report as PNG files, by matplotlib (extra ``report``)."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from cyclosweep.atomic import unfinished
from cyclosweep.errors import InputError, require_matplotlib
from cyclosweep.report.charts import (
    REGION,
    Band,
    Cells,
    Figure,
    Line,
    Panel,
    Placed,
    Points,
    extent,
)
from cyclosweep.report.data import ReportData
from cyclosweep.report.figures import all_figures
from cyclosweep.report.svg import WIDTH, diverging

if TYPE_CHECKING:
    from matplotlib.axes import Axes

DOTS_PER_INCH = 150
LINE = 16
"""Height of a line of the caption [hundredths of an inch]."""
CAPTION_COLUMNS = 190
"""Letters in a line of the caption."""


def write_png(data: ReportData, folder: str | Path) -> list[Path]:
    """Write every figure of the report as a PNG file.

    Parameters
    ----------
    data : ReportData
        What to report.
    folder : path
        Folder for ``loop.png``, ``zoom.png``, ``profiles.png``, ``map.png``; made if absent.

    Returns
    -------
    list of Path
        The files, the main picture first.

    Raises
    ------
    InputError
        matplotlib is not installed.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    return [_write(figure, folder / f"{figure.key}.png") for figure in all_figures(data)]


def write_main_png(data: ReportData, path: str | Path) -> Path:
    """Write the main picture as a PNG file.

    Parameters
    ----------
    data : ReportData
        What to report.
    path : path
        File to write; it appears whole or not at all.

    Raises
    ------
    InputError
        The recording has no samples to draw, or matplotlib is not installed.
    """
    figures = all_figures(data)
    if not figures:
        raise InputError(f"{path}: no picture, as {data.recording.name} has no angles to draw")
    return _write(figures[0], Path(path))


def _write(figure: Figure, path: Path) -> Path:
    """Draw one figure without a display and without touching pyplot's state."""
    require_matplotlib()
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure as Canvas

    lines = wrap(figure.caption, CAPTION_COLUMNS)
    drawn, caption = figure.rows * figure.row_height + 44, LINE * max(len(lines), 1) + 4
    canvas = Canvas(figsize=(WIDTH / 100, (drawn + caption) / 100), layout="constrained")
    FigureCanvasAgg(canvas)
    # A part of its own for the caption, which the legend would else be drawn over.
    parts = canvas.add_gridspec(2, 1, height_ratios=[drawn, caption])
    pictures, foot = canvas.add_subfigure(parts[0]), canvas.add_subfigure(parts[1])
    grid = pictures.add_gridspec(figure.rows, figure.columns)
    handles: dict[str, Any] = {}
    for placed in figure.panels:
        axes = pictures.add_subplot(grid[_cells_of(placed)])
        _panel(axes, placed.panel)
        names = axes.get_legend_handles_labels()
        for handle, name in zip(*names, strict=True):
            handles.setdefault(name, handle)
    pictures.suptitle(figure.title, fontsize=11, fontweight="bold")
    top = 1.0 - 4 / caption
    foot.text(0.01, top, "\n".join(lines), fontsize=7.5, color="#5c6672", va="top")
    if handles:
        pictures.legend(
            handles.values(), handles.keys(), loc="outside lower center", ncols=len(handles),
            fontsize=8, frameon=False, markerscale=3,
        )  # fmt: skip
    with unfinished(path) as file:
        canvas.savefig(file, dpi=DOTS_PER_INCH, format="png")
    return path


def _cells_of(placed: Placed) -> tuple[slice, slice]:
    """Grid cells of a panel."""
    row, column = int(placed.row), int(placed.column)
    return slice(row, row + int(placed.rows)), slice(column, column + int(placed.columns))


def _panel(axes: Axes, panel: Panel) -> None:
    """Draw one pair of axes."""
    axes.set_title(panel.title, fontsize=9, loc="left", fontweight="bold")
    axes.set_xlabel(panel.x_label, fontsize=8)
    axes.set_ylabel(panel.y_label, fontsize=8)
    axes.tick_params(labelsize=8, colors="#5c6672", labelcolor="#3b444f")
    if not panel.y_names:
        axes.grid(color="#e9edf1", linewidth=0.8)
    axes.set_axisbelow(True)
    for spine in axes.spines.values():
        spine.set_color("#b9c1ca")
    for k, span in enumerate(panel.spans):
        axes.axvspan(
            span.low, span.high, color=REGION, alpha=0.22, lw=0,
            label="_" if k else "located region",
        )  # fmt: skip
        if span.label:
            middle = (span.low + span.high) / 2
            axes.annotate(
                span.label, (middle, 1.0), xycoords=("data", "axes fraction"), xytext=(0, -10),
                textcoords="offset points", ha="center", fontsize=7.5, color="#6b4e00",
            )  # fmt: skip
    if panel.zero_line:
        axes.axhline(0, color="#8a93a0", linewidth=0.8)
    for series in panel.series:
        _series(axes, series)
    axes.set_xlim(extent(panel, "x"))
    axes.set_ylim(extent(panel, "y"))
    if panel.x_names:
        axes.set_xticks([x for x, _ in panel.x_names], [name for _, name in panel.x_names])
    if panel.y_names:
        axes.set_yticks([y for y, _ in panel.y_names], [name for _, name in panel.y_names])
    if panel.right_factor:
        right = axes.secondary_yaxis("right", functions=_scaling(panel.right_factor))
        right.set_ylabel(panel.right_label, fontsize=8)
        right.tick_params(labelsize=8, colors="#5c6672")


def _scaling(factor: float) -> tuple[Callable[[Any], Any], Callable[[Any], Any]]:
    """To the right scale and back."""
    return lambda y: y * factor, lambda y: y / factor


def _series(axes: Axes, series: Line | Points | Band | Cells) -> None:
    """Draw one series."""
    match series:
        case Line():
            style = "--" if series.dashed else "-"
            axes.plot(
                series.x, series.y, style, color=series.colour, linewidth=series.width * 0.8,
                label=series.name,
            )  # fmt: skip
        case Points():
            face = "white" if series.hollow else series.colour
            axes.plot(
                series.x, series.y, "o", markersize=series.size * 1.2, markerfacecolor=face,
                markeredgecolor=series.colour, markeredgewidth=1.0 if series.hollow else 0,
                linestyle="none", label=series.name,
            )  # fmt: skip
        case Band():
            axes.fill_between(
                series.x, series.low, series.high, color=series.colour, alpha=0.16, lw=0,
                label=series.name,
            )  # fmt: skip
        case Cells():
            _cells(axes, series)


def _cells(axes: Axes, series: Cells) -> None:
    """Draw a map of cells, row 0 at the top."""
    rows = len(series.values)
    for row in range(rows):
        y = rows - 1 - row
        for column, value in enumerate(series.values[row]):
            low, high = series.x_edges[column], series.x_edges[column + 1]
            if np.isfinite(value):
                colour = diverging(float(value) / series.limit)
                axes.fill_between([low, high], y - 0.48, y + 0.48, color=colour, lw=0)
            if series.marked[row, column]:
                axes.plot((low + high) / 2, y, ".", color="#1d232b", markersize=4)
