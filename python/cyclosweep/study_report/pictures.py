"""The report's pictures of a whole study as inline SVG: all variants and the front, and effects."""

from __future__ import annotations

import base64
import io
import math
from collections.abc import Callable, Sequence
from html import escape
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from cyclosweep.study_report.aggregate import AxisBins

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Ticks", "effect_svg", "feasible_svg", "figure_image", "scatter_svg"]

Reals = npt.NDArray[np.float64]

WIDTH, HEIGHT = 720.0, 460.0
"""Size of the large picture [px of its own]; it scales with the page."""
CELL = (0, 114, 178)
"""Colour of a cell with many variants, on white: red, green, blue."""
SMALL = (340.0, 200.0)
"""Size of a small one."""


class Ticks:
    """A scale from numbers to pixels with round ticks.

    Parameters
    ----------
    low, high : float
        Ends of the data.
    start, stop : float
        Pixels at which they lie.
    """

    def __init__(self, low: float, high: float, start: float, stop: float) -> None:
        if not high > low:
            low, high = low - 0.5 * max(abs(low), 1e-9), high + 0.5 * max(abs(high), 1e-9)
        self.low, self.high, self.start, self.stop = low, high, start, stop

    def __call__(self, value: float) -> float:
        """Pixel of a number."""
        return self.start + (value - self.low) / (self.high - self.low) * (self.stop - self.start)

    def values(self, about: int) -> list[float]:
        """About so many round numbers within the scale."""
        step = (self.high - self.low) / max(about, 1)
        power = 10.0 ** math.floor(math.log10(step))
        step = min((k * power for k in (1, 2, 5, 10) if k * power >= step), default=step)
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [k * step for k in range(first, last + 1)]


def _text(value: float) -> str:
    return f"{value:.4g}".replace("-", "−")


def _axes(x: Ticks, y: Ticks, labels: tuple[str, str], counts: tuple[int, int]) -> str:
    out = [f'<rect class="plot" x="{x.start:.1f}" y="{y.stop:.1f}" '
           f'width="{x.stop - x.start:.1f}" height="{y.start - y.stop:.1f}"/>']  # fmt: skip
    for value in x.values(counts[0]):
        at = x(value)
        out.append(f'<path class="grid" d="M{at:.1f} {y.start:.1f}V{y.stop:.1f}"/>')
        out.append(f'<text class="tick" text-anchor="middle" x="{at:.1f}" y="{y.start + 17:.1f}">'
                   f"{_text(value)}</text>")  # fmt: skip
    for value in y.values(counts[1]):
        at = y(value)
        out.append(f'<path class="grid" d="M{x.start:.1f} {at:.1f}H{x.stop:.1f}"/>')
        out.append(f'<text class="tick" text-anchor="end" x="{x.start - 7:.1f}" y="{at + 4:.1f}">'
                   f"{_text(value)}</text>")  # fmt: skip
    out.append(f'<text class="label" text-anchor="middle" x="{(x.start + x.stop) / 2:.1f}" '
               f'y="{y.start + 38:.1f}">{escape(labels[0])}</text>')  # fmt: skip
    out.append(f'<text class="label" x="{x.start - 58:.1f}" y="{y.stop - 12:.1f}">'
               f"{escape(labels[1])}</text>")  # fmt: skip
    return "".join(out)


def scatter_svg(
    cells: npt.NDArray[np.int64] | None,
    ranges: tuple[tuple[float, float], tuple[float, float]],
    points: Sequence[tuple[int, float, float]],
    labels: tuple[str, str],
) -> str:
    """All feasible variants as shaded cells, the front as points that its table knows.

    Parameters
    ----------
    cells : ndarray, shape (across, up), optional
        Variants in each cell.
    ranges : ((float, float), (float, float))
        Ends across and up.
    points : sequence of (int, float, float)
        Variant and place of each point of the front.
    labels : (str, str)
        Of the axes.

    Returns
    -------
    str
        SVG; each point has ``data-variant``.
    """
    x = Ticks(*ranges[0], 68.0, WIDTH - 16.0)
    y = Ticks(*ranges[1], HEIGHT - 50.0, 34.0)
    out = [
        f'<svg viewBox="0 0 {WIDTH:g} {HEIGHT:g}" role="group" class="scatter" aria-label="'
        f'{escape(labels[1])} over {escape(labels[0])}">',
        _axes(x, y, labels, (7, 7)),
    ]
    if cells is not None and cells.max() > 0:
        across, up = cells.shape
        width, height = (x.stop - x.start) / across, (y.start - y.stop) / up
        most = math.log1p(float(cells.max()))
        for i, j in np.argwhere(cells > 0):
            share = 0.1 + 0.55 * math.log1p(float(cells[i, j])) / most
            shade = "".join(f"{round(255 + (tone - 255) * share):02x}" for tone in CELL)
            out.append(
                f'<rect x="{x.start + i * width:.1f}" y="{y.start - (j + 1) * height:.1f}" '
                f'width="{width + 0.5:.1f}" height="{height + 0.5:.1f}" fill="#{shade}"/>'
            )
    for variant, at_x, at_y in points:
        out.append(
            f'<circle class="dot" data-variant="{variant}" cx="{x(at_x):.1f}" cy="{y(at_y):.1f}" '
            f'r="5"><title>variant {variant}: {_text(at_x)}, {_text(at_y)}</title></circle>'
        )
    return "".join(out) + "</svg>"


def _small(
    axis: AxisBins, label: str, title: str, low: float, high: float,
    draw: Callable[[Ticks, Ticks], str],
) -> str:  # fmt: skip
    width, height = SMALL
    half = 0.5 * float(np.diff(axis.centres).mean()) if len(axis.centres) > 1 else 0.5
    x = Ticks(float(axis.centres[0]) - half, float(axis.centres[-1]) + half, 62.0, width - 10.0)
    y = Ticks(low, high, height - 44.0, 30.0)
    return (
        f'<svg viewBox="0 0 {width:g} {height:g}" role="img" aria-label="{escape(title)}">'
        + _axes(x, y, (label, title), (4, 4))
        + draw(x, y)
        + "</svg>"
    )


def effect_svg(axis: AxisBins, outcome: str, labels: tuple[str, str]) -> str:
    """Mean of an outcome over an input, with the band of one standard deviation.

    Parameters
    ----------
    axis : AxisBins
        The input.
    outcome : str
        What is drawn.
    labels : (str, str)
        Of input and outcome.

    Returns
    -------
    str
        SVG; empty where there is nothing to draw.
    """
    mean, deviation = axis.means[outcome], axis.deviations[outcome]
    known = np.isfinite(mean)
    if known.sum() < 2:
        return ""
    at, mean, deviation = axis.centres[known], mean[known], deviation[known]
    low, high = float((mean - deviation).min()), float((mean + deviation).max())

    def draw(x: Ticks, y: Ticks) -> str:
        upper = " ".join(
            f"{x(a):.1f},{y(v):.1f}" for a, v in zip(at, mean + deviation, strict=True)
        )
        pairs = zip(at[::-1], (mean - deviation)[::-1], strict=True)
        lower = " ".join(f"{x(a):.1f},{y(v):.1f}" for a, v in pairs)
        line = " ".join(f"{x(a):.1f},{y(v):.1f}" for a, v in zip(at, mean, strict=True))
        dots = "".join(
            f'<circle class="mean" cx="{x(a):.1f}" cy="{y(v):.1f}" r="2.5"/>'
            for a, v in zip(at, mean, strict=True)
        )
        return (
            f'<polygon class="band" points="{upper} {lower}"/>'
            f'<polyline class="mean-line" points="{line}"/>{dots}'
        )

    return _small(axis, labels[0], labels[1], low, high, draw)


def feasible_svg(axis: AxisBins, label: str) -> str:
    """Share of the variants that can be built, over an input.

    Parameters
    ----------
    axis : AxisBins
        The input.
    label : str
        Of its axis.

    Returns
    -------
    str
        SVG; empty for an input with one value.
    """
    if len(axis.centres) < 2:
        return ""
    share = 100.0 * axis.feasible / np.maximum(axis.total, 1)

    def draw(x: Ticks, y: Ticks) -> str:
        gap = (x.stop - x.start) / len(axis.centres)
        return "".join(
            f'<rect class="bar" x="{x(a) - 0.42 * gap:.1f}" y="{y(v):.1f}" '
            f'width="{0.84 * gap:.1f}" height="{y(0) - y(v):.1f}"/>'
            for a, v in zip(axis.centres, share, strict=True)
            if v > 0
        )

    return _small(axis, label, "feasible [%]", 0.0, 100.0, draw)


def figure_image(figure: Figure, words: str) -> str:
    """Picture of matplotlib as an image inside the page.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        The picture.
    words : str
        What it shows, for those who do not see it.

    Returns
    -------
    str
        An ``img`` element; SVG, so that it stays sharp in print.
    """
    held = io.BytesIO()
    figure.savefig(held, format="svg", metadata={"Date": None, "Creator": None})
    content = base64.b64encode(held.getvalue()).decode("ascii")
    return f'<img alt="{escape(words)}" src="data:image/svg+xml;base64,{content}">'
