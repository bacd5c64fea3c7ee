"""The torque of a programme as a few straight lines and smooth curves, where it is no more.

Rigs are told to ramp, to hold, or to follow a sine. A curve through all readings of such a stretch
knows the torque many times better than any of its readings does, and its rate better still.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from cyclosweep.diagnosis.prepare.segmentation import LineSums, best_lines
from cyclosweep.simulation.effects.history import Floats, Ints

STRAIGHT, CURVED = (0, 1), (2, 3, 5, 7, 9)
"""Degrees of the polynomials that are tried, in this order; half a sine takes five to nine."""
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
REACH = 4
"""Readings by which noise may put the corner between two lines too early or too late."""
WINDOW = 0.15
"""Share of the shorter neighbour by which a turning point is looked for about where it was read."""


@dataclass(frozen=True, slots=True)
class _Stretch:
    """Rows from `start` up to `stop`, and the curve along them; None: as they were read."""

    start: int
    stop: int
    curve: "_Curve | None"

    @property
    def is_line(self) -> bool:
        """Whether the curve is a line or a level."""
        return self.curve is not None and self.curve.terms <= STRAIGHT[-1] + 1


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

    @property
    def share(self) -> Floats:
        """Variance of the curve over that of the noise of a reading, shape (rows,)."""
        return np.asarray(np.sum(np.linalg.qr(self.basis)[0] ** 2, axis=1))


def programme_curves(
    torque_nm: Floats, angle_deg: Floats, place: Floats, piece: Ints, run: Ints, noise_nm: float
) -> tuple[Floats, Floats]:
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
    curves : ndarray, shape (2, n)
        Torque [N m] and twist [deg]; NaN where no curve was found, and at readings far from it.
    share : ndarray, shape (n,)
        Variance of the curve over that of the noise of a reading; one without a curve.
    """
    found, share = np.full((2, len(torque_nm)), np.nan), np.ones(len(torque_nm))
    unit = torque_nm / noise_nm
    both = np.column_stack([torque_nm, angle_deg])
    edges = _edges(piece)
    stretches: list[_Stretch] = []
    for start, stop in pairwise(_edges(run)):
        inner = edges[(edges >= start) & (edges <= stop)]
        stretches += _along_a_run(unit, place, inner)
    for each in stretches:
        if each.curve is not None:
            rows = slice(each.start, each.stop)
            found[:, rows] = each.curve.through(both[rows]).T
            share[rows] = each.curve.share
    corner = np.abs(torque_nm - found[0]) > OUTLIER * noise_nm
    return np.where(corner, np.nan, found), np.where(corner, 1.0, share)


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
        sums = LineSums.of(torque[low:high], place[low:high])
        losses = sums.losses(0, near - low) + sums.losses(near - low, high - low)
        best = int(near[np.argmin(losses)])
        parts = [slice(low, best), slice(best, high)]
        if all(_polynomial(torque[p], place[p], STRAIGHT) is not None for p in parts):
            moved[k] = best
    return moved


def _along_a_run(torque: Floats, place: Floats, edges: Ints) -> list[_Stretch]:
    """A sine through a run; or curves through its pieces, or lines that know nothing of these.

    Noise ends a piece some readings before or behind the corner of the programme.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.
    edges : ndarray of int, shape (pieces + 1,)
        First row of each piece of the run, and the one after its last.

    Returns
    -------
    list of _Stretch
    """
    start, stop = int(edges[0]), int(edges[-1])
    sine = _sine(torque[start:stop], place[start:stop])
    if sine is not None:
        return [_Stretch(start, stop, sine)]
    by_pieces = [
        stretch
        for low, high in pairwise(_moved(torque, place, edges))
        for stretch in _stretches(torque, place, low, high)
    ]
    if np.any(np.diff(place[start:stop]) <= 0.0):
        return by_pieces
    by_lines = _as_lines(torque, place, start, best_lines(torque[start:stop], place[start:stop])[0])
    best = min(by_pieces, by_lines, key=lambda found: _criterion(found, torque))
    return _met_at_corners(best, torque, place)


def _met_at_corners(stretches: list[_Stretch], torque: Floats, place: Floats) -> list[_Stretch]:
    """Let lines end where they meet; noise puts readings beside a corner on the wrong one.

    Parameters
    ----------
    stretches : list of _Stretch
        All of a run, one beside the other.
    torque, place : ndarray, shape (n,)
        Torque over its noise.

    Returns
    -------
    list of _Stretch
        Lines between which the torque jumps stay as they were.
    """
    found = list(stretches)
    for k in range(1, len(found)):
        one, other = found[k - 1], found[k]
        if not (one.is_line and other.is_line):
            continue
        low, edge, high = one.start, other.start, other.stop
        near = np.arange(max(low + FEWEST, edge - REACH), min(high - FEWEST, edge + REACH) + 1)
        if len(near) == 0:
            continue
        (a, b), (c, d) = (
            np.polyfit(place[e.start : e.stop], torque[e.start : e.stop], 1) for e in (one, other)
        )
        meeting = (d - b) / (a - c) if a != c else np.inf
        corner = int(np.searchsorted(place[low:high], meeting, side="right")) + low
        if corner == edge or corner not in near:
            continue
        own = slice(min(corner, edge), max(corner, edge))
        x, y = place[own], torque[own]
        worse = float(np.sum((y - a * x - b) ** 2 - (y - c * x - d) ** 2))
        if (worse if corner > edge else -worse) > OUTLIER**2:
            continue
        parts = [slice(low, corner), slice(corner, high)]
        lines = [_polynomial(torque[p], place[p], STRAIGHT) for p in parts]
        if all(line is not None for line in lines):
            found[k - 1] = _Stretch(low, corner, lines[0])
            found[k] = _Stretch(corner, high, lines[1])
    return found


def _criterion(stretches: list[_Stretch], torque: Floats) -> float:
    """Sum of squares and, for each parameter, the log of the number of rows, of a whole run.

    Parameters
    ----------
    stretches : list of _Stretch
        All of the run, one beside the other.
    torque : ndarray, shape (n,)
        Torque over its noise.

    Returns
    -------
    float
    """
    total, parameters = 0.0, 0
    for each in stretches:
        own = torque[each.start : each.stop]
        if each.curve is None:
            parameters += len(own)
            continue
        total += float(np.sum(np.clip(own - each.curve.through(own), -OUTLIER, OUTLIER) ** 2))
        parameters += each.curve.terms + 1
    return total + parameters * float(np.log(stretches[-1].stop - stretches[0].start))


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
    cuts, loss = best_lines(torque[rows], place[rows])
    curve = _polynomial(torque[rows], place[rows], CURVED)
    if curve is not None:
        charge = curve.terms * np.log(stop - start)
        if float(np.sum((torque[rows] - curve.through(torque[rows])) ** 2)) + charge <= loss:
            return [_Stretch(start, stop, curve)]
    return _as_lines(torque, place, start, cuts)


def _as_lines(torque: Floats, place: Floats, start: int, cuts: Ints) -> list[_Stretch]:
    """Lines, or levels where these suffice, between cuts.

    Parameters
    ----------
    torque, place : ndarray, shape (n,)
        Torque over its noise.
    start : int
        First row.
    cuts : ndarray of int, shape (lines + 1,)
        Rows from there at which a line begins, and the number of rows.

    Returns
    -------
    list of _Stretch
    """
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
