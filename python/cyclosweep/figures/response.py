"""A result over two inputs as a map."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cyclosweep.explore.tables import Conditions, Table
from cyclosweep.figures.rows import How, cells_of
from cyclosweep.figures.style import INK, SEQUENTIAL, new_figure, note, styled
from cyclosweep.figures.words import axis_label

if TYPE_CHECKING:
    from matplotlib.axis import Axis
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

__all__ = ["response_figure"]

Reals = npt.NDArray[np.float64]

_TICKS = (6, 4, 3, 2, 1)
"""Steps between ticks that are tried, the most that stand apart are taken."""
_LABEL_GAP = 0.5
"""Least distance between two labels of ticks, in their height."""


@styled
def response_figure(
    table: Table,
    x: str,
    y: str,
    result: str,
    *,
    how: How = "mean",
    limits: Conditions | None = None,
) -> Figure:
    """Draw a result over two inputs as a map with contours.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    x, y, result : str
        Columns or expressions of columns.
    how : {"mean", "min", "max"}
        How variants that differ in other inputs are put together.
    limits : mapping, sequence of str or str, optional
        Conditions that a variant must meet.

    Returns
    -------
    matplotlib.figure.Figure
        Contours where every point or cell has a variant, coloured cells otherwise (``gid``
        ``cells``).

    Raises
    ------
    InputError
        For an unknown column or an input that does not vary.
    """
    cells = cells_of(table, x, y, result, how=how, limits=limits)
    figure = new_figure(76.0)
    panel = figure.subplots()
    filled = np.isfinite(cells.values)
    if filled.all() and min(cells.values.shape) >= 3 and np.ptp(cells.values) > 0:
        shade = panel.contourf(cells.x, cells.y, cells.values, levels=12, cmap=SEQUENTIAL)
        lines = panel.contour(
            cells.x,
            cells.y,
            cells.values,
            levels=np.asarray(shade.levels)[::2],
            colors="white",
            linewidths=0.6,
        )
        panel.clabel(lines, fontsize=6, fmt="%.4g")
        mappable: ScalarMappable = shade
    else:
        mappable = panel.pcolormesh(
            cells.x, cells.y, np.ma.masked_invalid(cells.values), cmap=SEQUENTIAL,
            shading="nearest", gid="cells", rasterized=True,
        )  # fmt: skip
    if cells.is_exact and cells.counts.size <= 400:
        at = np.argwhere(cells.counts > 0)
        panel.plot(cells.x[at[:, 1]], cells.y[at[:, 0]], ".", color=INK, markersize=1.2)
    bar = figure.colorbar(mappable, ax=panel, pad=0.02)
    bar.set_label(axis_label(result))
    panel.set_xlabel(axis_label(x))
    panel.set_ylabel(axis_label(y))
    note(figure, cells.said)
    _set_ticks(figure, panel.xaxis, cells.x)
    _set_ticks(figure, panel.yaxis, cells.y)
    return figure


def _set_ticks(figure: Figure, axis: Axis, values: Reals) -> None:
    """Set ticks among the values that there are, so few that their labels stand apart.

    Cells reach half a step beyond the outermost values, where a length might be below zero.
    """
    from matplotlib.ticker import MaxNLocator

    low, high = float(values[0]), float(values[-1])
    rounding = 1e-9 * (high - low)
    for most in _TICKS:
        ticks = np.asarray(MaxNLocator(most).tick_values(low, high))
        axis.set_ticks(ticks[(ticks >= low - rounding) & (ticks <= high + rounding)])
        figure.draw_without_rendering()
        boxes = [label.get_window_extent() for label in axis.get_ticklabels()]
        gap = _LABEL_GAP * boxes[0].height
        if not any(a.padded(gap / 2).overlaps(b.padded(gap / 2)) for a, b in pairwise(boxes)):
            break
