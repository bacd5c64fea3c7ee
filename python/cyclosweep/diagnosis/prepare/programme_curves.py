"""The torque of a programme as a few straight lines and smooth curves, where it is no more.

Rigs are told to ramp, to hold, or to follow a sine. A curve through all readings of such a stretch
knows the torque many times better than any of its readings does, and its rate better still.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.simulation.effects.history import Floats, Ints

STRAIGHT, CURVED = (0, 1), (2, 3, 5, 7, 9)
"""Degrees of the polynomials that are tried, in this order; half a sine takes five to nine."""
PARAMETERS_A_LINE = 3
"""Parameters of one of several lines: its level, its slope and where it begins."""
ROWS_A_TERM = 3
"""Rows that there have to be for each coefficient."""
FEWEST = 4
"""Fewest rows of a stretch that is looked at."""
BLOCKS = (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024)
"""Rows over which residuals are averaged to see whether they are noise."""
BEYOND = 4.0
"""Standard deviations of their chi-squared by which averages of noise may be too large."""
OUTLIER = 4.0
"""Standard deviations at which residuals are clipped in that, and from which a reading stays as it
is: it lies on a corner of the programme."""
HARMONICS = 5
"""Multiples of its frequency by which a sine may be distorted."""
FEWEST_CYCLES = 1.5
"""Fewest cycles of a sine."""
WINDOW = 0.15
"""Share of the shorter neighbour by which a turning point is looked for about where it was read."""


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Rows from `start` up to `stop`, and the curve along them; None: as they were read."""

    start: int
    stop: int
    curve: "_Curve | None"


@dataclass(frozen=True, slots=True)
class _Curve:
    """Columns of which a curve through some rows is made."""

    basis: Floats

    @property
    def terms(self) -> int:
        """Number of its coefficients."""
        return int(self.basis.shape[1])

    def through(self, values: Floats) -> Floats:
        """The curve that comes closest to some values, shape (rows,) or (rows, k) as they are."""
        return np.asarray(self.basis @ np.linalg.lstsq(self.basis, values, rcond=None)[0])


def programme_curves(
    torque_nm: Floats, angle_deg: Floats, place: Floats, piece: Ints, run: Ints, noise_nm: float
) -> Floats:
    """Replace the torque by lines and curves where it differs from them by noise alone.

    Parameters
    ----------
    torque_nm : ndarray, shape (n,)
        As it was read [N m].
    angle_deg : ndarray, shape (n,)
        Twist, of which the same curves are taken [deg].
    place : ndarray, shape (n,)
        Clock, or number of the row; it grows within each piece.
    piece : ndarray of int, shape (n,)
        Label of the piece of each row; equal ones are consecutive. A programme turns, breaks off or
        goes on in another run at most where a piece ends.
    run : ndarray of int, shape (n,)
        Run of each row.
    noise_nm : float
        Standard deviation of the noise of a reading [N m].

    Returns
    -------
    ndarray, shape (2, n)
        Torque [N m] and twist [deg]; NaN where no curve was found, and at readings far from it.
    """
    found = np.full((2, len(torque_nm)), np.nan)
    unit = torque_nm / noise_nm
    both = np.column_stack([torque_nm, angle_deg])
    stretches = [
        _Stretch(start, stop, _sine(unit[start:stop], place[start:stop]))
        for start, stop in pairwise(_edges(run))
    ]
    known = np.zeros(len(unit), dtype=bool)
    for sine in stretches:
        known[sine.start : sine.stop] = sine.curve is not None
    for start, stop in pairwise(_moved(unit, place, _edges(piece))):
        if not np.all(known[start:stop]):
            stretches += _stretches(unit, place, start, stop)
    for each in stretches:
        if each.curve is not None:
            rows = slice(each.start, each.stop)
            found[:, rows] = each.curve.through(both[rows]).T
    corner = np.abs(torque_nm - found[0]) > OUTLIER * noise_nm
    return np.where(corner, np.nan, found)


def _edges(label: Ints) -> Ints:
    """First row of each stretch of equal labels, and the number of rows, shape (stretches + 1,)."""
    return np.flatnonzero(np.r_[True, np.diff(label) != 0, True])


def _moved(torque: Floats, place: Floats, edges: Ints) -> Ints:
    """Edges between pieces, each where two lines beside it fit best; noise hides where it was.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.
    edges : ndarray of int, shape (pieces + 1,)

    Returns
    -------
    ndarray of int, shape (pieces + 1,)
        Edges stay where no two lines fit.
    """
    moved = edges.copy()
    for k in range(1, len(edges) - 1):
        low, edge, high = int(moved[k - 1]), int(edges[k]), int(edges[k + 1])
        window = int(WINDOW * min(edge - low, high - edge))
        near = np.arange(edge - window, edge + window + 1)
        near = near[(near - low >= FEWEST) & (high - near >= FEWEST)]
        if window < 1 or len(near) == 0 or np.any(np.diff(place[low:high]) <= 0.0):
            continue
        sums = _LineSums.of(torque[low:high], place[low:high])
        losses = sums.losses(0, near - low) + sums.losses(near - low, high - low)
        best = int(near[np.argmin(losses)])
        parts = [slice(low, best), slice(best, high)]
        if all(_polynomial(torque[p], place[p], STRAIGHT) is not None for p in parts):
            moved[k] = best
    return moved


def _stretches(torque: Floats, place: Floats, start: int, stop: int) -> list[_Stretch]:
    """One line through some rows, or several, or a curve, whatever takes the fewest parameters.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.
    start, stop : int
        First row, and the one after the last.

    Returns
    -------
    list of _Stretch
    """
    rows = slice(start, stop)
    straight = _polynomial(torque[rows], place[rows], STRAIGHT)
    if straight is not None or stop - start < FEWEST or np.any(np.diff(place[rows]) <= 0.0):
        return [_Stretch(start, stop, straight)]
    cuts, loss = _lines(torque[rows], place[rows])
    curve = _polynomial(torque[rows], place[rows], CURVED)
    if curve is not None:
        charge = curve.terms * np.log(stop - start)
        if float(np.sum((torque[rows] - curve.through(torque[rows])) ** 2)) + charge <= loss:
            return [_Stretch(start, stop, curve)]
    lines = []
    for first, last in pairwise(start + cuts):
        part = slice(first, last)
        line = _polynomial(torque[part], place[part], STRAIGHT)
        lines.append(_Stretch(int(first), int(last), line))
    return lines


def _polynomial(torque: Floats, place: Floats, degrees: tuple[int, ...]) -> _Curve | None:
    """Polynomial of the first of some degrees that leaves noise alone; None where none does.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.
    degrees : tuple of int

    Returns
    -------
    _Curve or None
    """
    count = len(torque)
    if count < FEWEST or place[-1] <= place[0]:
        return None
    x = 2.0 * (place - place[0]) / (place[-1] - place[0]) - 1.0
    for degree in degrees:
        if count < ROWS_A_TERM * degree + 1:
            return None
        curve = _Curve(np.polynomial.legendre.legvander(x, degree))
        if _is_noise(torque - curve.through(torque)):
            return curve
    return None


def _sine(torque: Floats, place: Floats) -> _Curve | None:
    """Sine of several cycles with harmonics and a line; None where more than noise is left.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.

    Returns
    -------
    _Curve or None
    """
    from scipy.optimize import minimize_scalar

    count = len(torque)
    if count < ROWS_A_TERM * (2 * HARMONICS + 2) or np.any(np.diff(place) <= 0.0):
        return None
    x = (place - place[0]) / (place[-1] - place[0])
    even = np.interp(np.linspace(0.0, 1.0, count), x, torque)
    power = np.abs(np.fft.rfft(even - even.mean())) ** 2
    cycles = float(np.argmax(power))
    harmonics = min(HARMONICS, int(0.4 * count / max(cycles, 1.0)))
    if cycles < FEWEST_CYCLES or harmonics < 1:
        return None

    def curve(cycles: float) -> _Curve:
        phase = 2.0 * np.pi * cycles * np.outer(x, np.arange(1, harmonics + 1))
        return _Curve(np.column_stack([np.ones(count), x, np.cos(phase), np.sin(phase)]))

    best = minimize_scalar(
        lambda cycles: float(np.sum((torque - curve(cycles).through(torque)) ** 2)),
        bounds=(cycles - 1.0, cycles + 1.0),
        method="bounded",
        options={"xatol": 1e-7},
    )
    found = curve(float(best.x))
    return found if _is_noise(torque - found.through(torque)) else None


def _is_noise(residual: Floats) -> bool:
    """Whether averages of unit-variance residuals are as small as those of noise.

    Parameters
    ----------
    residual : ndarray, shape (n,)

    Returns
    -------
    bool
    """
    sums = np.cumsum(np.r_[0.0, np.clip(residual, -OUTLIER, OUTLIER)])
    for rows in BLOCKS:
        count = len(residual) // rows
        if count == 0:
            break
        means = np.diff(sums[: count * rows + 1 : rows]) / np.sqrt(rows)
        if float(means @ means) > count + BEYOND * np.sqrt(2.0 * count) + BEYOND:
            return False
    return True


@dataclass(frozen=True, slots=True)
class _LineSums:
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
    def of(cls, torque: Floats, place: Floats) -> "_LineSums":
        """Sums of some rows.

        Parameters
        ----------
        torque, place : ndarray, shape (n,)

        Returns
        -------
        _LineSums
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


def _lines(torque: Floats, place: Floats) -> tuple[Ints, float]:
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
    sums = _LineSums.of(torque, place)
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
