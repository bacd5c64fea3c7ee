"""Long recordings shortened by averaging neighbours, with the largest error that it makes."""

import numpy as np

from cyclosweep.recording.columns import Columns
from cyclosweep.recording.samples import Floats, Ints
from cyclosweep.recording.structure import REVERSAL_SHARE, turning_points

__all__ = ["merge_neighbours"]


def merge_neighbours(columns: Columns, count: int, notes: list[str]) -> Columns:
    """Average so many neighbouring samples, never over a reversal or from run to run.

    Parameters
    ----------
    columns : dict of str to ndarray of float, shape (n,), or None
        Canonical columns without missing values.
    count : int
        Most samples of one mean.
    notes : list of str
        What was done, and by how much the samples of the angle lie off the line through
        neighbouring means, is added to it.

    Returns
    -------
    dict of str to ndarray of float, shape (m,), or None
    """
    torque, run = columns["torque_nm"], columns["run"]
    if torque is None or run is None or not len(torque):
        return columns
    starts = _starts(torque, run, columns.get("unscored"), count)
    sizes = np.diff(np.r_[starts, len(torque)])
    merged = {
        name: None if values is None else np.add.reduceat(values, starts) / sizes
        for name, values in columns.items()
    }
    notes.append(f"Up to {count} neighbours averaged: {len(torque)} samples became {len(starts)}.")
    angle, means = columns["angle_deg"], merged["angle_deg"]
    if angle is not None and means is not None:
        places = starts + 0.5 * (sizes - 1)
        off = angle - np.interp(np.arange(len(angle)), places, means)
        # Between runs and at their ends there is no line to be off.
        inner = (np.arange(len(angle)) >= places[0]) & (np.arange(len(angle)) <= places[-1])
        inner &= np.interp(np.arange(len(angle)), places, run[starts]) == run
        if inner.any():
            largest, rms = np.abs(off[inner]).max(), np.sqrt(np.mean(off[inner] ** 2))
            notes.append(
                f"Bound of the averaging: no sample of the angle lies farther than {largest:.3g} "
                f"deg (rms {rms:.2g} deg, noise included) off the line through neighbouring means."
            )
    return merged


def _starts(torque: Floats, run: Floats, unscored: Floats | None, count: int) -> Ints:
    """First samples of the groups that are averaged.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray of float, shape (n,)
        Trial each sample belongs to.
    unscored : ndarray of float, shape (n,), or None
        1 where a sample is not scored.
    count : int
        Most samples of a group.

    Returns
    -------
    ndarray of int, shape (m,)
    """
    n = len(torque)
    cut = np.zeros(n, dtype=bool)
    cut[0] = True
    cut[1:] |= np.diff(run) != 0
    cut[1:] |= np.sign(torque[1:]) * np.sign(torque[:-1]) < 0
    if unscored is not None:
        cut[1:] |= np.diff(unscored) != 0
    turns = turning_points(torque, REVERSAL_SHARE * float(np.ptp(torque)))
    cut[turns] = True  # the extreme stands at the head of the next group,
    cut[np.minimum(turns + 1, n - 1)] = True  # alone, so that the torque keeps it
    starts = np.flatnonzero(cut)
    lengths = np.diff(np.r_[starts, n])
    inner = [a + np.arange(0, length, count) for a, length in zip(starts, lengths, strict=True)]
    return np.concatenate(inner).astype(np.int64)
