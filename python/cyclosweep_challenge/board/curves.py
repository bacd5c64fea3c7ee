"""Chart of the share of recordings found against d, for any number of detectors."""

from __future__ import annotations

from collections.abc import Sequence

from cyclosweep_challenge.board.svg import PALETTE, Series, chart

Point = tuple[float, float, float, float]
"""Visibility, share found, and the bounds of its interval."""


def power_series(curves: Sequence[tuple[str, Sequence[Point]]], apart: float = 1.0) -> list[Series]:
    """Curves of detectors, each shifted along d by the factor ``apart`` for readability."""
    return [
        Series(
            who,
            [d * apart**k for d, _, _, _ in points],
            [value for _, value, _, _ in points],
            [low for _, _, low, _ in points],
            [high for _, _, _, high in points],
            colour=PALETTE[k % len(PALETTE)],
        )
        for k, (who, points) in enumerate(curves)
        if points
    ]


def power_chart(title: str, series: Sequence[Series]) -> str:
    """Chart of power curves over a logarithmic axis, marked where there are recordings."""
    # The first series is not set apart.
    ticks = sorted({round(x, 1) for x in series[0].x}) if series else []
    every = [x for one in series for x in one.x] or [1.0, 10.0]
    return chart(
        f"Power against visibility, {title}",
        "projected signal-to-noise d",
        "share of recordings",
        series,
        x_range=(0.93 * min(every), 1.05 * max(every)),
        y_range=(0.0, 1.0),
        x_ticks=ticks,
        x_log=True,
    )
