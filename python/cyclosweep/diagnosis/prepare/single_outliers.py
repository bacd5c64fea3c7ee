"""Single readings that no neighbour bears out: knocks, dropouts and signs that are read wrongly.

One reading that is far off tells nothing of the drive, but outweighs all others where errors are
squared. It is left out of the diagnosis, and the answer says which one. What comes back over
several samples, or often, is not touched: it may be physics.
"""

from dataclasses import replace

import numpy as np

from cyclosweep.design.nominal_line import NominalLine
from cyclosweep.recording import Fault, Recording
from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Flags, Floats

BEYOND_USUAL = 12.0
"""Size of a spike over the usual change from sample to sample, as a robust standard deviation."""
BEYOND_NEARBY = 4.0
"""Size of a spike over the largest change nearby, but for one from the side away from it."""
BACK_AGAIN = 0.25
"""Change across a spike over its size, up to which the signal has come back."""
NEARBY = 3
"""Changes on either side that a spike is compared with."""
FEWEST = 2
"""The same at least, at the end of a run."""
NEAR_ZERO = 0.1
"""Torque over the largest one, up to which a sample of the other sign may be on the other flank."""
STEADY = 4.0
"""How far the other signal may be from the middle of its neighbours, over its usual change."""
STEPS = 4.0
"""Steps of the reading that a spike exceeds."""
MOST_SHARE = 0.01
"""Share of the samples up to which they are single outliers, and not noise of heavy tails."""
LISTED = 3
"""Outliers that are listed one by one."""


def without_single_outliers(recording: Recording, line: NominalLine) -> Recording:
    """Leave out single samples whose angle, or torque, is far from both neighbours'.

    Parameters
    ----------
    recording : Recording
        With an angle.
    line : NominalLine
        Compliance of the drive at the recorded shaft [deg/(N m)].

    Returns
    -------
    Recording
        The same recording where there are none; otherwise with a remark that names them.
    """
    most = max(MOST_SHARE * len(recording), 1.0)
    left, kept, words = recording, np.arange(len(recording)), dict[int, str]()
    while True:
        of_angle, of_torque = _outliers(left, line)
        found = of_angle | of_torque
        if not np.any(found):
            break
        if len(words) + np.count_nonzero(found) > most:
            return recording
        # One hides another close by; with it left out, the other stands out by itself.
        for row in np.flatnonzero(found):
            words[int(kept[row])] = _words(
                left, int(row), int(kept[row]), in_torque=bool(of_torque[row])
            )
        kept = kept[~found]
        left = recording.take(kept)
    if not words:
        return recording
    parts = [words[row] for row in sorted(words)[:LISTED]]
    more = f" and {len(words) - LISTED} more" if len(words) > LISTED else ""
    reason = f"left out as single outliers: {'; '.join(parts)}{more}"
    return replace(left, faults=(*left.faults, Fault("single_outliers", None, reason)))


def _outliers(recording: Recording, line: NominalLine) -> tuple[Flags, Flags]:
    """Samples whose angle, or torque, is far from both neighbours'.

    Parameters
    ----------
    recording : Recording
        With an angle.
    line : NominalLine
        Compliance of the drive at the recorded shaft [deg/(N m)].

    Returns
    -------
    of_angle, of_torque : ndarray of bool, shape (n,)
        No sample is both.
    """
    assert recording.angle_deg is not None
    torque, angle = recording.torque_nm, recording.angle_deg
    twist = angle - line.compliance_deg_per_nm * torque
    least = STEPS * recording.angle_resolution_deg
    of_angle = _spikes(twist, recording.run, least) & _is_steady(torque, recording.run)
    of_torque = _spikes(torque, recording.run, 0.0) & _is_steady(angle, recording.run)
    within = ~_may_cross_play(torque)
    return of_angle & within, of_torque & ~of_angle & within


def _words(recording: Recording, row: int, sample: int, *, in_torque: bool) -> str:
    """What a single outlier reads, and where.

    Parameters
    ----------
    recording : Recording
        Without the outliers that were found before.
    row : int
        Its row there, counted from zero.
    sample : int
        Its sample in the whole recording, counted from zero.
    in_torque : bool
        Whether it is the torque that is off, and not the angle.

    Returns
    -------
    str
    """
    values, unit, name = recording.angle_deg, "deg", "angle"
    if in_torque:
        values, unit, name = recording.torque_nm, "N m", "torque"
    assert values is not None
    middle = 0.5 * (values[row - 1] + values[row + 1])
    when = "" if recording.time_s is None else f" ({recording.time_s[row]:.6g} s)"
    return (
        f"sample {sample + 1}{when}, {name} {values[row]:.4g} {unit} between readings of about "
        f"{middle:.4g} {unit}"
    )


def _changes(signal: Floats, run: np.ndarray) -> Floats:
    """Change from each sample to the next.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        The signal.
    run : ndarray of int, shape (n,)
        Run of each sample.

    Returns
    -------
    ndarray, shape (n - 1,)
        NaN across runs.
    """
    return np.where(np.diff(run) == 0, np.diff(signal), np.nan)


def _usual(changes: Floats) -> float:
    """Usual change, by the median of those that are known and not zero."""
    known = np.abs(changes[np.isfinite(changes)])
    known = known[known > 0]
    return robust_sigma(known) if len(known) else 0.0


def _spikes(signal: Floats, run: np.ndarray, least: float) -> Flags:
    """Samples that leave both neighbours by far more than anything nearby, a crossing apart.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        The signal.
    run : ndarray of int, shape (n,)
        Run of each sample.
    least : float
        Smallest size of a spike.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    found = np.zeros(len(signal), dtype=bool)
    if len(signal) < 2 * FEWEST + 3:
        return found
    change = _changes(signal, run)
    up, down = change[:-1], -change[1:]
    size = np.minimum(np.abs(up), np.abs(down))
    clear = (up * down > 0) & (size > max(BEYOND_USUAL * _usual(change), least))
    clear &= np.abs(up - down) <= BACK_AGAIN * size
    for place in np.flatnonzero(clear):
        before = _of_one_run(change[max(place - NEARBY, 0) : place][::-1])
        after = _of_one_run(change[place + 2 : place + 2 + NEARBY])
        if min(len(before), len(after)) < FEWEST:
            continue
        # A single jump from the side away from the spike is a play that is crossed nearby: beyond
        # a flank the shaft cannot be.
        towards = np.sign(up[place]) * np.r_[before, -after]
        largest = max(-towards.min(), np.sort(np.abs(towards))[-2])
        found[place + 1] = size[place] > BEYOND_NEARBY * largest
    return found


def _of_one_run(changes: Floats) -> Floats:
    """Changes up to the first one that leads into another run."""
    breaks = np.flatnonzero(np.isnan(changes))
    return changes[: breaks[0]] if len(breaks) else changes


def _may_cross_play(torque: Floats) -> Flags:
    """Samples at which the shaft may be on the other flank: near zero, the torque turns about.

    Parameters
    ----------
    torque : ndarray, shape (n,)
        Torque [N m].

    Returns
    -------
    ndarray of bool, shape (n,)
        Where the sample and both neighbours are small, and not all of one sign.
    """
    small = np.abs(torque) <= NEAR_ZERO * float(np.abs(torque).max(initial=0.0))
    sign = np.sign(torque)
    crosses = np.zeros(len(torque), dtype=bool)
    near = small[:-2] & small[1:-1] & small[2:]
    one_sign = (sign[:-2] == sign[1:-1]) & (sign[1:-1] == sign[2:]) & (sign[1:-1] != 0)
    crosses[1:-1] = near & ~one_sign
    return crosses


def _is_steady(signal: Floats, run: np.ndarray) -> Flags:
    """Samples that lie as usual between their neighbours.

    Parameters
    ----------
    signal : ndarray, shape (n,)
        The signal.
    run : ndarray of int, shape (n,)
        Run of each sample.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    steady = np.zeros(len(signal), dtype=bool)
    off = np.abs(signal[1:-1] - 0.5 * (signal[:-2] + signal[2:]))
    steady[1:-1] = off <= STEADY * _usual(_changes(signal, run))
    return steady
