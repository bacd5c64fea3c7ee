"""Figures as inline SVG, without any library."""

import re
from html import escape

import numpy as np
from numpy.typing import NDArray

from cyclosweep.report.charts import (
    REGION,
    Band,
    Cells,
    Figure,
    LegendEntry,
    Line,
    Panel,
    Points,
    extent,
    legend,
    nice_ticks,
    tick_text,
)
from cyclosweep.report.wording import number

Floats = NDArray[np.float64]

WIDTH = 1120.0
"""Width of a figure [px]."""

LEFT, RIGHT, RIGHT_SCALE, TOP, BOTTOM = 76.0, 20.0, 74.0, 30.0, 48.0
"""Margins of a panel [px]; wide enough for the larger letters of a narrow screen."""
LABEL_ROOM = 18.0
"""Room above a panel for the name of a shaded stretch [px]."""
LETTER = 8.3
"""Width of a letter of a named row on a narrow screen [px]."""


def figure_svg(figure: Figure) -> str:
    """Draw a figure: a legend and a grid of panels, which stack where the page is narrow.

    Returns
    -------
    str
        HTML with an ``svg`` element for each panel, which scales with its container.
    """
    columns = WIDTH / figure.columns
    parts = [_legend(legend(figure)), *(_colour_scale(cells) for cells in _first_cells(figure))]
    parts.append(f'<div class="panels" style="--columns:{figure.columns}">')
    for place, placed in enumerate(figure.panels):
        width, height = columns * placed.columns, figure.row_height * placed.rows
        at = (
            f"grid-row:{placed.row + 1:g}/span {placed.rows:g};"
            f"grid-column:{placed.column + 1:g}/span {placed.columns:g}"
        )
        parts.append(
            f'<svg viewBox="0 0 {width:g} {height:g}" style="{at}" role="img" '
            f'aria-label="{escape(placed.panel.title or figure.title)}" '
            'xmlns="http://www.w3.org/2000/svg">'
            f"{_panel(placed.panel, width, height, f'{figure.key}-{place}')}</svg>"
        )
    return "".join(parts) + "</div>"


class _Scale:
    """From data to pixels, and rounding that keeps the file small."""

    def __init__(self, low: float, high: float, start: float, stop: float) -> None:
        if not high > low:
            low, high = low - 0.5, high + 0.5
        self.low, self.high, self.start, self.stop = low, high, start, stop
        self.factor = (stop - start) / (high - low)

    def __call__(self, value: float) -> float:
        return self.start + (value - self.low) * self.factor

    def many(self, values: Floats) -> Floats:
        """Pixels of many values."""
        pixels: Floats = np.round(self.start + (values - self.low) * self.factor, 1)
        return pixels


def _panel(panel: Panel, width: float, height: float, key: str) -> str:
    """Draw one pair of axes."""
    left = max(LEFT, 16.0 + LETTER * max((len(name) for _, name in panel.y_names), default=0))
    room = LABEL_ROOM if any(span.label for span in panel.spans) else 0.0
    right = RIGHT_SCALE if panel.right_factor else RIGHT
    x0, x1, y0, y1 = left, width - right, TOP + room, height - BOTTOM
    x = _Scale(*extent(panel, "x"), x0, x1)
    y = _Scale(*extent(panel, "y"), y1, y0)
    clip = f"clip-{key}"
    out = [
        f'<clipPath id="{clip}"><rect x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" '
        f'height="{y1 - y0:.1f}"/></clipPath>',
        f'<text class="pt" x="{x0:.1f}" y="{y0 - room - 10:.1f}">{escape(panel.title)}</text>',
        f'<rect class="plot" x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" '
        f'height="{y1 - y0:.1f}"/>',
    ]
    out.append(_axes(panel, x, y))
    out.append(f'<g clip-path="url(#{clip})">')
    out += [_span(span.low, span.high, x, y0, y1) for span in panel.spans]
    if panel.zero_line and y.low < 0 < y.high:
        out.append(f'<path class="zero" d="M{x0:.1f} {y(0):.1f}H{x1:.1f}"/>')
    out += [_series(series, x, y) for series in panel.series]
    out.append("</g>")
    for span in panel.spans:
        if span.label:
            out.append(_span_label(span.label, span.low, span.high, x, y0))
    out.append(
        f'<rect class="hit" x="{x0:.1f}" y="{y0:.1f}" width="{x1 - x0:.1f}" '
        f'height="{y1 - y0:.1f}" data-x="{x.low:.6g} {x.high:.6g}" '
        f'data-y="{y.low:.6g} {y.high:.6g}"/>'
        f'<text class="at" x="{x1 - 4:.1f}" y="{y0 - room - 10:.1f}"></text>'
    )
    return "".join(out)


def _axes(panel: Panel, x: _Scale, y: _Scale) -> str:
    """Grid, ticks and labels."""
    out: list[str] = []
    bottom, top = y.start, y.stop
    x_ticks = list(panel.x_names) or _numbered(x, 92.0)
    y_ticks = list(panel.y_names) or _numbered(y, 44.0)
    for value, text in x_ticks:
        at = x(value)
        if not panel.x_names:
            out.append(f'<path class="grid" d="M{at:.1f} {bottom:.1f}V{top:.1f}"/>')
        out.append(
            f'<text class="tick" text-anchor="middle" x="{at:.1f}" y="{bottom + 17:.1f}">'
            f"{escape(text)}</text>"
        )
    for value, text in y_ticks:
        at = y(value)
        if not panel.y_names:
            out.append(f'<path class="grid" d="M{x.start:.1f} {at:.1f}H{x.stop:.1f}"/>')
        out.append(
            f'<text class="tick" text-anchor="end" x="{x.start - 8:.1f}" y="{at + 4:.1f}">'
            f"{escape(text)}</text>"
        )
    if panel.right_factor:
        right = _Scale(y.low * panel.right_factor, y.high * panel.right_factor, y.start, y.stop)
        for value, text in _numbered(right, 44.0):
            out.append(
                f'<text class="tick" x="{x.stop + 8:.1f}" y="{right(value) + 4:.1f}">'
                f"{escape(text)}</text>"
            )
        out.append(_upright(panel.right_label, x.stop + 62, (top + bottom) / 2))
    middle = (x.start + x.stop) / 2
    out.append(
        f'<text class="label" text-anchor="middle" x="{middle:.1f}" y="{bottom + 37:.1f}">'
        f"{escape(panel.x_label)}</text>"
    )
    if panel.y_label:
        out.append(_upright(panel.y_label, x.start - (LEFT - 14.0), (top + bottom) / 2))
    return "".join(out)


def _upright(text: str, x: float, y: float) -> str:
    """Label of a vertical axis."""
    return (
        f'<text class="label" text-anchor="middle" transform="translate({x:.1f} {y:.1f}) '
        f'rotate(-90)">{escape(text)}</text>'
    )


def _numbered(scale: _Scale, pixels: float) -> list[tuple[float, str]]:
    """Round ticks, about one every so many pixels."""
    count = max(2, int(abs(scale.stop - scale.start) / pixels))
    ticks = nice_ticks(scale.low, scale.high, count)
    return [(float(tick), tick_text(float(tick), ticks)) for tick in ticks]


def _span(low: float, high: float, x: _Scale, top: float, bottom: float) -> str:
    """Shade a stretch, at least three pixels wide."""
    a, b = sorted((x(low), x(high)))
    if b - a < 3:
        a, b = (a + b) / 2 - 1.5, (a + b) / 2 + 1.5
    return (
        f'<rect class="span" x="{a:.1f}" y="{top:.1f}" width="{b - a:.1f}" '
        f'height="{bottom - top:.1f}" fill="{REGION}"/>'
    )


def _span_label(text: str, low: float, high: float, x: _Scale, top: float) -> str:
    """Name a shaded stretch above the panel, where it covers nothing."""
    half = 3.3 * len(text)
    at = min(max((x(low) + x(high)) / 2, x.start + half + 4), x.stop - half - 4)
    return (
        f'<text class="spanlabel" text-anchor="middle" x="{at:.1f}" y="{top - 6:.1f}">'
        f"{escape(text)}</text>"
    )


def _series(series: Line | Points | Band | Cells, x: _Scale, y: _Scale) -> str:
    """Draw one series."""
    match series:
        case Line():
            dash = ' stroke-dasharray="6 4"' if series.dashed else ""
            return (
                f'<path class="{_class(series.name)}" fill="none" stroke="{series.colour}" '
                f'stroke-width="{series.width:g}" stroke-linejoin="round"{dash} '
                f'd="{_path(series.x, series.y, x, y)}"/>'
            )
        case Points():
            return _points(series, x, y)
        case Band():
            forward = _path(series.x, series.high, x, y)
            back = _path(series.x[::-1], series.low[::-1], x, y).replace("M", "L", 1)
            return (
                f'<path class="{_class(series.name)}" fill="{series.colour}" fill-opacity="0.16" '
                f'd="{forward}{back}Z"/>'
            )
        case Cells():
            return _cells(series, x, y)


def _points(series: Points, x: _Scale, y: _Scale) -> str:
    """Draw points as one path of round dots, or as rings."""
    ok = np.isfinite(series.x) & np.isfinite(series.y)
    px, py = x.many(series.x[ok]), y.many(series.y[ok])
    name = _class(series.name)
    if series.hollow:
        rings = "".join(
            f'<circle cx="{a:g}" cy="{b:g}" r="{series.size:g}"/>'
            for a, b in zip(px, py, strict=True)
        )
        return (
            f'<g class="{name}" fill="#fff" stroke="{series.colour}" stroke-width="1.6">{rings}</g>'
        )
    dots = "".join(f"M{a:g} {b:g}h0" for a, b in zip(px, py, strict=True))
    return (
        f'<path class="{name}" fill="none" stroke="{series.colour}" stroke-linecap="round" '
        f'stroke-width="{2 * series.size:g}" d="{dots}"/>'
    )


def _path(px: Floats, py: Floats, x: _Scale, y: _Scale) -> str:
    """Draw a path through points, broken where a value is not finite."""
    ok = np.isfinite(px) & np.isfinite(py)
    xs, ys = x.many(np.where(ok, px, 0.0)), y.many(np.where(ok, py, 0.0))
    pieces: list[str] = []
    pen_down = False
    for a, b, good in zip(xs.tolist(), ys.tolist(), ok.tolist(), strict=True):
        if good:
            pieces.append(f"{'L' if pen_down else 'M'}{a:g} {b:g}")
        pen_down = good
    return "".join(pieces)


def _cells(series: Cells, x: _Scale, y: _Scale) -> str:
    """Draw a map of cells, row 0 at the top."""
    out = []
    edges = x.many(series.x_edges)
    rows = len(series.values)
    for row in range(rows):
        top, bottom = y(rows - 1 - row + 0.5), y(rows - 1 - row - 0.5)
        for column, value in enumerate(series.values[row]):
            a, b = edges[column], edges[column + 1]
            if np.isfinite(value):
                out.append(
                    f'<rect x="{a:g}" y="{top:.1f}" width="{b - a:.1f}" '
                    f'height="{bottom - top:.1f}" fill="{diverging(value / series.limit)}" '
                    f'stroke="#fff" stroke-width="0.6"><title>{value:+.3g} {escape(series.unit)}'
                    "</title></rect>"
                )
            if series.marked[row, column]:
                out.append(
                    f'<circle cx="{(a + b) / 2:.1f}" cy="{(top + bottom) / 2:.1f}" r="2" '
                    'fill="#1d232b"/>'
                )
    return "".join(out)


def diverging(share: float) -> str:
    """Colour between orange (-1), near-white (0) and blue (+1), apart for colour-blind readers.

    Examples
    --------
    >>> diverging(0.0)
    '#f6f6f4'
    """
    share = min(max(share, -1.0), 1.0)
    end = (0, 90, 160) if share > 0 else (200, 82, 0)
    rgb = [round(246 + (c - 246) * abs(share) ** 0.8) for c in end]
    if share == 0:
        rgb = [246, 246, 244]
    return "#" + "".join(f"{c:02x}" for c in rgb)


def _legend(entries: list[LegendEntry]) -> str:
    """Names of the series above the panels; a click hides a series."""
    out = []
    for entry in entries:
        match entry.kind:
            case "line" | "dashed":
                dash = ' stroke-dasharray="6 4"' if entry.kind == "dashed" else ""
                sign = (
                    f'<path d="M0 7h24" stroke="{entry.colour}" stroke-width="2.2" '
                    f'fill="none"{dash}/>'
                )
            case "points":
                sign = f'<circle cx="12" cy="7" r="3.6" fill="{entry.colour}"/>'
            case "ring":
                sign = (
                    f'<circle cx="12" cy="7" r="3.6" fill="#fff" stroke="{entry.colour}" '
                    'stroke-width="1.6"/>'
                )
            case "area":
                sign = (
                    f'<rect x="0" y="1" width="24" height="12" fill="{entry.colour}" '
                    'fill-opacity="0.28"/>'
                )
        out.append(
            f'<span class="key" data-for="{_class(entry.name)}"><svg viewBox="0 0 24 14" '
            f'aria-hidden="true" xmlns="http://www.w3.org/2000/svg">{sign}</svg>'
            f"{escape(entry.name)}</span>"
        )
    return f'<div class="legend">{"".join(out)}</div>' if out else ""


def _first_cells(figure: Figure) -> list[Cells]:
    """First map of a figure, whose colours hold for all of them."""
    maps = [s for placed in figure.panels for s in placed.panel.series if isinstance(s, Cells)]
    return maps[:1]


def _colour_scale(cells: Cells) -> str:
    """Colours of a map from -limit to +limit."""
    steps, width = 21, 9.0
    boxes = "".join(
        f'<rect x="{k * width:g}" y="0" width="{width:g}" height="12" '
        f'fill="{diverging(2 * k / (steps - 1) - 1)}"/>'
        for k in range(steps)
    )
    return (
        f'<div class="legend scale">{number(-cells.limit)}<svg viewBox="0 0 {steps * width:g} 12" '
        f'aria-hidden="true" xmlns="http://www.w3.org/2000/svg">{boxes}</svg>'
        f"+{number(cells.limit)} {escape(cells.unit)}</div>"
    )


def _class(name: str) -> str:
    """Class name of a series."""
    return "s-" + re.sub(r"[^a-z0-9]+", "-", name.lower()).strip("-")
