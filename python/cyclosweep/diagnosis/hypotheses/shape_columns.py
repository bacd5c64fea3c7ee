"""Columns of twist of which unnamed shapes consist, for a load history."""

import numpy as np

import cyclosweep._core as _core
from cyclosweep.simulation.effects.history import Floats, History


def clock_of(history: History) -> Floats:
    """Time of each row [s], or its number where there is no clock."""
    if history.time_s is None:
        return np.arange(len(history), dtype=np.float64)
    return history.time_s


def hats(values: Floats, knots: Floats) -> Floats:
    """Piecewise linear basis functions.

    Parameters
    ----------
    values : ndarray, shape (n,)
    knots : ndarray, shape (k,)
        Where one of the functions is one and all others are zero.

    Returns
    -------
    ndarray, shape (n, k)
    """
    count, width = len(knots), np.diff(knots)
    if count < 2 or not np.all(width > 0):
        return np.column_stack([np.interp(values, knots, row) for row in np.eye(count)])
    left = np.clip(np.searchsorted(knots, values, side="right") - 1, 0, count - 2)
    along = np.clip(values, knots[0], knots[-1]) - knots[left]
    slope = 1.0 / width[left]
    out = np.zeros((len(values), count))
    rows = np.arange(len(values))
    out[rows, left] = 1.0 - slope * along
    out[rows, left + 1] = slope * along
    last = values >= knots[-1]
    out[last, count - 2], out[last, count - 1] = 0.0, 1.0
    return out


def after(place: int, run: int | None, history: History) -> Floats:
    """One from a row on, to the end of the recording or of one run.

    Parameters
    ----------
    place : int
        Row from which on.
    run : int or None
        The only run that counts; None for all.
    history : History

    Returns
    -------
    ndarray, shape (n, 1)
    """
    rows = np.arange(len(history)) >= place
    if run is not None:
        rows &= history.run == run
    return np.asarray(rows, dtype=np.float64)[:, None]


def wider_after(place: int, history: History) -> Floats:
    """More free play from a row on.

    Parameters
    ----------
    place : int
        Row from which on.
    history : History

    Returns
    -------
    ndarray, shape (n, 1)
    """
    return np.asarray((np.arange(len(history)) >= place) * history.side)[:, None]


def softer_after(place: int, history: History) -> Floats:
    """More compliance from a row on.

    Parameters
    ----------
    place : int
        Row from which on.
    history : History

    Returns
    -------
    ndarray, shape (n, 1)
    """
    return np.asarray((np.arange(len(history)) >= place) * history.elastic_nm)[:, None]


def one_run(number: int, history: History) -> Floats:
    """One during one run.

    Parameters
    ----------
    number : int
        Index of the run.
    history : History

    Returns
    -------
    ndarray, shape (n, 1)
    """
    return np.asarray(history.run == number, dtype=np.float64)[:, None]


def constant(columns: Floats, history: History) -> Floats:
    """Columns that do not depend on the path of the shaft.

    Parameters
    ----------
    columns : ndarray, shape (n, k)
    history : History

    Returns
    -------
    ndarray, shape (n, k)
        The same columns.
    """
    return columns


def bump(history: History, centre: float, width: float, flank: int) -> Floats:
    """Bell curve about a load, centre and width in N m; flank 0 stands for both.

    Parameters
    ----------
    history : History
    centre : float
        Load at the peak [N m].
    width : float
        Standard deviation of the bell curve [N m].
    flank : int
        +1 or -1; 0 for both.

    Returns
    -------
    ndarray, shape (n, 1)
    """
    bump = np.exp(-0.5 * ((np.abs(history.applied_nm) - centre) / width) ** 2)
    return (bump * (history.side if flank == 0 else (history.side == flank)))[:, None]


def clipped(history: History, limit: float) -> Floats:
    """What an angle reading that stops at a limit [deg] lacks.

    Parameters
    ----------
    history : History
    limit : float
        Largest reading [deg].

    Returns
    -------
    ndarray, shape (n, 1)
        In deg for unit amplitude.
    """
    # A sensor at its limit shows too little, never too much.
    over = np.maximum(np.abs(history.angle_deg) - limit, 0.0)
    return np.asarray(-np.sign(history.angle_deg) * over)[:, None]


def beyond(history: History, start: float, flank: int) -> Floats:
    """Lack of twist in proportion to the load beyond a start [N m]; flank 0 stands for both.

    Parameters
    ----------
    history : History
    start : float
        Load from which on [N m].
    flank : int
        +1 or -1; 0 for both.

    Returns
    -------
    ndarray, shape (n, 1)
        In N m.
    """
    over = -np.maximum(np.abs(history.applied_nm) - start, 0.0)
    here = 1.0 if flank == 0 else (history.side == flank)
    return np.asarray(over * history.side * here)[:, None]


def lapse(history: History) -> Floats:
    """Time since the sample before, none at the start of a run [s]."""
    assert history.time_s is not None
    step = np.diff(history.time_s, prepend=history.time_s[:1])
    step[history.run_starts] = 0.0
    return step


def rates(history: History) -> Floats:
    """Rate of the torque, plain and with a digressive power."""
    step, elapsed = np.diff(history.applied_nm, prepend=history.applied_nm[:1]), lapse(history)
    rate = np.divide(step, elapsed, out=np.zeros_like(step), where=elapsed > 0)
    first = history.run_starts
    rate[first] = rate[np.minimum(first + 1, len(rate) - 1)]
    return np.column_stack([rate, np.sign(rate) * np.sqrt(np.abs(rate))])


def relaxing(history: History, delays: Floats) -> Floats:
    """Torque followed late, with any sign.

    Parameters
    ----------
    history : History
    delays : ndarray, shape (k,)
        Time constants [s].

    Returns
    -------
    ndarray, shape (n, k)
        In N m.
    """
    assert history.time_s is not None
    return np.column_stack(
        [
            _core.creep_state(history.applied_nm, history.time_s, history.restart, float(delay))
            for delay in delays
        ]
    )
