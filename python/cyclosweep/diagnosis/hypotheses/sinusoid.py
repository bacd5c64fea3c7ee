"""A sinusoid of unknown frequency: in time, in time and proportional to torque, or along the twist.

The periodogram of the residual shows it. The more frequencies are looked at, the higher a peak
chance makes, so the logarithm of their number is taken off the evidence.
"""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from scipy.stats import gumbel_r

from cyclosweep.diagnosis.hypotheses.shape_columns import clock_of
from cyclosweep.diagnosis.hypotheses.unnamed_shapes import UnnamedShape
from cyclosweep.simulation.effects.history import Flags, Floats, History, Ints

IN_TIME = "hum"
ALONG_TWIST = "ripple along the twist"
WITH_TORQUE = "hum in proportion to torque"
FAMILIES = (IN_TIME, ALONG_TWIST, WITH_TORQUE)
"""Kinds of sinusoid, as results call them."""
CYCLES = 1.5
"""A sinusoid in time makes at least this many cycles within the usual run, one along the twist
within its range. Slower ones are left to other shapes."""
FEW_CYCLES = 3.0
"""Cycles within a run up to which a wave that is sampled once a cycle looks like a slow change."""
FINEST = 250
"""Most cycles within the range of twist that are looked for."""
APART = 2.0
"""Cycles within the range of twist by which a ripple differs at least from that of the rounding."""
HARMONICS = 5
"""Multiples of the frequency of rounding that are looked for where even steps of the twist from row
to row mirror them at lower frequencies."""
WIDEST = 0.02
"""Cycles a row by which a sinusoid differs from such a mirror at most to be taken for it: in short
runs it would be any."""
MIRRORED_ROWS = 0.2
"""Share of the rows that see a sinusoid as such a multiple, from which it is rounding."""
PRIOR_PENALTY = 1.0
"""Log prior odds against a sinusoid."""


def find_sinusoid(
    history: History, fitted: Flags, residual: Floats, resolution_deg: float = 0.0
) -> tuple[float, UnnamedShape | None]:
    """Evidence of the strongest sinusoid in a white residual, and its columns.

    Parameters
    ----------
    history : History
        All n rows of the recording.
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    residual : ndarray, shape (fitted,)
        White residual of unit variance.
    resolution_deg : float
        Step of the angle reading [deg]; a ripple with as many cycles is its rounding.

    Returns
    -------
    evidence : float
        Half the chi-squared gain less the log of the number of frequencies looked at [nat].
    shape : UnnamedShape or None
        Cosine and sine of that frequency.
    """
    found = [
        _in_time(history, fitted, residual, resolution_deg),
        _in_time(history, fitted, residual, resolution_deg, with_torque=True),
        _along_twist(history, fitted, residual, resolution_deg),
    ]
    return max(found, key=lambda pair: pair[0])


def _beyond_play(history: History) -> Floats:
    """Twist beyond the free play [deg]."""
    return history.angle_deg - history.side * history.free_play_deg


def _in_time(
    history: History,
    fitted: Flags,
    residual: Floats,
    resolution_deg: float,
    *,
    with_torque: bool = False,
) -> tuple[float, UnnamedShape | None]:
    """Strongest sinusoid in time, of even amplitude or in proportion to torque.

    Parameters
    ----------
    history : History
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    residual : ndarray, shape (fitted,)
        White residual of unit variance.
    resolution_deg : float
        Step of the angle reading [deg].
    with_torque : bool
        Whether the amplitude is proportional to the torque.

    Returns
    -------
    float, UnnamedShape or None
        Evidence [nat] and columns.
    """
    clock = clock_of(history)[fitted]
    count = len(clock)
    steps = np.diff(clock)
    positive = steps[steps > 0]
    if count < 60 or len(positive) == 0:
        return 0.0, None
    # Runs may be sampled at different rates: the fast ones tell the high frequencies apart.
    step = float(np.quantile(positive, 0.1))
    cell = np.round((clock - clock[0]) / step)
    if cell[-1] > 60 * count:
        cell = np.arange(count, dtype=np.float64)
        step = float((clock[-1] - clock[0]) / max(count - 1, 1))
    cell = cell.astype(np.int64)
    run = history.run[fitted]
    twist = _beyond_play(history)[fitted]
    runs = max(int(np.count_nonzero(history.restart & fitted)), 1)
    samples = count / runs * float(np.median(positive)) / step
    unit = "Hz" if history.time_s is not None else "cycles a row"
    return _strongest(
        cell,
        residual,
        lowest=CYCLES / samples,
        highest=0.5,
        hidden=lambda frequency: (
            _looks_slow(frequency, cell, run)
            | _mirrors_rounding(frequency, cell, twist, run, resolution_deg)
        ),
        unit=step,
        family=WITH_TORQUE if with_torque else IN_TIME,
        place="at {:.4g} " + unit + ", all along",
        clock=clock_of,
        factor=(lambda h: h.applied_nm / h.largest_torque_nm) if with_torque else None,
        scale=history.applied_nm[fitted] if with_torque else None,
    )


def _looks_slow(frequency: Floats, cell: Ints, run: Ints) -> Flags:
    """Frequencies that most rows see as something slow: whole multiples of their sampling rate.

    Parameters
    ----------
    frequency : ndarray, shape (k,)
        In cycles a cell.
    cell : ndarray of int, shape (fitted,)
        Place of each row along the clock.
    run : ndarray of int, shape (fitted,)
        Run of each row.

    Returns
    -------
    ndarray of bool, shape (k,)
    """
    rows = np.zeros(len(frequency))
    for label in np.unique(run):
        here = cell[run == label]
        between = np.median(np.diff(here)) if len(here) > 1 else 1.0
        seen = frequency * between
        whole = np.rint(seen)
        slow = (whole > 0.0) & (np.abs(seen - whole) * len(here) < FEW_CYCLES)
        rows += np.where(slow, len(here), 0)
    return np.asarray(rows > 0.5 * len(cell))


def _mirrors_rounding(
    frequency: Floats, clock: Floats | Ints, twist: Floats, run: Ints, resolution_deg: float
) -> Flags:
    """Frequencies at which rounding shows where the twist grows by equal steps from row to row.

    Parameters
    ----------
    frequency : ndarray, shape (k,)
        In cycles a unit of the clock.
    clock : ndarray, shape (fitted,)
        Place of each row in what the phase is proportional to.
    twist : ndarray, shape (fitted,)
        Twist of each row beyond the free play [deg].
    run : ndarray of int, shape (fitted,)
        Run of each row.
    resolution_deg : float
        Step of the angle reading [deg].

    Returns
    -------
    ndarray of bool, shape (k,)
    """
    rows = np.zeros(len(frequency))
    if resolution_deg <= 0.0:
        return rows > 0.0
    for label in np.unique(run):
        here = run == label
        if np.count_nonzero(here) < 2:
            continue
        growth = float(np.median(np.abs(np.diff(twist[here])))) / resolution_deg
        seen = frequency * float(np.median(np.abs(np.diff(clock[here]))))
        if growth == 0.0:
            continue
        close = min(APART * growth * resolution_deg / float(np.ptp(twist[here])), WIDEST)
        near = np.zeros(len(frequency), dtype=bool)
        for multiple in range(1, HARMONICS + 1):
            for apart in (seen - multiple * growth, seen + multiple * growth):
                near |= np.abs(apart - np.rint(apart)) < close
        rows += np.where(near, np.count_nonzero(here), 0)
    return np.asarray(rows > MIRRORED_ROWS * len(twist))


def _along_twist(
    history: History, fitted: Flags, residual: Floats, resolution_deg: float
) -> tuple[float, UnnamedShape | None]:
    """Strongest sinusoid along the twist beyond the free play.

    Parameters
    ----------
    history : History
    fitted : ndarray of bool, shape (n,)
        Rows that are fitted.
    residual : ndarray, shape (fitted,)
        White residual of unit variance.
    resolution_deg : float
        Step of the angle reading [deg].

    Returns
    -------
    float, UnnamedShape or None
        Evidence [nat] and columns.
    """
    twist = _beyond_play(history)[fitted]
    span = float(np.ptp(twist))
    if len(twist) < 60 or span <= 0:
        return 0.0, None
    cells = 8 * FINEST
    step = span / cells
    place = (twist - twist.min()) / step
    cell = np.floor(place).astype(np.int64)
    return _strongest(
        cell,
        residual,
        lowest=CYCLES / cells,
        highest=FINEST / cells,
        unit=step,
        family=ALONG_TWIST,
        place="with {:.4g} cycles a degree, over the whole range",
        clock=_beyond_play,
        rounding=resolution_deg / step,
        hidden=lambda frequency: _mirrors_rounding(
            frequency, place, twist, history.run[fitted], resolution_deg
        ),
    )


def _strongest(
    cell: np.ndarray,
    residual: Floats,
    *,
    lowest: float,
    highest: float,
    unit: float,
    family: str,
    place: str,
    clock: Callable[[History], Floats],
    factor: Callable[[History], Floats] | None = None,
    scale: Floats | None = None,
    rounding: float = 0.0,
    hidden: Callable[[Floats], Flags] | None = None,
) -> tuple[float, UnnamedShape | None]:
    """Strongest frequency of a residual between two limits.

    Parameters
    ----------
    cell : ndarray of int, shape (fitted,)
        Place of each row along the clock, in cells of equal size.
    residual : ndarray, shape (fitted,)
        White residual of unit variance.
    lowest, highest : float
        Limits of the frequency [cycles a cell].
    unit : float
        Size of a cell [unit of the clock].
    family, place : str
        Words for the result; ``place`` takes the frequency.
    clock : callable
        From a load history of n rows to what the phase is proportional to, shape (n,).
    factor : callable, optional
        From a load history to a factor of the amplitude, shape (n,).
    scale : ndarray, shape (fitted,), optional
        The same factor on the fitted rows, in any unit.
    rounding : float
        Period of which a whole number of cycles counts for nothing [cells].
    hidden : callable, optional
        From frequencies [cycles a cell] to which of them count for nothing, too.

    Returns
    -------
    float, UnnamedShape or None
        Evidence [nat], and cosine and sine of the frequency.
    """
    count = len(residual)
    if scale is not None:
        residual = residual * scale / np.sqrt(np.mean(scale**2))
    length = 1 << int(np.ceil(np.log2(2 * (int(cell.max()) + 1))))
    series = np.bincount(cell, residual, minlength=length)[:length]
    power = np.abs(np.fft.rfft(series)) ** 2 / count
    frequency = np.fft.rfftfreq(length)
    cycles = rounding * frequency
    rounded = np.abs(cycles - np.rint(cycles)) * (cell.max() + 1) < APART * rounding
    usable = (frequency > lowest) & (frequency < highest) & ~(rounded & (cycles > 0.5))
    if hidden is not None:
        usable[usable] = ~hidden(frequency[usable])
    if np.count_nonzero(usable) < 8:
        return 0.0, None
    power = power / np.maximum(_floor(power), 1.0)
    best = int(np.argmax(np.where(usable, power, 0.0)))
    independent = max(float(np.mean(usable)) * (int(cell.max()) + 1) / 2.0, 1.0)
    value = float(power[best] - np.log(3.5 * independent) - PRIOR_PENALTY)
    chosen = float(frequency[best]) / unit

    def columns(h: History) -> Floats:
        angle = 2 * np.pi * chosen * clock(h)
        waves = np.column_stack([np.cos(angle), np.sin(angle)])
        return waves if factor is None else waves * factor(h)[:, None]

    return max(value, 0.0), UnnamedShape(family, place.format(chosen), columns)


def _floor(power: Floats) -> Floats:
    """Level of the noise around each frequency, where the whitening was not perfect."""
    width = max(len(power) // 24, 16)
    count = max(len(power) // width, 1)
    edges = np.linspace(0, len(power), count + 1).astype(int)
    level = [float(np.median(power[a:b])) / np.log(2.0) for a, b in pairwise(edges)]
    middle = 0.5 * (edges[1:] + edges[:-1])
    return np.asarray(np.interp(np.arange(len(power)), middle, level), dtype=np.float64)


def null_evidence(count: int, rng: np.random.Generator) -> Floats:
    """Evidence of the strongest sinusoid in white noise: the largest of three Gumbel variables.

    Parameters
    ----------
    count : int
        Number of draws.
    rng : numpy.random.Generator

    Returns
    -------
    ndarray, shape (count,)
        In nat.
    """
    largest = gumbel_r.ppf(rng.uniform(1e-12, 1.0, (len(FAMILIES), count))).max(axis=0)
    return np.asarray(np.maximum(largest - PRIOR_PENALTY, 0.0))
