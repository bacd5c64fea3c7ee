"""Variants over two objectives with their Pareto front."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.explore.pareto import objectives_of, pareto_front
from cyclosweep.explore.tables import Conditions, Table, open_table
from cyclosweep.figures.rows import Sample, rows_of, sample_of
from cyclosweep.figures.style import BLUE, INK, VERMILION, new_figure, note, styled
from cyclosweep.figures.words import axis_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["MOST_POINTS", "ParetoData", "pareto_data", "pareto_figure"]

MOST_POINTS = 4000
"""Variants drawn behind a Pareto front: more would only blacken the picture."""

Reals = npt.NDArray[np.float64]


class ParetoData:
    """What a Pareto scatter shows.

    Attributes
    ----------
    x, y : str
        The objectives.
    maximise : tuple of bool
        Whether more of each is better.
    sample : Sample
        Variants behind the front.
    front : polars.DataFrame
        Variants of the front, ascending in `x`.
    """

    def __init__(
        self, x: str, y: str, maximise: tuple[bool, bool], sample: Sample, front: pl.DataFrame
    ) -> None:
        self.x, self.y, self.maximise = x, y, maximise
        self.sample, self.front = sample, front

    @property
    def said(self) -> str:
        """What a picture has to say of it."""
        return f"{self.sample.said} The front: {self.front.height:,} of all."

    def label(self, axis: int) -> str:
        """Label of an axis with its better direction."""
        name = (self.x, self.y)[axis]
        return f"{axis_label(name)}, {'more' if self.maximise[axis] else 'less'} is better"

    def stairs(self) -> tuple[Reals, Reals]:
        """Corners of the line that bounds what can be reached."""
        x, y = self.front[self.x].to_numpy(), self.front[self.y].to_numpy()
        # Between two variants of the front only the worse of both can be had.
        corners_x = np.repeat(x, 2)
        corners_y = np.repeat(y, 2)
        if self.maximise[0]:
            return corners_x[:-1], corners_y[1:]
        return corners_x[1:], corners_y[:-1]


def pareto_data(
    table: Table,
    objectives: Sequence[str],
    *,
    limits: Conditions | None = None,
    front: pl.DataFrame | None = None,
    most: int = MOST_POINTS,
) -> ParetoData:
    """Read what a Pareto scatter shows from a table of any size.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    objectives : sequence of str
        Two, each a column or expression, minimised unless ``max`` stands before it.
    limits : mapping, sequence of str or str, optional
        Conditions that a variant must meet.
    front : polars.DataFrame, optional
        The front, where it is known already; by default :func:`cyclosweep.explore.pareto_front`.
    most : int
        Variants drawn behind the front, at random.

    Returns
    -------
    ParetoData

    Raises
    ------
    InputError
        For other than two objectives or an unknown column.
    """
    wanted = objectives_of(list(objectives), open_table(table).schema)
    if len(wanted) != 2:
        raise InputError(f"objectives: found {len(wanted)}, expected two for a scatter")
    x, y = (each.column for each in wanted)
    if front is None:
        front = pareto_front(table, wanted, limits)
    sample = sample_of(table, [x, y], most=most, limits=limits)
    maximise = wanted[0].maximise, wanted[1].maximise
    return ParetoData(x, y, maximise, sample, front.sort(x, y))


@styled
def pareto_figure(
    table: Table,
    objectives: Sequence[str],
    *,
    limits: Conditions | None = None,
    front: pl.DataFrame | None = None,
    chosen: Sequence[int] = (),
) -> Figure:
    """Draw variants over two objectives with their Pareto front.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    objectives : sequence of str
        Two, each a column or expression, minimised unless ``max`` stands before it.
    limits : mapping, sequence of str or str, optional
        Conditions that a variant must meet.
    front : polars.DataFrame, optional
        The front, where it is known already.
    chosen : sequence of int
        Variants to be marked by their number.

    Returns
    -------
    matplotlib.figure.Figure
        Front ``gid`` ``front``; behind it at most 4000 variants, drawn at random.

    Raises
    ------
    InputError
        For other than two objectives, an unknown column, or a variant that is not there.
    """
    data = pareto_data(table, objectives, limits=limits, front=front)
    figure = new_figure(78.0)
    panel = figure.subplots()
    panel.plot(
        data.sample.frame[data.x], data.sample.frame[data.y], "o", markersize=1.6, color="#9aa3ae",
        markeredgewidth=0, alpha=0.7, label="feasible", gid="feasible", rasterized=True,
    )  # fmt: skip
    panel.plot(*data.stairs(), color=BLUE, linewidth=0.9)
    panel.plot(
        data.front[data.x], data.front[data.y], "o", markersize=3.6, color=BLUE,
        markeredgecolor="white", markeredgewidth=0.4, label="Pareto front", gid="front",
    )  # fmt: skip
    if chosen:
        _mark(panel, rows_of(table, chosen, [data.x, data.y]), data)
    panel.set_xlabel(data.label(0))
    panel.set_ylabel(data.label(1))
    panel.grid()
    panel.margins(0.06)
    panel.legend(
        loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.1, columnspacing=1
    )
    note(figure, data.said)
    return figure


def _mark(panel: Axes, rows: pl.DataFrame, data: ParetoData) -> None:
    """Mark chosen variants by their number."""
    for variant, x, y in rows.select("variant", data.x, data.y).iter_rows():
        panel.plot(x, y, "D", markersize=5, color=VERMILION, markeredgecolor=INK, gid="chosen")
        panel.annotate(
            f"{variant}", (x, y), xytext=(5, 5), textcoords="offset points", fontsize=6.5,
            bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"},
        )  # fmt: skip
