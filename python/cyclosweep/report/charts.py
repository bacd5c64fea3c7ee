"""Description of a figure, free of how it is drawn: panels, series, axes."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

MEASURED = "#4d5562"
BEFORE = "#d55e00"
AFTER = "#0072b2"
MODELLED = "#1d232b"
REGION = "#f0b400"
QUIET = "#8a93a0"
FAINT = "#c3c9d1"
"""Colours of Okabe and Ito that stay apart for colour-blind readers."""


@dataclass(frozen=True, eq=False, slots=True)
class Line:
    """A line through points in order; NaN breaks it."""

    x: Floats
    y: Floats
    name: str
    colour: str
    width: float = 1.6
    dashed: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Points:
    """Unconnected points; `hollow` ones are drawn as rings."""

    x: Floats
    y: Floats
    name: str
    colour: str
    size: float = 3.0
    hollow: bool = False


@dataclass(frozen=True, eq=False, slots=True)
class Band:
    """Area between two curves."""

    x: Floats
    low: Floats
    high: Floats
    name: str
    colour: str


@dataclass(frozen=True, eq=False, slots=True)
class Cells:
    """Coloured cells on a diverging scale from -limit to +limit; marked ones carry a dot."""

    x_edges: Floats
    values: Floats
    marked: NDArray[np.bool_]
    limit: float
    unit: str


Series = Line | Points | Band | Cells


@dataclass(frozen=True, slots=True)
class Span:
    """A shaded stretch of the x axis."""

    low: float
    high: float
    label: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    title, x_label, y_label : str
        Texts; labels carry the unit.
    series : tuple of Series
        What is drawn, in this order.
    spans : tuple of Span
        Shaded stretches.
    x_range, y_range : (float, float) or None
        Limits; None fits the series.
    x_names, y_names : tuple of (float, str)
        Ticks of an axis that counts things.
    right_factor, right_label : float, str
        A second scale on the right, such as arcmin beside deg.
    zero_line : bool
        Whether zero is drawn as a line.
    """

    title: str
    x_label: str
    y_label: str
    series: tuple[Series, ...]
    spans: tuple[Span, ...] = ()
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    x_names: tuple[tuple[float, str], ...] = ()
    y_names: tuple[tuple[float, str], ...] = ()
    right_factor: float | None = None
    right_label: str = ""
    zero_line: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Placed:
    """A panel and its place in a figure, in units of the figure's grid."""

    panel: Panel
    row: float
    column: float
    rows: float = 1
    columns: float = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class Figure:
    """Panels on a grid, with one legend and one caption.

    Attributes
    ----------
    key : str
        Short name, also of the PNG file.
    title, caption : str
        What it shows, and how it is read.
    panels : tuple of Placed
        Panels and their places.
    rows, columns : int
        Size of the grid.
    row_height : float
        Height of a grid row [px at 1120 px width].
    """

    key: str
    title: str
    caption: str
    panels: tuple[Placed, ...]
    rows: int = 1
    columns: int = 1
    row_height: float = 260.0


def nice_ticks(low: float, high: float, count: int = 6) -> Floats:
    """Round numbers that divide a range.

    Parameters
    ----------
    low, high : float
        Ends of the range.
    count : int
        About how many steps.

    Examples
    --------
    >>> nice_ticks(-7.3, 41.0).tolist()
    [0.0, 10.0, 20.0, 30.0, 40.0]
    """
    span = high - low
    if not np.isfinite(span) or span <= 0:
        return np.array([low])
    ticks: Floats = np.zeros(0)
    while len(ticks) < 2:  # one number alone is no scale
        raw = span / count
        magnitude = 10.0 ** np.floor(np.log10(raw))
        step = next(m * magnitude for m in (1, 2, 2.5, 5, 10) if m * magnitude >= raw * 0.999)
        first, last = np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9)
        ticks = np.arange(first, last + 1) * step + 0.0
        count += 1
    return ticks


def tick_text(value: float, ticks: Floats) -> str:
    """Text of a tick, with the decimals that its neighbours need.

    Parameters
    ----------
    value : float
        The tick.
    ticks : ndarray of float
        All ticks of its axis.

    Examples
    --------
    >>> tick_text(2.5, np.array([0, 2.5, 5]))
    '2.5'
    """
    step = abs(float(ticks[1] - ticks[0])) if len(ticks) > 1 else max(abs(value), 1.0)
    if abs(value) < step * 1e-6:
        value = 0.0
    if abs(value) >= 1e5 or step < 1e-4:
        return f"{value:.3g}".replace("-", "−")
    decimals = next((d for d in range(5) if np.isclose(step, round(step, d), rtol=1e-6)), 4)
    return f"{value:.{decimals}f}".replace("-", "−")


def extent(panel: Panel, axis: Literal["x", "y"]) -> tuple[float, float]:
    """Limits of an axis: given, or fitted to the series with a margin.

    Parameters
    ----------
    panel : Panel
        Axes with their series.
    axis : {"x", "y"}
        Which of the two.
    """
    given = panel.x_range if axis == "x" else panel.y_range
    if given is not None:
        return given
    values: list[Floats] = []
    for series in panel.series:
        match series:
            case Band():
                values += [series.x] if axis == "x" else [series.low, series.high]
            case Cells():
                rows = np.array([-0.5, len(series.values) - 0.5])
                values.append(series.x_edges if axis == "x" else rows)
            case _:
                values.append(series.x if axis == "x" else series.y)
    joined = np.concatenate([np.asarray(v, dtype=np.float64) for v in values] or [np.zeros(1)])
    joined = joined[np.isfinite(joined)]
    low, high = (float(joined.min()), float(joined.max())) if len(joined) else (0.0, 1.0)
    if any(isinstance(series, Cells) for series in panel.series):
        return low, high
    margin = 0.04 * (high - low) or max(abs(high) * 0.05, 1e-3)
    return low - margin, high + margin


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """One name in a legend."""

    name: str
    colour: str
    kind: Literal["line", "dashed", "points", "ring", "area"]


def legend(figure: Figure) -> list[LegendEntry]:
    """Names of all series of a figure, each once."""
    entries: dict[str, LegendEntry] = {}
    for placed in figure.panels:
        for series in placed.panel.series:
            match series:
                case Line():
                    kind: Literal["line", "dashed", "points", "ring", "area"] = (
                        "dashed" if series.dashed else "line"
                    )
                case Points():
                    kind = "ring" if series.hollow else "points"
                case Band():
                    kind = "area"
                case Cells():
                    continue
            if series.name:
                entries.setdefault(series.name, LegendEntry(series.name, series.colour, kind))
        for span in placed.panel.spans:
            name = "located region"
            entries.setdefault(name, LegendEntry(name, REGION, "area"))
            del span
    return list(entries.values())
