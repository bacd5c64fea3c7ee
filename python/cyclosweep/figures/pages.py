"""Pictures of a study for pages, by plotly: of bounded size, whatever the study's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cyclosweep.errors import InputError
from cyclosweep.explore.tables import Conditions, Table
from cyclosweep.figures.parallel import axes_of
from cyclosweep.figures.pareto import ParetoData, pareto_data
from cyclosweep.figures.rows import How, cells_of, sample_of
from cyclosweep.figures.style import BLUE, FAINT, INK, SEQUENTIAL
from cyclosweep.figures.words import axis_label, short_name

if TYPE_CHECKING:
    from collections.abc import Mapping

    import polars as pl
    from plotly.graph_objects import Figure

__all__ = ["parallel_page", "pareto_page", "response_page"]

MOST_POINTS = 2000
"""Variants behind a Pareto front on a page: some 40 kB."""

MOST_LINES = 1000
"""Variants as lines across parallel axes on a page: some 10 kB an axis."""

MOST_OF_FRONT = 2000
"""Variants of a front on a page; of a longer one every k-th is shown, and said so."""


def pareto_page(
    table: Table,
    objectives: Sequence[str],
    *,
    limits: Conditions | None = None,
    front: pl.DataFrame | None = None,
) -> Figure:
    """Variants over two objectives with their Pareto front.

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

    Returns
    -------
    plotly.graph_objects.Figure
        Traces ``feasible``, at most 2000 variants drawn at random, and ``Pareto front`` with the
        variants' numbers as ``customdata``. How many there are stands in
        ``layout.meta["said"]``, as in the other pictures of this module.

    Raises
    ------
    InputError
        For other than two objectives, an unknown column, or without plotly.
    """
    objects = _plotly()
    data = pareto_data(table, objectives, limits=limits, front=front, most=MOST_POINTS)
    shown = data.front
    said = data.said
    if shown.height > MOST_OF_FRONT:
        step = -(-shown.height // MOST_OF_FRONT)
        shown = shown.gather_every(step)
        said += f" Of the front one in {step} is shown."
    figure = objects.Figure()
    figure.add_trace(
        objects.Scatter(
            x=_short(data.sample.frame[data.x]),
            y=_short(data.sample.frame[data.y]),
            mode="markers",
            name="feasible",
            marker={"size": 4, "color": "#9aa3ae", "opacity": 0.6},
            hovertemplate=_hover(data, with_number=False),
        )
    )
    has_numbers = "variant" in shown.columns
    figure.add_trace(
        objects.Scatter(
            x=_short(shown[data.x]),
            y=_short(shown[data.y]),
            customdata=shown["variant"].to_numpy() if has_numbers else None,
            mode="lines+markers",
            name="Pareto front",
            line={"shape": "vh" if data.maximise[0] else "hv", "color": BLUE, "width": 1.5},
            marker={"size": 8, "color": BLUE, "line": {"color": "white", "width": 1}},
            hovertemplate=_hover(data, with_number=has_numbers),
        )
    )
    figure.update_xaxes(title=data.label(0))
    figure.update_yaxes(title=data.label(1))
    return _finished(figure, said)


def parallel_page(
    table: Table,
    columns: Sequence[str],
    *,
    colour: str | None = None,
    limits: Conditions | None = None,
) -> Figure:
    """Variants as lines across parallel axes, on which a reader can mark ranges.

    Parameters
    ----------
    table : LazyFrame, DataFrame, Space, Study, str or Path
        Rows, see :func:`cyclosweep.explore.tables.open_table`.
    columns : sequence of str
        Two to twelve columns or expressions, an axis each.
    colour : str, optional
        Column that colours the lines; the last axis by default.
    limits : mapping, sequence of str or str, optional
        Conditions that a variant must meet.

    Returns
    -------
    plotly.graph_objects.Figure
        At most 1000 variants, drawn at random.

    Raises
    ------
    InputError
        For too few or too many columns, an unknown one, or without plotly.
    """
    objects = _plotly()
    names = axes_of(columns)
    by = colour or names[-1]
    sample = sample_of(table, [*names, by], most=MOST_LINES, limits=limits)
    figure = objects.Figure(
        objects.Parcoords(
            dimensions=[
                {"label": _wrapped(name), "values": _short(sample.frame[name])} for name in names
            ],
            line={
                "color": _short(sample.frame[by]),
                "colorscale": SEQUENTIAL,
                "showscale": True,
                "colorbar": {"title": {"text": axis_label(by), "side": "right"}},
            },
            labelfont={"size": 12},
            labelside="bottom",  # lines of a label run downwards, away from the figures
        )
    )
    figure = _finished(figure, sample.said)
    return figure.update_layout(margin={"l": 60, "r": 30, "t": 40, "b": 105})


def response_page(
    table: Table,
    x: str,
    y: str,
    result: str,
    *,
    how: How = "mean",
    limits: Conditions | None = None,
) -> Figure:
    """A result over two inputs as a map with contours.

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
    plotly.graph_objects.Figure
        At most 40 times 40 cells; contours where every cell has a variant.

    Raises
    ------
    InputError
        For an unknown column, an input that does not vary, or without plotly.
    """
    objects = _plotly()
    cells = cells_of(table, x, y, result, how=how, limits=limits)
    is_whole = bool(np.isfinite(cells.values).all()) and min(cells.values.shape) >= 3
    kind = objects.Contour if is_whole else objects.Heatmap
    options: dict[str, Any] = {}
    if is_whole:
        options["contours"] = {"showlabels": True, "labelfont": {"color": "white"}}
        options["line"] = {"color": "white", "width": 0.8}
    figure = objects.Figure(
        kind(
            x=cells.x,
            y=cells.y,
            z=np.round(cells.values.astype(np.float32), 6),
            colorscale=SEQUENTIAL,
            colorbar={"title": {"text": axis_label(result), "side": "right"}},
            hovertemplate=f"{short_name(x)} %{{x:.4g}}<br>{short_name(y)} %{{y:.4g}}<br>"
            f"{short_name(result)} %{{z:.4g}}<extra></extra>",
            **options,
        )
    )
    figure.update_xaxes(title=axis_label(x))
    figure.update_yaxes(title=axis_label(y))
    return _finished(figure, cells.said)


def _plotly() -> Any:
    try:
        from plotly import graph_objects
    except ImportError:
        raise InputError("pages need plotly: pip install 'cyclosweep[report]'") from None
    return graph_objects


def _short(values: pl.Series) -> Any:
    """Numbers of seven digits: half the bytes of a page, more than a screen shows."""
    return values.to_numpy().astype(np.float32)


def _hover(data: ParetoData, *, with_number: bool) -> str:
    number = "variant %{customdata}<br>" if with_number else ""
    return (
        f"{number}{short_name(data.x)} %{{x:.5g}}<br>{short_name(data.y)} %{{y:.5g}}<extra></extra>"
    )


def _wrapped(name: str) -> str:
    import textwrap

    # The first line is left to the figure at the end of the axis.
    return "<br>".join(["\N{NO-BREAK SPACE}", *textwrap.wrap(axis_label(name), 16)])


def _finished(figure: Figure, said: str) -> Figure:
    """Put the house's style on a picture and what has to be said of it into its layout."""
    axis: Mapping[str, Any] = {
        "gridcolor": FAINT,
        "linecolor": INK,
        "showline": True,
        "zeroline": False,
        "ticks": "outside",
        "automargin": True,
    }
    figure.update_xaxes(**axis)
    figure.update_yaxes(**axis)
    return figure.update_layout(
        template="none",
        font={"family": "system-ui, sans-serif", "size": 13, "color": INK},
        legend={"orientation": "h", "yanchor": "bottom", "y": 1.0, "x": 0.0},
        margin={"l": 60, "r": 20, "t": 40, "b": 50},
        meta={"said": said},
    )
