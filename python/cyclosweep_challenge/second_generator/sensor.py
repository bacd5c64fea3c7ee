"""Sensors: noise that is correlated or heavy-tailed, a dial's division, a drift, a noisy torque."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Sensor:
    """How an angle is read.

    Attributes
    ----------
    sigma_deg : float
        Standard deviation of the noise of one reading [deg].
    autocorrelation : float
        Correlation of one reading's noise with the next within a run [-].
    tails : float
        Degrees of freedom of Student's t for the innovations; zero for normal ones.
    resolution_deg : float
        Division of the dial [deg]; zero for a continuous reading.
    drift_deg : float
        Drift of the sensor from the first to the last reading [deg].
    torque_noise_deg : float
        Standard deviation of the noise of the torque reading, white, as the elastic twist under
        such a torque [deg].
    """

    sigma_deg: float
    autocorrelation: float = 0.0
    tails: float = 0.0
    resolution_deg: float = 0.0
    drift_deg: float = 0.0
    torque_noise_deg: float = 0.0

    @property
    def spread_deg(self) -> float:
        """Standard deviation of noise, rounding and noise of the torque together [deg]."""
        parts = (self.sigma_deg, self.resolution_deg / np.sqrt(12.0), self.torque_noise_deg)
        return float(np.linalg.norm(parts))

    def scaled(self, factor: float) -> Sensor:
        """The same sensor with all its angles scaled."""
        return replace(
            self,
            sigma_deg=self.sigma_deg * factor,
            resolution_deg=self.resolution_deg * factor,
            drift_deg=self.drift_deg * factor,
            torque_noise_deg=self.torque_noise_deg * factor,
        )

    def errors(self, starts: NDArray[np.bool_], rng: np.random.Generator) -> Array:
        """Draw noise and drift for rows of which some begin a run, shape (N,) [deg]."""
        count, rho = len(starts), self.autocorrelation
        drawn = rng.standard_normal(count)
        if self.tails > 2.0:
            drawn = rng.standard_t(self.tails, count) * np.sqrt((self.tails - 2.0) / self.tails)
        noise = np.empty(count)
        begins = np.flatnonzero(starts).tolist()
        for begin, end in zip(begins, [*begins[1:], count], strict=True):
            part = drawn[begin:end] * np.sqrt(1.0 - rho * rho)
            part[0] = drawn[begin]
            noise[begin:end] = signal.lfilter([1.0], [1.0, -rho], part)
        drift = self.drift_deg * (np.linspace(0.0, 1.0, count) - 0.5)
        return self.sigma_deg * noise + drift

    def torque_errors(self, count: int, rng: np.random.Generator) -> Array:
        """Draw errors of the torque reading, as elastic twist, shape (count,) [deg]."""
        return np.asarray(self.torque_noise_deg * rng.standard_normal(count))

    def read(self, angle_deg: Array) -> Array:
        """Round to the divisions of the dial [deg]."""
        if self.resolution_deg <= 0.0:
            return angle_deg
        return np.asarray(np.round(angle_deg / self.resolution_deg) * self.resolution_deg)

    def whitened(self, columns: Array, starts: NDArray[np.bool_]) -> Array:
        """Columns in units of independent noise of unit variance, shape (N, K).

        Rounding and noise of the torque are added to the noise as variance; heavy tails count by
        their variance.
        """
        rho = self.autocorrelation
        before = np.vstack([np.zeros((1, columns.shape[1])), columns[:-1]])
        whole = (columns - rho * before) / np.sqrt(1.0 - rho * rho)
        whole[starts] = columns[starts]
        return np.asarray(whole / self.spread_deg, dtype=float)
