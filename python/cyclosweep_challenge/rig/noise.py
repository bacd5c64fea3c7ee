"""Sensor noise: ten families, each with its true whitening, score and information."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]

NOISES = (
    "white",
    "ar0.3",
    "ar0.6",
    "ar0.9",
    "heavy",
    "outliers",
    "resolution",
    "jitter",
    "gaps",
    "start",
)
"""Families of nuisance. ``start`` is white noise on a drive far from nominal."""
STRONGER = ("ar0.95", "ar0.97", "ar0.99")
"""Noise so correlated that error of the model looks like it; in no mix of the first records."""


@dataclass(frozen=True)
class Noise:
    """Law of the sensor's errors.

    Attributes
    ----------
    family : str
        One of ``NOISES`` or ``STRONGER``.
    sigma_deg : float
        Standard deviation of one reading, outliers apart [deg].
    rho : float
        Correlation of neighbouring readings of a run [-].
    freedom : float
        Degrees of freedom of Student's law; infinite for a normal one [-].
    outlier_share, outlier_size : float
        Share of the readings that are outliers, and their spread over sigma [-].
    resolution_deg : float
        Division of the dial [deg]; zero for none.
    clock_jitter_s : float
        Spread of the time between the torque's and the angle's reading [s].
    gap_share : float
        Share of the readings lost in a few gaps [-].
    """

    family: str = "white"
    sigma_deg: float = 0.2
    rho: float = 0.0
    freedom: float = np.inf
    outlier_share: float = 0.0
    outlier_size: float = 0.0
    resolution_deg: float = 0.0
    clock_jitter_s: float = 0.0
    gap_share: float = 0.0

    @classmethod
    def draw(
        cls,
        family: str,
        rng: np.random.Generator,
        sigma_deg: float = 0.2,
        resolution_deg: float = 0.0,
    ) -> Noise:
        """Draw the parameters of a family.

        Raises
        ------
        ValueError
            If the family is none of ``NOISES`` and ``STRONGER``.
        """
        if family not in (*NOISES, *STRONGER):
            known = ", ".join((*NOISES, *STRONGER))
            raise ValueError(f"noise: found {family!r}, expected one of {known}")
        plain = cls(family=family, sigma_deg=sigma_deg, resolution_deg=resolution_deg)
        if family.startswith("ar"):
            return replace(plain, rho=float(family[2:]))
        if family == "heavy":
            return replace(plain, freedom=float(rng.choice([3.0, 4.0, 6.0])))
        if family == "outliers":
            return replace(
                plain,
                outlier_share=float(rng.uniform(0.003, 0.02)),
                outlier_size=float(rng.uniform(6.0, 20.0)),
            )
        if family == "resolution":
            return replace(
                plain,
                sigma_deg=0.5 / float(rng.choice([1.0, 2.0, 3.5, 5.0, 10.0, 30.0])),
                resolution_deg=0.5,
            )
        if family == "jitter":
            return replace(plain, clock_jitter_s=float(rng.uniform(0.01, 0.04)))
        if family == "gaps":
            return replace(plain, gap_share=float(rng.uniform(0.15, 0.4)))
        return plain

    def errors(
        self, programme: Programme, compliance_deg_per_nm: float, rng: np.random.Generator
    ) -> Array:
        """Draw the errors of all readings before the dial's division [deg], shape (N,)."""
        count = len(programme)
        if np.isfinite(self.freedom):
            unit = rng.standard_t(self.freedom, count)
            unit *= np.sqrt((self.freedom - 2.0) / self.freedom)
        else:
            unit = rng.normal(0.0, 1.0, count)
        if self.outlier_share > 0.0:
            hit = rng.random(count) < self.outlier_share
            unit = np.where(hit, self.outlier_size * rng.normal(0.0, 1.0, count), unit)
        if self.rho != 0.0:
            start = programme.run_starts
            fresh = np.sqrt(1.0 - self.rho**2) * unit
            for k in range(count):
                unit[k] = unit[k] if start[k] else self.rho * unit[k - 1] + fresh[k]
        error = self.sigma_deg * unit
        if self.clock_jitter_s > 0.0:
            error = error + self._jitter(programme, compliance_deg_per_nm) * rng.normal(
                0.0, 1.0, count
            )
        return error

    def lost(self, count: int, rng: np.random.Generator) -> NDArray[np.bool_]:
        """Mark the readings lost in gaps, shape (count,)."""
        lost = np.zeros(count, dtype=bool)
        if self.gap_share > 0.0:
            pieces = rng.dirichlet(np.full(5, 2.0)) * self.gap_share * count
            for piece, at in zip(pieces, rng.uniform(0.0, 1.0, 5), strict=True):
                first = int(at * (count - piece))
                lost[first : first + int(piece)] = True
        return lost

    def _jitter(self, programme: Programme, compliance_deg_per_nm: float) -> Array:
        """Spread of the angle error that comes from the clock [deg]."""
        return np.abs(programme.rate_nm_per_s()) * compliance_deg_per_nm * self.clock_jitter_s

    def spread(self, programme: Programme, compliance_deg_per_nm: float) -> Array:
        """Return the standard deviation of each reading, outliers apart [deg]."""
        if self.clock_jitter_s == 0.0:
            return np.full(len(programme), self.sigma_deg)
        return np.hypot(self.sigma_deg, self._jitter(programme, compliance_deg_per_nm))

    def whiten(self, columns: Array, programme: Programme, compliance_deg_per_nm: float) -> Array:
        """Columns as readings of unit, independent noise, shape (N, K)."""
        table = np.asarray(columns, dtype=float)
        flat = table.ndim == 1
        if flat:
            table = table[:, None]
        scaled = table / self.spread(programme, compliance_deg_per_nm)[:, None]
        if self.rho != 0.0:
            start = programme.run_starts
            previous = np.vstack([np.zeros((1, scaled.shape[1])), scaled[:-1]])
            step = (scaled - self.rho * previous) / np.sqrt(1.0 - self.rho**2)
            scaled = np.where(start[:, None], scaled, step)
        return scaled[:, 0] if flat else scaled

    @lru_cache(maxsize=512)  # noqa: B019 - a few numbers a noise, not the programme
    def information(self) -> float:
        """Fisher information of a whitened reading's location over that of a normal one [-]."""
        if np.isfinite(self.freedom):
            nu = self.freedom
            return float((nu + 1.0) / (nu + 3.0) * nu / (nu - 2.0))
        if self.outlier_share > 0.0:
            grid = np.linspace(-12.0 * self.outlier_size, 12.0 * self.outlier_size, 200_001)
            density, slope = self._contaminated(grid)
            return float(np.trapezoid(slope**2 / np.maximum(density, 1e-300), grid))
        ratio = self.resolution_deg / self.sigma_deg
        if ratio > 1e-6:
            return _divided_information(ratio)
        return 1.0

    def score(self, clean_deg: Array, read_deg: Array, programme: Programme, slope: float) -> Array:
        """Whitened score of each reading at the true model [-], shape (N,).

        Its mean under a small added angle is that angle, whitened, times the information.
        """
        if self.resolution_deg > 0.0 and self.rho == 0.0:
            spread = self.spread(programme, slope)
            low = (read_deg - 0.5 * self.resolution_deg - clean_deg) / spread
            high = (read_deg + 0.5 * self.resolution_deg - clean_deg) / spread
            mass = np.maximum(_mass(low, high), 1e-12)
            return np.asarray((stats.norm.pdf(low) - stats.norm.pdf(high)) / mass)
        residual = self.whiten(read_deg - clean_deg, programme, slope)
        if np.isfinite(self.freedom):
            nu = self.freedom
            scale = np.sqrt((nu - 2.0) / nu)
            t = residual / scale
            return np.asarray((nu + 1.0) * t / (nu + t**2) / scale)
        if self.outlier_share > 0.0:
            density, rise = self._contaminated(residual)
            return np.asarray(-rise / np.maximum(density, 1e-300))
        return residual

    def _contaminated(self, at: Array) -> tuple[Array, Array]:
        """Density of a reading with outliers, and its slope."""
        wide = self.outlier_size
        good = (1.0 - self.outlier_share) * stats.norm.pdf(at)
        bad = self.outlier_share * stats.norm.pdf(at, scale=wide)
        return good + bad, -at * good - at / wide**2 * bad


def _mass(low: Array, high: Array) -> Array:
    """Probability of a standard normal between two bounds, without cancellation in the tails."""
    flip = low > 0.0
    a = np.where(flip, -high, low)
    b = np.where(flip, -low, high)
    return stats.norm.cdf(b) - stats.norm.cdf(a)


def _divided_information(ratio: float) -> float:
    """Information left by a dial's division, averaged over the place within it [-]."""
    places: Array = np.linspace(0.5 / 400.0, 399.5 / 400.0, 400) * ratio
    reach = int(np.ceil(9.0 / ratio)) + 1
    total = np.zeros_like(places)
    for step in range(-reach, reach + 1):
        low = step * ratio - places
        high = low + ratio
        mass = _mass(low, high)
        gain = (stats.norm.pdf(low) - stats.norm.pdf(high)) ** 2
        total += np.where(mass > 1e-15, gain / np.maximum(mass, 1e-15), 0.0)
    return float(total.mean())
