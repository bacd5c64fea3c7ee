"""Pieces of a recording along which its load history does not bend, cut into blocks of samples."""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Self

import numpy as np

from cyclosweep.diagnosis.prepare.rows import Rows
from cyclosweep.recording import Recording
from cyclosweep.recording.robust import sigma_by_second_differences
from cyclosweep.recording.structure import turning_points
from cyclosweep.simulation.effects.history import Flags, Floats, Ints

LEAST_FULL = 0.6
"""Share of the usual number of samples that a row has to have to be fitted."""
LEAST_TURN = 1e-3
"""Share of the torque's range by which the torque has to turn back for a reversal."""
TURN_NOISE = 8.0
"""Standard deviations of the torque's noise by which it has to turn back for a reversal."""
BREAK = 20.0
"""Usual steps of the clock beyond which it has a break."""


@dataclass(frozen=True, eq=False)
class Pieces:
    """Stretches of a recording along which its load history does not bend.

    Attributes
    ----------
    start, stop : ndarray of int, shape (pieces,)
        First sample of each, and the one after its last.
    dwell : ndarray of bool, shape (pieces,)
        The torque stands still.
    """

    start: Ints
    stop: Ints
    dwell: Flags

    @cached_property
    def of_sample(self) -> Ints:
        """Number of the piece of each sample, shape (samples,)."""
        return np.repeat(np.arange(len(self.start)), self.stop - self.start)

    def cut(self, samples: Ints) -> Self:
        """The same with a piece beginning at each of these samples as well."""
        start = np.union1d(self.start, samples)
        return replace(
            self,
            start=start,
            stop=np.r_[start[1:], self.stop[-1]],
            dwell=self.dwell[self.of_sample[start]],
        )

    def blocks(self, size: int) -> Rows:
        """Cut each piece into blocks of nearly equal length.

        The first and the last sample stay apart, except in a dwell, which has no extremes.

        Parameters
        ----------
        size : int
            Usual number of samples in a block.

        Returns
        -------
        Rows
        """
        if size == 1:
            count = int(self.stop[-1])
            return Rows(np.arange(count), np.ones(count, dtype=bool))
        piece = self.of_sample
        length = self.stop - self.start
        place = np.arange(len(piece)) - self.start[piece]
        ends = np.where(self.dwell, 0, 1)[piece]
        inner = length[piece] - 2 * ends
        number = np.maximum(np.rint(inner / size), 1.0).astype(np.int64)
        block = ends + (place - ends) * number // np.maximum(inner, 1)
        last = (place == length[piece] - 1) & (place > 0) & (ends > 0)
        block[(place == 0) & (ends > 0)] = 0
        block[last] = number[last] + 1
        new = np.r_[True, (np.diff(block) != 0) | (np.diff(piece) != 0)]
        row = np.cumsum(new) - 1
        samples = np.bincount(row)
        return Rows(row, samples >= LEAST_FULL * size, size)


def find_pieces(recording: Recording, *, at_zero: bool = True) -> Pieces:
    """Cut a recording wherever its load history bends.

    Parameters
    ----------
    recording : Recording
    at_zero : bool
        Whether it bends, too, where the torque changes its sign and the shaft crosses the play.

    Returns
    -------
    Pieces
        Every sample belongs to one; the last sample of a piece is the extreme of the torque where
        it ends by a reversal.
    """
    count = len(recording)
    torque = recording.torque_nm
    cut = np.zeros(count, dtype=bool)
    cut[0] = True
    cut[1:] |= np.diff(recording.run) != 0
    if at_zero:
        cut[1:] |= np.diff(np.sign(torque)) != 0
    cut[1:] |= np.diff(recording.counts)
    starts = np.flatnonzero(np.r_[True, np.diff(recording.run) != 0, True])
    for start, stop in pairwise(starts):
        part = torque[start:stop]
        after = turning_points(part, _least_turn(part)) + 1
        # Where the torque stands still at its extreme, the dwell is cut out below.
        cut[start + after[part[after] != part[after - 1]]] = True
    for hold in recording.structure.holds:
        cut[hold.start] = True
        if hold.stop < count:
            cut[hold.stop] = True
    if recording.time_s is not None:
        step = np.diff(recording.time_s)
        usual = step[step > 0]
        if len(usual):
            cut[1:] |= step > BREAK * np.median(usual)
    if recording.crank_deg is not None:
        moved = np.diff(recording.crank_deg) != 0
        if moved.mean() < 1.0 / BREAK:
            cut[1:] |= moved
    edges = np.flatnonzero(cut)
    moves = np.r_[False, np.diff(torque) != 0] & ~cut
    dwell = np.bincount(np.cumsum(cut) - 1, moves) == 0
    return Pieces(edges, np.r_[edges[1:], count], dwell)


def _least_turn(torque: Floats) -> float:
    """Way back of the torque within a run that its noise cannot make [N m]."""
    if len(torque) < 3:
        return 0.0
    noise = sigma_by_second_differences(torque)
    return float(max(LEAST_TURN * float(np.ptp(torque)), TURN_NOISE * noise))
