"""Where residuals are too large for noise: binned means with simultaneous bands."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

CONFIDENCE = 0.99
"""Share of panels that noise alone keeps wholly inside its band."""

_LEAST_PER_BIN = 8


@dataclass(frozen=True, eq=False, slots=True)
class Profile:
    """Mean residual in bins of one quantity.

    Attributes
    ----------
    x : ndarray of float, shape (k,)
        Mean of the quantity in each bin.
    mean_deg : ndarray of float, shape (k,)
        Mean residual [deg].
    band_deg : ndarray of float, shape (k,)
        Half-width of the simultaneous band around zero [deg].
    """

    x: Floats
    mean_deg: Floats
    band_deg: Floats

    @property
    def outside(self) -> Mask:
        """Bins whose mean noise does not explain."""
        return np.abs(self.mean_deg) > self.band_deg


def band(counts: NDArray[np.int64], sigma_deg: float, rho: float, cells: int) -> Floats:
    """Half-width within which the means of `cells` bins stay together with 99 % probability.

    White or first-order correlated Gaussian noise; neighbouring samples of a bin are taken as
    neighbours in time, which is the worst case.

    Parameters
    ----------
    counts : ndarray of int, shape (k,)
        Samples in each bin.
    sigma_deg, rho : float
        Standard deviation [deg] and lag-one autocorrelation of the noise.
    cells : int
        Number of means that share the band.

    Returns
    -------
    ndarray of float, shape (k,)
        Half-width [deg].
    """
    quantile = stats.norm.ppf(0.5 + 0.5 * CONFIDENCE ** (1.0 / max(cells, 1)))
    inflation = np.sqrt((1.0 + max(rho, 0.0)) / (1.0 - min(max(rho, 0.0), 0.99)))
    width: Floats = quantile * sigma_deg * inflation / np.sqrt(np.maximum(counts, 1))
    return width


def profile(
    x: Floats, residual_deg: Floats, sigma_deg: float, rho: float, *, bins: int = 24, cells: int = 0
) -> Profile:
    """Mean residual in bins of equal numbers of samples.

    Parameters
    ----------
    x, residual_deg : ndarray of float, shape (n,)
        Quantity and residual [deg].
    sigma_deg, rho : float
        Standard deviation [deg] and lag-one autocorrelation of the noise.
    bins : int
        Most bins; fewer where there are few samples or few values.
    cells : int
        Number of means that share the band, where several profiles share a panel.
    """
    label = _equal_bins(x, bins)
    counts = np.bincount(label)
    mean_x = np.bincount(label, x) / counts
    mean = np.bincount(label, residual_deg) / counts
    return Profile(mean_x, mean, band(counts, sigma_deg, rho, cells or len(counts)))


def by_group(
    group: NDArray[np.int64], residual_deg: Floats, sigma_deg: float, rho: float
) -> Profile:
    """Mean residual of each group, such as a run; `x` is the group's number.

    Parameters
    ----------
    group : ndarray of int, shape (n,)
        Group of each sample.
    residual_deg : ndarray of float, shape (n,)
        Residual [deg].
    sigma_deg, rho : float
        Standard deviation [deg] and lag-one autocorrelation of the noise.
    """
    numbers, label = np.unique(group, return_inverse=True)
    counts = np.bincount(label)
    mean = np.bincount(label, residual_deg) / counts
    return Profile(numbers.astype(np.float64), mean, band(counts, sigma_deg, rho, len(numbers)))


def _equal_bins(x: Floats, bins: int) -> NDArray[np.int64]:
    """Label samples by quantile bins; equal values share a bin, no bin is empty."""
    bins = max(1, min(bins, len(x) // _LEAST_PER_BIN))
    span = float(np.ptp(x)) if len(x) else 0.0
    if span > 0:  # values that differ by less belong to one bin
        x = np.rint((x - x.min()) / span * 2000)
    edges = np.unique(np.quantile(x, np.linspace(0, 1, bins + 1)[1:-1]))
    raw = np.searchsorted(edges, x, side="right")
    return np.unique(raw, return_inverse=True)[1].astype(np.int64)


@dataclass(frozen=True, eq=False, slots=True)
class ResidualMap:
    """Mean residual in cells of torque by row (run and direction).

    Attributes
    ----------
    torque_edges_nm : ndarray of float, shape (k + 1,)
        Borders of the columns [N m].
    rows : tuple of str
        What each row is.
    mean_deg : ndarray of float, shape (rows, k)
        Mean residual [deg], NaN where there is no sample.
    outside : ndarray of bool, shape (rows, k)
        Cells that noise does not explain, all cells taken together.
    """

    torque_edges_nm: Floats
    rows: tuple[str, ...]
    mean_deg: Floats
    outside: Mask


def residual_map(
    torque_nm: Floats,
    row: NDArray[np.int64],
    row_names: tuple[str, ...],
    residual_deg: Floats,
    sigma_deg: float,
    rho: float,
    columns: int = 16,
) -> ResidualMap:
    """Mean residual by torque and row, with a band over all cells together.

    Parameters
    ----------
    torque_nm, residual_deg : ndarray of float, shape (n,)
        Torque [N m] and residual [deg].
    row : ndarray of int, shape (n,)
        Row of each sample.
    row_names : tuple of str
        What each row is.
    sigma_deg, rho : float
        Standard deviation [deg] and lag-one autocorrelation of the noise.
    columns : int
        Number of bins of the torque.
    """
    edges = np.linspace(torque_nm.min(), torque_nm.max(), columns + 1)
    column = np.clip(np.searchsorted(edges, torque_nm, side="right") - 1, 0, columns - 1)
    shape = (len(row_names), columns)
    label = row * columns + column
    counts = np.bincount(label, minlength=shape[0] * columns)
    total = np.bincount(label, residual_deg, minlength=shape[0] * columns)
    filled = counts > 0
    mean = np.where(filled, total / np.maximum(counts, 1), np.nan)
    width = band(counts, sigma_deg, rho, int(np.count_nonzero(filled)))
    outside = filled & (np.abs(np.nan_to_num(mean)) > width)
    return ResidualMap(edges, row_names, mean.reshape(shape), outside.reshape(shape))
