"""The noise of a recording: size, autocorrelation, tails, coarse steps; and whitening by it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import cholesky_banded
from scipy.special import digamma

import cyclosweep._core as _core
from cyclosweep.diagnosis.prepare.row_score import (
    interval_score,
    student_deviance,
    student_score,
    with_rounding,
)
from cyclosweep.simulation.effects.history import Floats

INDEPENDENT_PIECES = 40.0
"""Rough number of independent pieces of a residual that is error of the model."""
FAR_OFF, FAR_ROWS = 3.0, 0.1
"""Residual over the noise, and share of the rows beyond it, from which a fit is far off, and not a
few rows outliers: under heavy tails, one row in seventy. The score of heavy tails, which forgets
rows that are far off, would then find the worst fit best."""
COARSE_STEP = 3.5
"""Resolution steps above this many standard deviations need the interval likelihood."""


@dataclass(frozen=True, eq=False)
class Noise:
    """Noise model of the fitted rows.

    Attributes
    ----------
    sigma_deg : float
        Standard deviation of a row, with a fine dial's rounding included [deg].
    correlation : float
        Upper estimate of the autocorrelation from row to row, by which everything is whitened.
    best_correlation : float
        Restricted maximum-likelihood estimate of it.
    tail : float
        Degrees of freedom of the Student distribution of the innovations; infinite: Gaussian.
    step_deg : float
        Resolution step where the interval likelihood is needed, else zero [deg].
    freedom : float
        Degrees of freedom with which sigma is known.
    gap : ndarray
        Steps since the fitted row before; zero: no correlation with it.
    marginal_deg : float or None
        Standard deviation of a row where ``sigma_deg`` is something else.
    structured : bool
        What is left is error of the model rather than noise.
    score_moments : tuple of float
        Mean slope and mean square of the score of one white row of unit variance; what they
        are, not what Student's distribution says, for outliers are not drawn from it.
    model_error_factor : float
        Size of noise and model error together over that of the noise; one without model error.
    by_rows : bool
        Whether ``gap`` counts rows although there is a clock.
    white_share : float
        Share of a row's variance that is new in every row, as rounding is, beside the part that
        correlates from row to row.
    tail_gain : float
        Log density of a row, in the mean, beyond that of Gaussian rows of this ``sigma_deg`` [nat]:
        what the tails gain.
    """

    sigma_deg: float
    correlation: float
    best_correlation: float
    tail: float
    step_deg: float
    freedom: float
    gap: Floats
    marginal_deg: float | None = None
    structured: bool = False
    score_moments: tuple[float, float] = (1.0, 1.0)
    model_error_factor: float = 1.0
    by_rows: bool = False
    white_share: float = 0.0
    tail_gain: float = 0.0

    @property
    def plain(self) -> "Noise":
        """The same noise as if Gaussian, rounding included: nothing that is far off counts less."""
        sigma = with_rounding(self.sigma_deg, self.step_deg)
        return replace(self, sigma_deg=sigma, tail=np.inf, step_deg=0.0, score_moments=(1.0, 1.0))

    @property
    def spread_deg(self) -> float:
        """Standard deviation of one row about the mean, rounding included [deg]."""
        rounded = with_rounding(self.sigma_deg, self.step_deg)
        return rounded if self.marginal_deg is None else self.marginal_deg

    @property
    def independent_pieces(self) -> float:
        """Independent pieces of the recording by this noise, if it were one run."""
        return len(self.gap) * (1.0 - self.best_correlation) / (1.0 + self.best_correlation)

    @property
    def pieces_and_breaks(self) -> float:
        """The same with one more for each break between rows that do not correlate, as of runs."""
        return self.independent_pieces + int(np.count_nonzero(self.gap <= 0.0)) - 1

    @property
    def likely_spread_deg(self) -> float:
        """The same by the likeliest correlation instead of its upper estimate [deg]."""
        return self.spread_deg * float(np.sqrt(self.white_share + self._likely_slow))

    @property
    def likely_white_share(self) -> float:
        """Share of the variance that is new in every row, by the likeliest correlation."""
        return self.white_share / (self.white_share + self._likely_slow)

    @property
    def _likely_slow(self) -> float:
        """Likeliest variance of the part that correlates, over that of a row."""
        slow = 1.0 - self.white_share
        if self.correlation < self.best_correlation:
            return slow
        # The innovations are known; what they add up to depends on how long they last.
        return slow * (1.0 - self.correlation**2) / (1.0 - self.best_correlation**2)

    @cached_property
    def _pair(self) -> Floats:
        """Correlation of each row after the first with the one before."""
        return np.where(self.gap > 0, self.correlation**self.gap, 0.0)[1:]

    @cached_property
    def _lower(self) -> Floats:
        """Diagonal and subdiagonal of the Cholesky factor of the rows' steps, shape (2, n).

        Less its correlated part of the row before, a row of correlated and white noise correlates
        with its two neighbours only (Box and Jenkins, Time Series Analysis, A4.3: the sum of a
        first-order autoregression and white noise is ARMA(1, 1)).
        """
        share, pair = self.white_share, self._pair
        band = np.zeros((2, len(self.gap)))
        band[0] = np.r_[1.0, (1.0 - share) * (1.0 - pair**2) + share * (1.0 + pair**2)]
        band[1, :-1] = -share * pair
        return np.ascontiguousarray(cholesky_banded(band, lower=True))

    @property
    def log_determinant(self) -> float:
        """Logarithm of the determinant of the rows' correlation matrix."""
        if self.white_share > 0.0:
            return 2.0 * float(np.log(self._lower[0]).sum())
        return float(np.log1p(-(self._pair**2)).sum())

    @cached_property
    def _carried(self) -> tuple[Floats, Floats]:
        """Share of each row after the first in what was new in the one before, and its own new."""
        if self.white_share > 0.0:
            return self._lower[1, :-1], self._lower[0, 1:]
        return np.zeros_like(self._pair), np.asarray(np.sqrt(1.0 - self._pair**2))

    def whiten(self, rows: Floats) -> Floats:
        """Decorrelate rows (n,) or (n, k) whose neighbours correlate; variance is kept."""
        if self.correlation == 0.0:
            return rows
        return self.design(rows, np.ones(len(rows)))

    def log_likelihood(self, rows: Floats) -> float:
        """Log likelihood [nat] of rows (n,) of this correlation and of whatever size suits best."""
        size = max(float(np.mean(self.whiten(rows) ** 2)), 1e-300)
        return -0.5 * (len(rows) * float(np.log(size)) + self.log_determinant)

    def residual(self, angle: Floats, mean: Floats) -> tuple[Floats, Floats]:
        """Unit-variance white residual, and the weight by which rows of a design enter.

        The residual is the normalised score of the likelihood, so that least squares on it is one
        step of scoring, whatever the tails and the resolution.

        Parameters
        ----------
        angle, mean : ndarray, shape (n,)
            Measured and modelled twist of the fitted rows [deg].

        Returns
        -------
        residual : ndarray, shape (n,)
        weight : ndarray, shape (n,)
            One over the standard deviation that a row has for this purpose [1/deg].
        """
        if self.step_deg > 0:
            score, information = interval_score(angle, mean, self.sigma_deg, self.step_deg)
            weight = np.sqrt(information)
            ratio = np.divide(score, weight, out=np.zeros_like(score), where=weight > 1e-9)
            return self.whiten(np.clip(ratio, -8.0, 8.0)), weight
        white = self.whiten((angle - mean) / self.sigma_deg)
        even = np.full(len(mean), 1.0 / self.sigma_deg)
        if np.isfinite(self.tail):
            slope, square = self.score_moments
            root = np.sqrt(square)
            far = float(np.mean(np.abs(white) > FAR_OFF)) > FAR_ROWS if len(white) else False
            shape = student_deviance if far else student_score
            return shape(white, self.tail)[0] / root, even * (slope / root)
        return white, even

    @property
    def forgets_far_off(self) -> bool:
        """Whether rows that are far off count for less in `residual` than they are unlikely."""
        return self.step_deg == 0.0 and bool(np.isfinite(self.tail))

    def misfit(self, angle: Floats, mean: Floats) -> float:
        """Twice the log likelihood that a mean lacks to a perfect one.

        The residual's sum of squares is no such measure: under heavy tails it forgets what is far
        off. A rounding counts as noise.

        Parameters
        ----------
        angle, mean : ndarray, shape (n,)
            Measured and modelled twist of the fitted rows [deg].

        Returns
        -------
        float
        """
        white = self.whiten((angle - mean) / with_rounding(self.sigma_deg, self.step_deg))
        if np.isfinite(self.tail):
            white = student_deviance(white, self.tail)[0]
        return float(white @ white)

    @cached_property
    def loss_of_row(self) -> float:
        """Mean of a row's part of `misfit` where the noise is all there is."""
        if not self.forgets_far_off:
            return 1.0
        half = 0.5 * self.tail
        return float((self.tail + 1.0) * (digamma(half + 0.5) - digamma(half)))

    def design(self, columns: Floats, weight: Floats) -> Floats:
        """Whitened columns in the unit of the residual.

        Parameters
        ----------
        columns : ndarray, shape (n,) or (n, k)
            Twist for unit parameters [deg].
        weight : ndarray, shape (n,)
            As `residual` gives it [1/deg].

        Returns
        -------
        ndarray, shape (n,) or (n, k)
            Of unit variance where the noise alone is.
        """
        if self.correlation == 0.0:
            return columns * weight.reshape((-1,) + (1,) * (columns.ndim - 1))
        rows = np.ascontiguousarray(columns[:, None] if columns.ndim == 1 else columns)
        white = _core.whiten_weighted(rows, weight, self._pair, *self._carried)
        return white.reshape(columns.shape)

    def with_sigma(self, sigma_deg: float) -> "Noise":
        """Return the same noise with another size."""
        return replace(self, sigma_deg=sigma_deg)

    def with_model_error(self, factor: float) -> "Noise":
        """Return the noise with model error added to it.

        Parameters
        ----------
        factor : float
            Standard deviation of noise and model error together over that of this noise, which may
            hold model error already.

        Returns
        -------
        Noise
            Its ``spread_deg`` is still that of the noise alone.
        """
        if factor <= 1.0:
            return self
        sigma, step = factor * self.sigma_deg, self.step_deg
        if step > 0 and sigma > step / COARSE_STEP:
            # Spread over several steps, a reading is as good as continuous.
            sigma, step = with_rounding(sigma, step), 0.0
        slope, square = self.score_moments
        return replace(
            self,
            sigma_deg=sigma,
            step_deg=step,
            tail=self.tail * factor**2,
            marginal_deg=self.spread_deg,
            model_error_factor=factor * self.model_error_factor,
            score_moments=(1.0 + (slope - 1.0) / factor**2, 1.0 + (square - 1.0) / factor**2),
        )


def orthonormal(columns: Floats, tolerance: float = 1e-9) -> Floats:
    """Orthonormal basis of the columns' span, strongest direction first.

    Parameters
    ----------
    columns : ndarray, shape (n, k)
        Linearly dependent ones do no harm.
    tolerance : float
        Singular values below this share of the largest are left out.

    Returns
    -------
    ndarray, shape (n, rank)
    """
    norm = np.linalg.norm(columns, axis=0)
    kept = columns[:, norm > 0] / norm[norm > 0]
    if kept.shape[1] == 0:
        return np.asarray(kept)
    left, singular, _ = np.linalg.svd(kept, full_matrices=False)
    return np.asarray(left[:, singular > tolerance * singular[0]])
