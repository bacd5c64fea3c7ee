"""Lines, one beside the other, that describe a series with the fewest parameters."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.simulation.effects.history import Floats, Ints

PARAMETERS_A_LINE = 3
"""Parameters of one of several lines: its level, its slope and where it begins."""


@dataclass(frozen=True, slots=True)
class LineSums:
    """Running sums by which the loss of a line through any rows is known at once.

    Attributes
    ----------
    x, y, xx, xy, yy : ndarray, shape (n + 1,)
        Sums over the rows before each one.
    """

    x: Floats
    y: Floats
    xx: Floats
    xy: Floats
    yy: Floats

    @classmethod
    def of(cls, torque: Floats, place: Floats) -> "LineSums":
        """Sums of some rows.

        Parameters
        ----------
        torque, place : ndarray, shape (n,)

        Returns
        -------
        LineSums
        """
        x = (place - place.mean()) / max(float(np.ptp(place)), 1e-300)
        y = torque - torque.mean()
        sums = [np.cumsum(np.r_[0.0, part]) for part in (x, y, x * x, x * y, y * y)]
        return cls(*sums)

    def losses(self, start: Ints | int, stop: Ints | int) -> Floats:
        """Sums of squares that lines leave.

        Parameters
        ----------
        start, stop : ndarray of int, shape (k,), or int
            First row of each line, and the one after its last.

        Returns
        -------
        ndarray, shape (k,)
        """
        count = np.asarray(stop) - np.asarray(start)
        x, y = self.x[stop] - self.x[start], self.y[stop] - self.y[start]
        within_x = self.xx[stop] - self.xx[start] - x * x / count
        within_y = self.yy[stop] - self.yy[start] - y * y / count
        both = self.xy[stop] - self.xy[start] - x * y / count
        sloped = (count > 2) & (within_x > 0.0)
        explained = np.divide(both**2, within_x, out=np.zeros_like(within_x), where=sloped)
        return np.where(count > 2, np.maximum(within_y - explained, 0.0), 0.0)


def best_lines(torque: Floats, place: Floats) -> tuple[Ints, float]:
    """Lines, one beside the other, that describe the rows with the smallest information criterion.

    Found exactly, places that can begin no best line left out as the search goes on (R. Killick et
    al., J. Am. Stat. Assoc. 107, 2012).

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.

    Returns
    -------
    edges : ndarray of int, shape (lines + 1,)
    criterion : float
        Sum of squares and, for each parameter, the log of the number of rows.
    """
    count = len(torque)
    sums = LineSums.of(torque, place)
    price = PARAMETERS_A_LINE * np.log(count)
    best, before = np.zeros(count + 1), np.zeros(count + 1, dtype=np.int64)
    starts = np.zeros(1, dtype=np.int64)
    for stop in range(1, count + 1):
        costs = best[starts] + sums.losses(starts, stop)
        place_of_best = int(np.argmin(costs))
        best[stop], before[stop] = costs[place_of_best] + price, starts[place_of_best]
        starts = np.r_[starts[costs <= best[stop]], stop]
    edges = [count]
    while edges[-1] > 0:
        edges.append(int(before[edges[-1]]))
    return np.asarray(edges[::-1], dtype=np.int64), float(best[count])
