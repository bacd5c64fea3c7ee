"""Small charts as scalable graphics, without a plotting library."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np

WIDTH, HEIGHT = 460, 300
LEFT, RIGHT, TOP, BOTTOM = 54, 12, 26, 40
PALETTE = (
    "#0b5fa5",
    "#c2410c",
    "#15803d",
    "#7c3aed",
    "#b91c1c",
    "#0e7490",
    "#a16207",
    "#be185d",
    "#4d7c0f",
    "#525252",
    "#1e3a8a",
    "#854d0e",
    "#111111",
)


@dataclass(frozen=True)
class Series:
    """Points of one curve or cloud.

    Attributes
    ----------
    name : str
        Label; empty keeps it out of the legend.
    x, y : sequence of float
        Coordinates.
    low, high : sequence of float
        Ends of error bars; empty for none.
    line : bool
        Whether points are joined.
    colour : str
        Colour.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]
    low: Sequence[float] = field(default_factory=tuple)
    high: Sequence[float] = field(default_factory=tuple)
    line: bool = True
    colour: str = PALETTE[0]


def _ticks(low: float, high: float) -> list[float]:
    """About five round numbers between two bounds."""
    span = max(high - low, 1e-12)
    step = 10.0 ** np.floor(np.log10(span / 4.0))
    for factor in (1.0, 2.0, 5.0, 10.0):
        if span / (step * factor) <= 6.0:
            step *= factor
            break
    first = np.ceil(low / step) * step
    return [float(first + k * step) for k in range(int((high - first) / step + 1e-9) + 1)]


def chart(
    title: str,
    across: str,
    up: str,
    series: Sequence[Series],
    *,
    x_range: tuple[float, float],
    y_range: tuple[float, float],
    x_ticks: Sequence[float] = (),
    x_log: bool = False,
) -> str:
    """Draw a chart and return it as an ``svg`` element.

    Parameters
    ----------
    title, across, up : str
        Heading and the names of the axes with their units.
    series : sequence of Series
        What is drawn.
    x_range, y_range : tuple of float
        Bounds of the axes.
    x_ticks : sequence of float
        Where the x axis is marked; round numbers if absent.
    x_log : bool
        Whether the x axis is logarithmic.
    """
    (x0, x1), (y0, y1) = x_range, y_range
    inner_w, inner_h = WIDTH - LEFT - RIGHT, HEIGHT - TOP - BOTTOM

    def px(x: float) -> float:
        share = np.log(x / x0) / np.log(x1 / x0) if x_log else (x - x0) / (x1 - x0)
        return float(LEFT + share * inner_w)

    def py(y: float) -> float:
        return TOP + (y1 - min(max(y, y0), y1)) / (y1 - y0) * inner_h

    parts = [
        f'<svg viewBox="0 0 {WIDTH} {HEIGHT}" role="img" aria-label="{escape(title)}">',
        f'<text x="{LEFT}" y="16" class="title">{escape(title)}</text>',
    ]
    for tick in x_ticks or _ticks(x0, x1):
        parts.append(
            f'<line x1="{px(tick):.1f}" x2="{px(tick):.1f}" y1="{TOP}" y2="{HEIGHT - BOTTOM}" '
            f'class="grid"/><text x="{px(tick):.1f}" y="{HEIGHT - BOTTOM + 14}" '
            f'text-anchor="middle">{tick:g}</text>'
        )
    for tick in _ticks(y0, y1):
        parts.append(
            f'<line x1="{LEFT}" x2="{WIDTH - RIGHT}" y1="{py(tick):.1f}" y2="{py(tick):.1f}" '
            f'class="grid"/><text x="{LEFT - 5}" y="{py(tick) + 3:.1f}" '
            f'text-anchor="end">{tick:g}</text>'
        )
    parts.append(
        f'<text x="{LEFT + inner_w / 2}" y="{HEIGHT - 8}" text-anchor="middle">'
        f"{escape(across)}</text>"
        f'<text transform="rotate(-90 12 {TOP + inner_h / 2})" x="12" y="{TOP + inner_h / 2}" '
        f'text-anchor="middle">{escape(up)}</text>'
    )
    for one in series:
        parts.append(_drawn(one, [px(x) for x in one.x], [py(y) for y in one.y], py))
    parts.append("</svg>")
    return "".join(parts) + _legend(series)


def _drawn(one: Series, xs: list[float], ys: list[float], py: Callable[[float], float]) -> str:
    """Return the marks of one series at pixel coordinates."""
    parts = []
    if one.line and len(xs) > 1:
        points = " ".join(f"{x:.1f},{y:.1f}" for x, y in zip(xs, ys, strict=True))
        parts.append(f'<polyline points="{points}" fill="none" stroke="{one.colour}"/>')
    for x, low, high in zip(xs, one.low, one.high, strict=False):
        parts.append(
            f'<line x1="{x:.1f}" x2="{x:.1f}" y1="{py(low):.1f}" y2="{py(high):.1f}" '
            f'stroke="{one.colour}" opacity="0.5"/>'
        )
    radius = 2.6 if one.line else 1.1
    for x, y in zip(xs, ys, strict=True):
        parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{one.colour}"/>')
    return "".join(parts)


def _legend(series: Sequence[Series]) -> str:
    """Legend under the chart."""
    named = [s for s in series if s.name]
    items = "".join(
        f'<span><i style="background:{s.colour}"></i>{escape(s.name)}</span>' for s in named
    )
    return f'<div class="legend">{items}</div>' if named else ""
