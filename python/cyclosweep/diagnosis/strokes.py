"""Torque as a function of the angle, stroke by stroke, counted by the travel of the shaft."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.recording import Recording
from cyclosweep.recording.structure import spans_of_runs, turning_points
from cyclosweep.simulation.effects.history import Flags, Floats

STROKE_SHARE = 0.05
"""A change of direction of the motion counts once the angle has gone back by this share of its
range: far above reading noise, far below a stroke that slides."""
CELLS = 200
"""Equal cells of the range of the angle, in each of which a stroke has one torque."""
WHOLE_CELL = 0.5
"""Share of a cell from which a stroke that ends in it has a torque there."""
WHOLE_RANGE = 0.02
"""Share of the travel cut from either end of the torque before its range is taken, against
single peaks at break-away."""

LOOP_SHARE = 0.4
"""Area of the loop over that of the rectangle around it from which friction carries as much as the
spring: a spring with friction of a quarter of its torque has 0.25, an ideal brake 1. Measured: 0.74
and 0.75 for two band brakes with backlash, at most 0.31 for 17 recordings of a printed drive and
0.27 for 300 made drives with and without friction."""


@dataclass(frozen=True, eq=False)
class Strokes:
    """Strokes of the shaft between its turning points, as torque over the angle.

    How densely a stroke was read, and whether a reading stands there twice, makes no difference:
    between two readings the torque is taken to change evenly with the angle.

    Attributes
    ----------
    rising, falling : ndarray, shape (strokes, cells)
        Mean torque of each stroke in each cell of the angle [N m]; NaN where it does not pass.
    cell_deg : float
        Width of a cell [deg].
    rising_read, falling_read : ndarray of bool, shape (strokes, cells)
        Cells of each stroke in which a reading stands.
    """

    rising: Floats
    falling: Floats
    cell_deg: float
    rising_read: Flags
    falling_read: Flags

    @property
    def loop_share(self) -> float:
        """Area of the loop over that of the rectangle around it; zero without both directions.

        A spring, however soft or played out, has the same torque in both directions at the same
        angle; with friction of a share of the largest torque the loop has about this share.
        """
        both = np.r_[self.rising.ravel(), self.falling.ravel()]
        both = both[np.isfinite(both)]
        passed = np.isfinite(self.rising).any(axis=0) & np.isfinite(self.falling).any(axis=0)
        if not passed.any():
            return 0.0
        low, high = np.quantile(both, (WHOLE_RANGE, 1.0 - WHOLE_RANGE))
        if high <= low:
            return 0.0
        up, down = (np.nanmedian(part[:, passed], axis=0) for part in (self.rising, self.falling))
        return float(np.sum(up - down)) / CELLS / float(high - low)


def strokes_of(recording: Recording) -> Strokes | None:
    """Split a recording where the motion of the shaft turns, and read the torque of each stroke.

    Parameters
    ----------
    recording : Recording
        With or without an angle.

    Returns
    -------
    Strokes or None
        None where there is no angle, or it does not change.
    """
    angle, torque, run = recording.angle_deg, recording.torque_nm, recording.run
    if angle is None or len(angle) < 2 or not np.ptp(angle) > 0:
        return None
    span = float(np.ptp(angle))
    edges = np.linspace(float(angle.min()), float(angle.max()), CELLS + 1)
    rising: list[Floats] = []
    falling: list[Floats] = []
    rising_read: list[Flags] = []
    falling_read: list[Flags] = []
    for start, stop in spans_of_runs(run):
        part = angle[start:stop]
        turns = turning_points(part, STROKE_SHARE * span).tolist()
        # A turning point ends one stroke and begins the next.
        for first, last in pairwise([0, *turns, len(part) - 1]):
            rows = slice(start + first, start + last + 1)
            rises = part[last] >= part[first]
            (rising if rises else falling).append(_by_cell(torque[rows], angle[rows], edges))
            read = np.histogram(angle[rows], edges)[0] > 0
            (rising_read if rises else falling_read).append(read)
    whole = (-1, CELLS)
    return Strokes(
        rising=np.array(rising, np.float64).reshape(whole),
        falling=np.array(falling, np.float64).reshape(whole),
        cell_deg=span / CELLS,
        rising_read=np.array(rising_read, bool).reshape(whole),
        falling_read=np.array(falling_read, bool).reshape(whole),
    )


def _by_cell(torque: Floats, angle: Floats, edges: Floats) -> Floats:
    """Mean torque of one stroke in each cell of the angle [N m].

    Parameters
    ----------
    torque, angle : ndarray, shape (n,)
        Torque [N m] and twist [deg] of the stroke.
    edges : ndarray, shape (cells + 1,)
        Ends of the cells [deg].

    Returns
    -------
    ndarray, shape (cells,)
        NaN where the stroke passes less than half of the cell.
    """
    # Readings that stand there twice count once; noise of the angle adds no travel.
    at, of = np.unique(np.column_stack([angle, torque]), axis=0).T
    places, place = np.unique(at, return_inverse=True)
    mean = np.bincount(place, of) / np.bincount(place)
    inner = edges[(edges > places[0]) & (edges < places[-1])]
    points = np.union1d(places, inner)
    torques = np.interp(points, places, mean)
    area = np.r_[0.0, np.cumsum(np.diff(points) * (torques[1:] + torques[:-1]) / 2.0)]
    ends = np.clip(edges, places[0], places[-1])
    passed = np.diff(ends)
    whole = passed >= WHOLE_CELL * (edges[1] - edges[0])
    work = np.diff(np.interp(ends, points, area))
    return np.where(whole, work / np.where(whole, passed, 1.0), np.nan)
