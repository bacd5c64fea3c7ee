"""Variants as lines across parallel axes, one for each input or result."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import polars as pl

from cyclosweep.errors import InputError
from cyclosweep.explore.tables import Conditions, Table
from cyclosweep.figures.rows import rows_of, sample_of
from cyclosweep.figures.style import (
    INK,
    SEQUENTIAL,
    SINGLE_COLUMN_MM,
    TWO_COLUMNS_MM,
    VERMILION,
    new_figure,
    note,
    styled,
)
from cyclosweep.figures.words import axis_label, short_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["MOST_LINES", "axes_of", "parallel_figure"]

MOST_LINES = 400
"""Variants drawn as lines across parallel axes: more would only blacken the picture."""

Reals = npt.NDArray[np.float64]


def axes_of(columns: Sequence[str]) -> list[str]:
    """Columns of parallel axes, each once; InputError for too few or too many.

    Parameters
    ----------
    columns : sequence of str
        Columns or expressions.

    Returns
    -------
    list of str
    """
    names = list(dict.fromkeys(columns))
    if not 2 <= len(names) <= 12:
        raise InputError(f"columns: found {len(names)}, expected two to twelve")
    return names


@styled
def parallel_figure(
    table: Table,
    columns: Sequence[str],
    *,
    colour: str | None = None,
    limits: Conditions | None = None,
    chosen: Sequence[int] = (),
) -> Figure:
    """Draw variants as lines across parallel axes.

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
    chosen : sequence of int
        Variants drawn thick, by their number.

    Returns
    -------
    matplotlib.figure.Figure
        At most 400 variants, drawn at random (``gid`` ``line``); each axis from its least to its
        greatest value among them.

    Raises
    ------
    InputError
        For too few or too many columns, an unknown one, or a variant that is not there.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.collections import LineCollection
    from matplotlib.colors import Normalize

    names = axes_of(columns)
    by = colour or names[-1]
    sample = sample_of(table, [*names, by], most=MOST_LINES, limits=limits)
    marked = rows_of(table, chosen, names) if chosen else None
    shown = sample.frame.select(names)
    every = shown if marked is None else pl.concat([shown, marked.select(names)])
    low = every.select(pl.all().min()).to_numpy()[0]
    high = every.select(pl.all().max()).to_numpy()[0]
    span = np.where(high > low, high - low, 1.0)

    def scaled(frame: pl.DataFrame) -> Reals:
        part = (frame.select(names).to_numpy() - low) / span
        return np.where(high > low, part, 0.5)

    wide = len(names) > 5
    figure = new_figure(84.0, TWO_COLUMNS_MM if wide else SINGLE_COLUMN_MM)
    panel = figure.subplots()
    values = sample.frame[by].to_numpy()
    scale = Normalize(float(values.min()), float(values.max()))
    order = np.argsort(values, kind="stable")
    heights = scaled(sample.frame)[order]
    places = np.arange(len(names), dtype=np.float64)
    paths = [np.column_stack([places, row]) for row in heights]
    lines = LineCollection(paths, linewidths=0.6, alpha=0.55, cmap=SEQUENTIAL, norm=scale)
    lines.set_array(values[order])
    lines.set_gid("line")
    panel.add_collection(lines)
    if marked is not None:
        dashes = ("-", "--", "-.", ":")
        for k, (row, variant) in enumerate(zip(scaled(marked), marked["variant"], strict=True)):
            panel.plot(places, row, color=VERMILION, linewidth=1.8, linestyle=dashes[k % 4],
                       label=f"variant {variant}", gid="chosen")  # fmt: skip
        panel.legend(
            loc="lower left", bbox_to_anchor=(0, 1.08), ncols=4, borderaxespad=0, columnspacing=1
        )
    for place in range(len(names)):
        panel.plot([place, place], [0, 1], color=INK, linewidth=0.7)
        for at, value, side in ((0.0, low[place], "top"), (1.0, high[place], "bottom")):
            panel.annotate(
                f"{value:.4g}", (place, at), xytext=(0, -3 if at == 0 else 3), ha="center", va=side,
                textcoords="offset points", fontsize=6.5, annotation_clip=False,
            )  # fmt: skip
    panel.set_xlim(-0.35, len(names) - 0.65)
    panel.set_ylim(-0.06, 1.06)
    panel.set_yticks([])
    for spine in panel.spines.values():
        spine.set_visible(False)
    panel.set_xticks(places, [_narrow(name) for name in names], fontsize=6.0)
    panel.tick_params(axis="x", length=0, pad=4)
    bar = figure.colorbar(
        ScalarMappable(norm=scale, cmap=SEQUENTIAL), ax=panel, fraction=0.03, pad=0.02
    )
    bar.set_label(axis_label(by))
    note(figure, sample.said)
    return figure


def _narrow(name: str) -> str:
    """Label of a parallel axis, broken into short lines."""
    # A load and its unit stay together.
    words = textwrap.wrap(short_name(name).replace(" T_N", "\N{NO-BREAK SPACE}T_N"), 13)
    unit = axis_label(name).removeprefix(short_name(name)).strip()
    return "\n".join([*words, unit] if unit else words)
