"""Over which stretches of a turn each hole pushes its pin, by each criterion."""

from __future__ import annotations

from collections.abc import Iterator

import polars as pl

__all__ = ["hole_windows"]

_TIE_DEG = 1e-9
"""Angle below which a hole counts as standing on the border of the two halves [deg]: rounding."""

Window = tuple[float, float]


def hole_windows(
    criterion: str,
    *,
    ratio: int,
    disc_count: int,
    output_pin_count: int,
    delta_deg: float,
    clocking_deg: float,
) -> pl.DataFrame:
    """List the stretches of the mesh zone's turn over which each hole counts as active.

    Parameters
    ----------
    criterion : {"published-map", "inside", "statics"}
        The rule.
    ratio, disc_count, output_pin_count : int
        Reduction ratio, discs, output pins [1].
    delta_deg : float
        asin(e / (2 R_OP)) [deg].
    clocking_deg : float
        Clocking of the hole pattern [deg].

    Returns
    -------
    polars.DataFrame
        See :meth:`cyclosweep.Drive.hole_windows`.
    """
    pitch = 360 / output_pin_count
    angles = [clocking_deg + (index + 0.5) * pitch for index in range(output_pin_count)]
    reduced = [_reduced(angle) for angle in angles]
    order = sorted(range(output_pin_count), key=lambda index: _behind(reduced[index]))
    number = {index: place + 1 for place, index in enumerate(order)}
    low, high = (0.0, 180.0) if criterion == "statics" else (90 + delta_deg, 270 - delta_deg)
    rows = []
    for disc in range(disc_count):
        lead = 360 * disc / disc_count
        for index in order:
            if criterion == "published-map":
                windows = list(_of_half(reduced, index, low, high, ratio))
            else:
                windows = list(_recurring(low, high, angles[index] - lead, ratio))
            half = "left" if reduced[index] <= _TIE_DEG else "right"
            rows += [(disc + 1, number[index], index, half, *window) for window in windows]
    schema = {
        "disc": pl.Int64(),
        "hole": pl.Int64(),
        "index": pl.Int64(),
        "half": pl.String(),
        "start_deg": pl.Float64(),
        "end_deg": pl.Float64(),
    }
    return pl.DataFrame(rows, schema=schema, orient="row")


def _reduced(angle_deg: float) -> float:
    """Angle within (-180, 180] deg."""
    reduced = 180 - (180 - angle_deg) % 360
    return reduced + 360 if reduced <= -180 + _TIE_DEG else reduced


def _behind(reduced_deg: float) -> float:
    """How far a hole stands from ring pin 0 against the mesh zone's travel [deg]: H1 is nearest."""
    return -reduced_deg if reduced_deg <= _TIE_DEG else 360 - reduced_deg


def _recurring(low: float, high: float, angle_deg: float, ratio: int) -> Iterator[Window]:
    """Stretches of theta in 0..360 deg with theta (1 + 1/i) - angle in (low, high) of a turn."""
    shrink = ratio / (ratio + 1)
    first = -int((angle_deg + high) // 360) - 1
    for turn in range(first, first + 4):
        start = max((low + 360 * turn + angle_deg) * shrink, 0.0)
        end = min((high + 360 * turn + angle_deg) * shrink, 360.0)
        if end > start:
            yield start, end


def _of_half(
    reduced: list[float], index: int, low: float, high: float, ratio: int
) -> Iterator[Window]:
    """Windows by the reconstruction that matches the published map: each half on its own."""
    is_left = reduced[index] <= _TIE_DEG
    of_half = [angle for angle in reduced if (angle <= _TIE_DEG) == is_left]
    # The right half follows the left one's rule in a mirror.
    angle = reduced[index] if is_left else -reduced[index]
    is_nearest = abs(reduced[index]) == min(abs(other) for other in of_half)
    for start, end in _recurring(low, high, angle, ratio):
        if not is_nearest:
            if start >= 180:
                continue
            end = min(end, 180.0)
        yield (start, end) if is_left else (360 - end, 360 - start)
