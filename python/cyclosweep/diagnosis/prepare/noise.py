"""The noise of a recording: size, autocorrelation, tails, coarse steps; and whitening by it."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import gammaln, ndtr

from cyclosweep.simulation.effects.history import Floats

MODEL_ERROR = 0.945
"""An autocorrelation above this is taken for structured error of the model, not for noise."""

INDEPENDENT_PIECES = 40.0
"""Rough number of independent pieces of a residual that is error of the model."""

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

    @property
    def spread_deg(self) -> float:
        """Standard deviation of one row about the mean [deg]."""
        return self.sigma_deg if self.marginal_deg is None else self.marginal_deg

    @property
    def _pair(self) -> Floats:
        return np.where(self.gap > 0, self.correlation**self.gap, 0.0)

    def whiten(self, rows: Floats) -> Floats:
        """Decorrelate rows (n,) or (n, k) whose neighbours correlate; variance is kept."""
        if self.correlation == 0.0:
            return rows
        pair = self._pair
        shape = (-1,) + (1,) * (rows.ndim - 1)
        out = rows.copy()
        out[1:] -= pair[1:].reshape(shape) * rows[:-1]
        out[1:] /= np.sqrt(1.0 - pair[1:] ** 2).reshape(shape)
        return out

    def residual(self, angle: Floats, mean: Floats) -> tuple[Floats, Floats]:
        """Unit-variance white residual, and the weight by which rows of a design enter.

        The residual is the normalised score of the likelihood, so that least squares on it is one
        step of scoring, whatever the tails and the resolution.
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
            return student_score(white, self.tail)[0] / root, even * (slope / root)
        return white, even

    def design(self, columns: Floats, weight: Floats) -> Floats:
        """Whitened columns in the unit of the residual."""
        return self.whiten(columns * (weight if columns.ndim == 1 else weight[:, None]))

    def with_sigma(self, sigma_deg: float) -> "Noise":
        """Return the same noise with another size."""
        return replace(self, sigma_deg=sigma_deg)


def student_score(white: Floats, tail: float) -> tuple[Floats, Floats]:
    """Score of rows of unit variance under Student's distribution, and its slope."""
    scale2 = (tail - 2.0) / tail if tail > 2.05 else 0.09
    spread = tail * scale2 + white**2
    score = (tail + 1.0) * white / spread
    return score, (tail + 1.0) * (tail * scale2 - white**2) / spread**2


def interval_score(angle: Floats, mean: Floats, sigma: float, step: float) -> tuple[Floats, Floats]:
    """Score and expected information of the mean of a reading rounded to a step."""
    centre = angle - mean
    score = _bin_score(centre, sigma, step)[0]
    nearest = mean - np.round((mean - angle) / step) * step - angle
    information = np.zeros_like(mean)
    for k in (-2, -1, 0, 1, 2):
        value, probability = _bin_score(-nearest + k * step, sigma, step)
        information += value**2 * probability
    return score, information


def _bin_score(centre: Floats, sigma: float, step: float) -> tuple[Floats, Floats]:
    """Derivative of the log-probability of a bin centred so far from the mean, and that."""
    low, high = (centre - step / 2) / sigma, (centre + step / 2) / sigma
    flip = low > 0
    low, high = np.where(flip, -high, low), np.where(flip, -low, high)
    probability = ndtr(high) - ndtr(low)
    density = np.exp(-0.5 * low**2) - np.exp(-0.5 * high**2)
    safe = np.maximum(probability, 1e-300)
    score = density / np.sqrt(2 * np.pi) / safe / sigma
    # Far in the tail the ratio tends to the distance of the nearer edge.
    score = np.where(probability < 1e-280, high / sigma, score)
    return np.where(flip, -score, score), probability


def estimate_noise(
    angle: Floats,
    rich: Floats,
    gap: Floats,
    resolution: float,
    weight: Floats,
) -> Noise:
    """Noise from what a rich model leaves, by restricted maximum likelihood.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    rich : ndarray, shape (n, k)
        Orthonormal columns of a model rich enough to leave hardly anything but noise.
    gap : ndarray, shape (n,)
        Steps since the row before, zero where unrelated.
    resolution : float
        Step of the angle reading [deg].
    weight : ndarray, shape (n,)
        Samples averaged in each row.
    """
    count = len(angle)
    basis = rich
    limit = max(count // 3, 3)
    basis = basis[:, :limit]
    freedom = max(count - basis.shape[1], 1)
    left = angle - basis @ (basis.T @ angle)
    scale = max(1.4826 * float(np.median(np.abs(left))), 1e-12)
    scale *= np.sqrt(count / freedom)
    clean = np.clip(left, -4 * scale, 4 * scale)
    best, upper = _correlation(clean, basis, gap)
    rough = Noise(1.0, upper, best, np.inf, 0.0, freedom, gap)
    sigma, tail, moments = _size(rough, left, basis, freedom)
    sigma = max(sigma, 1e-6 * float(np.ptp(angle)), 1e-12)
    averaged = float(np.median(weight)) > 1.5
    if resolution > 0 and not averaged:
        if sigma**2 < 0.165 * resolution**2 and count >= 60:
            fine = _interval_sigma(angle, rich, resolution, sigma)
            if fine < resolution / COARSE_STEP:
                known = Noise(fine, 0.0, 0.0, np.inf, resolution, freedom, gap)
                mean = _scored_mean(angle, rich[:, :12], known, sigma)
                score, weight = known.residual(angle, mean)
                best, upper = _correlation(score, basis[:, :1], gap)
                telling = float(np.sum((weight * fine) ** 2))
                return replace(
                    known,
                    correlation=upper,
                    best_correlation=best,
                    freedom=max(telling - 6.0, 4.0),
                )
        sigma = max(sigma, resolution / np.sqrt(12.0))
    if best > MODEL_ERROR:
        # What is left is not noise but error of the model; filtered, it would be fitted by its
        # kinks. Rows count equally then.
        plain = max(float(np.sqrt(left @ left / freedom)), 1e-12)
        return Noise(plain, 0.0, best, np.inf, 0.0, freedom, gap, plain, structured=True)
    return Noise(sigma, upper, best, tail, 0.0, freedom, gap, score_moments=moments)


def orthonormal(columns: Floats, tolerance: float = 1e-9) -> Floats:
    """Orthonormal basis of the columns' span, strongest direction first, rank aware."""
    if columns.shape[1] == 0:
        return columns
    norm = np.linalg.norm(columns, axis=0)
    kept = columns[:, norm > 0] / norm[norm > 0]
    left, singular, _ = np.linalg.svd(kept, full_matrices=False)
    return np.asarray(left[:, singular > tolerance * singular[0]])


def _correlation(left: Floats, basis: Floats, gap: Floats) -> tuple[float, float]:
    """Restricted likelihood of the autocorrelation: its best value and an upper one."""
    near = np.flatnonzero((gap > 0) & (gap < 1.5))
    if len(near) < 20:
        return 0.0, 0.0
    rows = np.column_stack([basis, left])
    now, before = rows[near], rows[near - 1]
    alone = np.ones(len(left), dtype=bool)
    alone[near] = False
    current, crossed = now.T @ now, now.T @ before
    crossed = crossed + crossed.T
    earlier = before.T @ before
    start = rows[alone].T @ rows[alone]
    k = basis.shape[1]
    freedom = len(left) - k
    grid = np.r_[0.0:0.985:0.01]
    value = np.empty(len(grid))
    for index, rho in enumerate(grid):
        gram = start + (current - rho * crossed + rho**2 * earlier) / (1 - rho**2)
        inner, edge = gram[:k, :k], gram[:k, k]
        sign, determinant = np.linalg.slogdet(inner)
        rest = gram[k, k] - edge @ np.linalg.solve(inner, edge)
        spread = len(near) * np.log(1 - rho**2)
        value[index] = -0.5 * (spread + determinant + freedom * np.log(max(rest, 1e-300)))
        if sign <= 0:
            value[index] = -np.inf
    best = int(np.argmax(value))
    # The higher it is, the dearer an underestimate.
    drop = 1.0 + 2.0 * grid[best] ** 2
    within = np.flatnonzero(value > value[best] - drop)
    if best == 0 and value[0] - value[1] > 1.0:
        return 0.0, 0.0
    return float(grid[best]), float(grid[within[-1]])


def _size(
    noise: Noise, left: Floats, basis: Floats, freedom: float
) -> tuple[float, float, tuple[float, float]]:
    """Size of the whitened noise, the tail of its distribution, slope and square of its score."""
    white = noise.whiten(left)
    inner = orthonormal(noise.whiten(basis))
    white = white - inner @ (inner.T @ white)
    count = len(white)
    sigma = float(np.sqrt(white @ white / freedom))
    if count < 100 or sigma <= 0:
        return max(sigma, 1e-9), np.inf, (1.0, 1.0)
    inflate = np.sqrt(count / freedom)
    scale = 1.4826 * float(np.median(np.abs(white))) * inflate
    best_tail, best_value, best_sigma = np.inf, -np.inf, sigma
    for tail in (np.inf, 12.0, 7.0, 5.0, 4.0, 3.2, 2.6):
        if np.isinf(tail):
            value = -count * (np.log(sigma / inflate) + 0.5 * np.log(2 * np.pi)) - 0.5 * count
            trial = sigma
        else:
            trial = scale
            for _ in range(30):
                factor = (tail + 1) / (tail + (white * inflate / trial) ** 2)
                trial = float(np.sqrt(np.mean(factor * (white * inflate) ** 2)))
            value = _student_likelihood(white * inflate / trial, tail) - count * np.log(trial)
            value += count * np.log(inflate) - 3.0
            trial *= np.sqrt(tail / (tail - 2.0))
        if value > best_value:
            best_tail, best_value, best_sigma = tail, value, trial
    if np.isinf(best_tail):
        return best_sigma, best_tail, (1.0, 1.0)
    score, slope = student_score(white * inflate / best_sigma, best_tail)
    return best_sigma, best_tail, (float(np.mean(slope)), float(np.mean(score**2)))


def _student_likelihood(values: Floats, tail: float) -> float:
    """Log likelihood of values under Student's distribution of unit scale."""
    front = gammaln(0.5 * (tail + 1)) - gammaln(0.5 * tail) - 0.5 * np.log(np.pi * tail)
    return float(len(values) * front - 0.5 * (tail + 1) * np.log1p(values**2 / tail).sum())


def _scoring_step(angle: Floats, basis: Floats, mean: Floats, sigma: float, step: float) -> Floats:
    """One damped Fisher-scoring step of the mean of a coarse reading within a basis."""
    score, information = interval_score(angle, mean, sigma, step)
    gram = basis.T @ (basis * information[:, None])
    gram += (1e-6 * np.trace(gram) / len(gram) + 1e-12) * np.eye(len(gram))
    change = basis @ np.linalg.solve(gram, basis.T @ score)
    longest = float(np.abs(change).max(initial=0.0))
    return mean + change * min(1.0, 0.5 * step / max(longest, 1e-300))


def _scored_mean(angle: Floats, basis: Floats, noise: Noise, start_sigma: float) -> Floats:
    """Mean of a coarse reading by Fisher scoring, from wide noise down to the given one."""
    mean = basis @ (basis.T @ angle)
    sigma = max(start_sigma, noise.sigma_deg)
    while True:
        for _ in range(5):
            mean = _scoring_step(angle, basis, mean, sigma, noise.step_deg)
        if sigma <= noise.sigma_deg:
            return mean
        sigma = max(0.6 * sigma, noise.sigma_deg)


def _interval_sigma(angle: Floats, rich: Floats, step: float, start: float) -> float:
    """Standard deviation behind a coarse dial: the largest that the likelihood still allows.

    Only readings near a step tell anything, so the model that is taken out is kept small.
    """
    grid = step / np.geomspace(2.0, 60.0, 24)
    telling = len(angle) * 4.0 * grid / step
    value = np.empty(len(grid))
    for width in (3, 12):
        basis = rich[:, :width]
        mean = basis @ (basis.T @ angle)
        for k, sigma in enumerate(grid):
            if width > 3 and telling[k] < 20 * width:
                break
            for _ in range(4):
                mean = _scoring_step(angle, basis, mean, float(sigma), step)
            _, probability = _bin_score(angle - mean, float(sigma), step)
            value[k] = float(np.log(np.maximum(probability, 1e-300)).sum())
    allowed = np.flatnonzero(value > value.max() - 1.0)
    return float(grid[allowed[0]])
