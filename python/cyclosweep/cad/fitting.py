"""Arcs and straight lines that follow a curve within a chord error."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Protocol, overload

import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline

from cyclosweep.errors import InputError

if TYPE_CHECKING:
    from typing import Any

__all__ = ["Flank", "arcs_within", "checked_chord_error", "points_within", "splines_within"]

Reals = npt.NDArray[np.float64]

FINEST_MM, COARSEST_MM = 1e-6, 1.0
"""Chord errors [mm] between which arcs are fitted: finer, a disc of 87 lobes has over ten thousand
arcs and a drawing's numbers their last digits; coarser, lobes lose their form."""

_SAMPLES = 33
"""Places within a piece at which its distance from the curve is measured."""

_SHARE = 0.95
"""Part of the chord error that the measured places may take; the peak can lie between them."""

_HALVINGS = 20
"""Halvings by which a piece's end is found: to a millionth of the flank."""

_ROUNDS = 6
"""Halvings of the bound that make pieces alike."""

_MEASURED = 4001
"""Places of a flank by which lengths along it, and a spline's distance, are measured."""

_INTERVALS = 4
"""Intervals of a spline's points: with more, programs that integrate over a face by a fixed rule
find a disc's volume wrong by 1e-4 (build123d 0.13), with four by 1e-6."""

_MOST_SPLINES = 512
"""Splines of a flank beyond which a fit has gone wrong."""

Range = tuple[float, float]
Distance = Callable[[float, float], float]


class Flank(Protocol):
    """What a curve must tell to be followed."""

    @property
    def flank_range(self) -> tuple[float, float]:
        """First and last parameter."""

    def flank(self, psi: Reals) -> Any:
        """Points with ``position_mm`` and ``tangent``."""


def checked_chord_error(chord_error_mm: float) -> float:
    """Return a chord error that can be kept.

    Raises
    ------
    InputError
        For one that is not between 1e-6 and 1 mm.
    """
    if not FINEST_MM <= chord_error_mm <= COARSEST_MM:
        raise InputError(
            f"chord_error_mm: found {chord_error_mm:g}, expected {FINEST_MM:g} to {COARSEST_MM:g}"
        )
    return chord_error_mm


def points_within(curve: Flank, chord_error_mm: float) -> Reals:
    """Parameters of points whose chords keep to a flank.

    Parameters
    ----------
    curve : Flank
        The curve.
    chord_error_mm : float
        Largest distance of curve and chord [mm].

    Returns
    -------
    ndarray, shape (n,)
        Parameters from root to tip.
    """

    def distance(first: float, last: float) -> float:
        points = curve.flank(np.linspace(first, last, _SAMPLES)).position_mm
        chord = points[-1] - points[0]
        length = float(np.hypot(*chord))
        along, up = (points - points[0]).T
        return float(np.abs(chord[0] * up - chord[1] * along).max() / length)

    return _divided(curve.flank_range, distance, chord_error_mm)


def arcs_within(curve: Flank, chord_error_mm: float) -> tuple[Reals, float]:
    """Arcs that touch one another and keep to a flank, two for each piece of it.

    Parameters
    ----------
    curve : Flank
        The curve.
    chord_error_mm : float
        Largest distance of curve and arcs [mm].

    Returns
    -------
    ndarray, shape (n, 3)
        Ends x, y [mm] of the arcs from root to tip, and the bulge of the arc that begins there,
        the tangent of a quarter of its angle; zero at the last point.
    float
        Largest distance measured [mm].

    Notes
    -----
    A piece between two points of the curve is two arcs with the curve's directions at both ends and
    a common one where they meet (a biarc with equal legs), so the outline has no edges but the
    curve's own. Its distance falls with the cube of the piece's length.
    """

    def distance(first: float, last: float) -> float:
        points = curve.flank(np.linspace(first, last, _SAMPLES))
        ends = points.position_mm[[0, -1]], points.tangent[[0, -1]]
        return float(_distance_from_arcs(points.position_mm, _biarc(*ends)).max())

    psi = _divided(curve.flank_range, distance, chord_error_mm)
    points = curve.flank(psi)
    found = max(distance(a, b) for a, b in pairwise(psi))
    pieces = [
        _biarc(points.position_mm[k : k + 2], points.tangent[k : k + 2])
        for k in range(len(psi) - 1)
    ]
    rows = [piece[:2] for piece in pieces]
    return np.concatenate([*rows, [[*points.position_mm[-1], 0.0]]]), found


def splines_within(curve: Flank, chord_error_mm: float) -> list[tuple[Reals, Reals]]:
    """Cubic splines that touch one another and keep to a flank, over the length along it.

    Parameters
    ----------
    curve : Flank
        The curve.
    chord_error_mm : float
        Largest distance of curve and splines [mm].

    Returns
    -------
    list of tuple of ndarray
        For each spline from root to tip the parameters of its five points, and their lengths along
        the flank [mm]. With the curve's directions at both ends these make the spline.
    """
    psi = np.linspace(*curve.flank_range, _MEASURED)
    dense = curve.flank(psi)
    steps = np.hypot(*np.diff(dense.position_mm, axis=0).T)
    length = np.concatenate([[0.0], np.cumsum(steps)])
    for count in range(1, _MOST_SPLINES):
        at = np.linspace(0, length[-1], _INTERVALS * count + 1)
        ends = np.interp(at, length, psi)
        points = curve.flank(ends)
        pieces = [slice(k * _INTERVALS, (k + 1) * _INTERVALS + 1) for k in range(count)]
        farthest = 0.0
        for piece in pieces:
            tangent = points.tangent[piece]
            spline = CubicSpline(
                at[piece], points.position_mm[piece], bc_type=((1, tangent[0]), (1, tangent[-1]))
            )
            inside = (length >= at[piece][0]) & (length <= at[piece][-1])
            off = spline(length[inside]) - dense.position_mm[inside]
            along = dense.tangent[inside]
            across = np.abs(along[:, 0] * off[:, 1] - along[:, 1] * off[:, 0])
            farthest = max(farthest, float(across.max()))
        if farthest <= _SHARE * chord_error_mm:
            return [(ends[piece], at[piece]) for piece in pieces]
    raise ArithmeticError(f"no splines within {chord_error_mm:g} mm of the profile")


def _divided(whole: Range, distance: Distance, most: float) -> Reals:
    """Divide a range into the fewest pieces whose distance is within the bound, alike in it."""
    low, high = 0.0, _SHARE * most
    fewest = _marched(whole, distance, high)
    # The last piece is what was left: a smaller bound with as many pieces makes all alike.
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        ends = _marched(whole, distance, middle, len(fewest))
        if ends is None:
            low = middle
        else:
            high, fewest = middle, ends
    return np.array(fewest)


@overload
def _marched(whole: Range, distance: Distance, most: float) -> list[float]: ...
@overload
def _marched(whole: Range, distance: Distance, most: float, ends: int) -> list[float] | None: ...
def _marched(
    whole: Range, distance: Distance, most: float, ends: int | None = None
) -> list[float] | None:
    """Ends of pieces, each as long as the bound allows; None for more than so many ends."""
    first, last = whole
    found = [first]
    while found[-1] < last:
        if ends is not None and len(found) == ends:
            return None
        start = found[-1]
        # At least two pieces: both ends of a flank are alike in direction, and one would be a line.
        within, beyond = start, last if len(found) > 1 else 0.5 * (start + last)
        if distance(start, beyond) <= most:
            within = beyond
        for _ in range(_HALVINGS):
            if within == beyond:
                break
            middle = 0.5 * (within + beyond)
            if distance(start, middle) <= most:
                within = middle
            else:
                beyond = middle
        if within == start:
            raise ArithmeticError(f"no piece within {most:g} mm from {start!r}")
        found.append(within)
    return found


def _biarc(position: Reals, tangent: Reals) -> Reals:
    """Rows x, y, bulge of two arcs between two points with given directions, and the end."""
    (p, q), (t, u) = position, tangent
    chord, both = q - p, t + u
    bend = 2 * (1 - float(t @ u))
    across, square = float(chord @ both), float(chord @ chord)
    # Leg d of both arcs: bend d^2 + 2 across d - square = 0, in a form without cancellation.
    leg = square / (across + float(np.sqrt(across**2 + bend * square)))
    middle = 0.5 * (p + q + leg * (t - u))
    return np.array([[*p, _bulge(t, middle - p)], [*middle, _bulge(q - middle, u)], [*q, 0.0]])


def _bulge(first: Reals, second: Reals) -> float:
    """Tangent of half the angle between tangent and chord."""
    sine = float(first[0] * second[1] - first[1] * second[0])
    return float(np.tan(0.5 * np.arctan2(sine, float(first @ second))))


def _distance_from_arcs(points: Reals, arcs: Reals) -> Reals:
    """Distance [mm] of points from the nearer of two arcs that touch each other."""
    found = []
    for (x, y, bulge), end in pairwise(arcs):
        chord = end[:2] - (x, y)
        length = float(np.hypot(*chord))
        # Direction and curvature at the arc's first point.
        angle = 2 * np.arctan(bulge)
        along = chord / length
        normal = np.array([-along[1], along[0]]) * np.cos(angle) + along * np.sin(angle)
        curvature = 2 * np.sin(angle) / length
        from_start = points - (x, y)
        # (|point - centre| - radius) without the centre, which lies far off for a flat arc.
        inside = curvature * (from_start**2).sum(axis=1) - 2 * from_start @ normal
        found.append(np.abs(inside / (1 + np.sqrt(1 + curvature * inside))))
    # Points before the joint belong to the first arc, those after it to the second.
    joint = arcs[1, :2]
    sides = (points - joint) @ (arcs[2, :2] - arcs[0, :2]) <= 0
    distance: Reals = np.where(sides, found[0], found[1])
    return distance
