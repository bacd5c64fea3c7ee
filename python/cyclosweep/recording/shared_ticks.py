"""Rows that share a tick of a clock which is coarser than the readings."""

import numpy as np

from cyclosweep.recording.columns import Columns
from cyclosweep.recording.robust import sigma_by_second_differences
from cyclosweep.recording.samples import Flags, Floats

__all__ = ["TICKS", "moved_in_a_tick", "spread_ticks"]

TICKS = 0.3
"""Share of rows on the tick of the row before from which it is the clock that is coarse."""

MOVES = 3.0
"""Move of the torque within a tick, over its noise, beyond which rows of the tick differ."""

MOVED = 0.005
"""The same over the range of the torque: means of less lose nothing of its peaks."""


def moved_in_a_tick(torque: Floats, shared: Flags) -> float | None:
    """How far the torque moves while the clock shows one time, if it does beyond its noise.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque in the file's unit.
    shared : ndarray of bool, shape (n - 1,)
        Whether a row but the first has the time of the row before.

    Returns
    -------
    float or None
        Usual move from the first row of a tick to the last, in the file's unit.
    """
    known = torque[np.isfinite(torque)]
    starts = np.flatnonzero(np.r_[True, ~shared])
    stops = np.r_[starts[1:], len(torque)] - 1
    several = stops > starts
    moves = np.abs(torque[stops[several]] - torque[starts[several]])
    moves = moves[np.isfinite(moves)]
    if len(known) < 3 or not len(moves):
        return None
    noise = sigma_by_second_differences(known)
    moved = float(np.median(moves))
    return moved if moved > max(MOVES * noise, MOVED * float(np.ptp(known))) else None


def spread_ticks(columns: Columns, notes: list[str]) -> Columns:
    """Spread rows that share a tick evenly up to the next, where the torque moves within ticks.

    A rate is not known otherwise: it would be nothing within a tick, and too large from one to the
    next.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (n,), or None
        Canonical columns.
    notes : list of str
        What was done to the clock is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (n,), or None
        The same columns where the clock is not so coarse.
    """
    time, run, torque = columns["time_s"], columns["run"], columns["torque_nm"]
    if time is None or run is None or torque is None or len(time) < 3:
        return columns
    within = np.diff(run) == 0
    shared = within & (np.diff(time) == 0)
    if not TICKS < float(np.mean(shared)) < 1.0 or moved_in_a_tick(torque, shared) is None:
        return columns
    starts = np.flatnonzero(np.r_[True, ~shared])
    count = np.diff(np.r_[starts, len(time)])
    ahead = np.diff(time[starts])
    goes_on = within[starts[1:] - 1] & (ahead > 0)
    if not goes_on.any():
        return columns
    tick = float(np.median(ahead[goes_on]))
    # A longer time to the next tick is a pause, and what follows the last one is not known.
    length = np.r_[np.where(ahead > 0, np.minimum(ahead, tick), tick), tick]
    place = np.arange(len(time)) - np.repeat(starts, count)
    notes.append(
        f"The clock is rounded to {tick:g} s while the torque moves: rows that share a time are "
        "spread evenly up to the next."
    )
    return {**columns, "time_s": time + place * np.repeat(length / count, count)}
