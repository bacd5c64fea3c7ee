"""Groups of neighbouring samples of a recording, each of which is one row of a fit."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.recording.robust import robust_sigma
from cyclosweep.simulation.effects.history import Flags, Floats, Ints
from cyclosweep.simulation.effects.mesh_range import short_way_deg


@dataclass(frozen=True, eq=False)
class Rows:
    """Groups of neighbouring samples, each of which becomes one row.

    Attributes
    ----------
    row : ndarray of int, shape (samples,)
        Row of each sample; -1 for a sample that is passed over.
    full : ndarray of bool, shape (n,)
        Rows of about the usual number of samples. The others carry the state only.
    averaged : int
        Usual number of samples averaged in a row.
    every : int
        One of this many of such rows is taken; 1: all of them.
    on_one_flank : ndarray of bool, shape (n,), or None
        Rows whose samples are all in contact with the same flank; None where nothing is averaged.
    """

    row: Ints
    full: Flags
    averaged: int = 1
    every: int = 1
    on_one_flank: Flags | None = None

    def __len__(self) -> int:
        return len(self.full)

    @property
    def thinned(self) -> bool:
        """Whether there are fewer rows than samples."""
        return len(self) < len(self.row)

    @cached_property
    def samples(self) -> Floats:
        """Number of samples averaged in each row."""
        return np.bincount(self.row[self._used], minlength=len(self)).astype(np.float64)

    @cached_property
    def first(self) -> Ints:
        """First sample of each row."""
        used = np.flatnonzero(self._used)
        return used[np.r_[True, np.diff(self.row[used]) != 0]]

    @cached_property
    def _used(self) -> Flags:
        """Samples that are in a row."""
        return self.row >= 0

    def mean(self, values: Floats) -> Floats:
        """Mean of a column of samples over each row."""
        used = self._used
        return np.bincount(self.row[used], values[used], len(self)) / self.samples

    def mean_angle(self, degrees: Floats) -> Floats:
        """Mean of a position [deg] that starts anew at 360 deg over each row [deg]."""
        first = degrees[self.first]
        if self.averaged == 1:
            return first
        ahead = degrees - np.where(self._used, first[self.row], degrees)
        return np.asarray(first + self.mean(short_way_deg(ahead)))

    def whole_on_one_flank(self, side: Floats) -> Flags:
        """Rows whose samples are all in contact with the same flank.

        Parameters
        ----------
        side : ndarray, shape (samples,)
            +1 or -1, flank of each sample; zero where none is in contact.

        Returns
        -------
        ndarray of bool, shape (n,)
        """
        return np.asarray(np.abs(self.mean(side)) == 1.0)

    def scatter(self, difference: Floats, fitted: Flags) -> tuple[float, float]:
        """Size and autocorrelation of what a model leaves of the samples in fitted rows.

        Parameters
        ----------
        difference : ndarray, shape (samples,)
            Measured less modelled twist [deg].
        fitted : ndarray of bool, shape (n,)
            Rows that were fitted.

        Returns
        -------
        sigma, correlation : float
            Robust standard deviation [deg] and correlation from sample to sample [-].
        """
        within = self._used & np.append(fitted, False)[self.row]
        count = int(within.sum())
        if count < 2:
            return float("nan"), float("nan")
        sigma = robust_sigma(difference[within])
        clean = np.clip(difference, -4.0 * sigma, 4.0 * sigma)
        pair = within[1:] & within[:-1]
        if self.averaged == 1 or np.count_nonzero(pair) < 2 or sigma <= 0.0:
            return sigma, float("nan")
        return sigma, float(np.corrcoef(clean[1:][pair], clean[:-1][pair])[0, 1])

    def at_samples(self, values: Floats) -> Floats:
        """Values of rows, interpolated to every sample along the order of the recording."""
        if not self.thinned:
            return values
        place = np.arange(len(self.row), dtype=np.float64)
        return np.interp(place, self.mean(place), values)
