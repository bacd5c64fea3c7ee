"""Long recordings shortened by averaging neighbours, with the largest error that it makes."""

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording.columns import Columns
from cyclosweep.recording.samples import Floats
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
    cut = _cuts(torque, run, columns.get("unscored"))
    pieces = np.flatnonzero(cut)
    lengths = np.diff(np.r_[pieces, len(torque)])
    groups = [a + np.arange(0, size, count) for a, size in zip(pieces, lengths, strict=True)]
    starts = np.concatenate(groups).astype(np.int64)
    sizes = np.diff(np.r_[starts, len(torque)])
    merged = {
        name: None if values is None else np.add.reduceat(values, starts) / sizes
        for name, values in columns.items()
    }
    notes.append(f"Up to {count} neighbours averaged: {len(torque)} samples became {len(starts)}.")
    angle, means = columns["angle_deg"], merged["angle_deg"]
    if angle is not None and means is not None:
        piece = np.cumsum(cut)
        at = np.arange(len(angle), dtype=np.float64)
        centres = starts + 0.5 * (sizes - 1)
        off = angle - np.interp(at, centres, means)
        # Between two stretches, as through the play, there is no line to be off.
        after = np.clip(np.searchsorted(centres, at), 1, max(len(starts) - 1, 1))
        if len(starts) > 1:
            inner = piece[starts[after]] == piece[starts[after - 1]]
            inner &= (at >= centres[0]) & (at <= centres[-1])
            off = off[inner]
        if len(off):
            notes.append(
                f"Bound of the averaging: no sample of the angle lies farther than "
                f"{np.abs(off).max():.3g} deg (rms {np.sqrt(np.mean(off**2)):.2g} deg, noise "
                "included) off the line through neighbouring means."
            )
    return merged


def _cuts(torque: Floats, run: Floats, unscored: Floats | None) -> NDArray[np.bool_]:
    """Mark the samples at which a new stretch begins, over which nothing is averaged.

    Parameters
    ----------
    torque : ndarray of float, shape (n,)
        Torque [N m].
    run : ndarray of float, shape (n,)
        Trial each sample belongs to.
    unscored : ndarray of float, shape (n,), or None
        1 where a sample is not scored.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    n = len(torque)
    cut = np.zeros(n, dtype=bool)
    cut[0] = True
    cut[1:] |= np.diff(run) != 0
    cut[1:] |= np.diff(np.sign(torque)) != 0
    if unscored is not None:
        cut[1:] |= np.diff(unscored) != 0
    turns = turning_points(torque, REVERSAL_SHARE * float(np.ptp(torque)))
    cut[turns] = True  # the extreme stands at the head of the next stretch,
    cut[np.minimum(turns + 1, n - 1)] = True  # alone, so that the torque keeps it
    return cut
