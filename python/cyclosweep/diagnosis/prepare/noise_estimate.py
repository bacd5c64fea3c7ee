"""Estimate of a recording's noise from what a flexible basis of twist leaves."""

import math
from dataclasses import replace

import numpy as np
from scipy.stats import t as student_t

from cyclosweep.diagnosis.prepare.autocorrelation import autocorrelation
from cyclosweep.diagnosis.prepare.noise import COARSE_STEP, Noise, orthonormal
from cyclosweep.diagnosis.prepare.row_score import bin_score, interval_score, student_score
from cyclosweep.diagnosis.prepare.steadiness import rides, unsteadiness
from cyclosweep.diagnosis.prepare.white_part import (
    MUCH_LIKELIER,
    noise_with_free_white_part,
    noise_with_white_part,
)
from cyclosweep.recording.robust import robust_sigma, rounding_sigma, sigma_by_second_differences
from cyclosweep.simulation.effects.history import Floats

SLOW_AS_MODEL_ERROR = 0.9
"""Autocorrelation above which what is left is noise only if its size is the same everywhere."""
UNSTEADY = 2.0
"""Scatter of the size of whitened stretches, over that of steady noise, from which what is left is
error of the model. Steady noise stays below 1.7 up to an autocorrelation of 0.99, also with heavy
tails; errors of models gather at reversals and at certain loads, and most are above 2.4."""
UNEVEN = 0.1
"""Difference of steps by the clock from steps by rows from which it matters which of them count."""
COARSE = 0.165
"""Mean square of what is left over the square of the dial's step, below which its intervals may
count: twice that of rounding alone."""


def estimate_noise(
    angle: Floats,
    basis: Floats,
    gap: Floats,
    resolution: float,
    weight: Floats,
    row_gap: Floats | None = None,
    *,
    white_deg: float = 0.0,
    all_noise: bool = False,
) -> Noise:
    """Noise from what a flexible basis leaves, by restricted maximum likelihood.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns, flexible enough to leave hardly anything but noise, strongest first.
    gap : ndarray, shape (n,)
        Steps since the row before, zero where unrelated.
    resolution : float
        Step of the angle reading [deg].
    weight : ndarray, shape (n,)
        Samples averaged in each row.
    row_gap : ndarray, shape (n,), optional
        The same as ``gap``, counted in rows where that goes by the clock; the likelier one is used.
    white_deg : float
        Standard deviation of what is known to be new in every row, beside rounding [deg].
    all_noise : bool
        Take what is left for noise even where it looks like error of the model.

    Returns
    -------
    Noise
    """
    count = len(angle)
    whole, basis = basis, basis[:, : max(count // 3, 3)]
    freedom = max(count - basis.shape[1], 1)
    left = angle - basis @ (basis.T @ angle)
    scale = max(robust_sigma(left), 1e-12)
    scale *= np.sqrt(count / freedom)
    clean = np.clip(left, -4 * scale, 4 * scale)
    best, upper = autocorrelation(clean, basis, gap)
    rough = Noise(1.0, upper, best, np.inf, 0.0, freedom, gap)
    if row_gap is not None and not np.allclose(gap, row_gap, atol=UNEVEN):
        other, its_upper = autocorrelation(clean, basis, row_gap)
        likelier = replace(rough, correlation=other, gap=row_gap).log_likelihood(clean)
        if likelier > replace(rough, correlation=best).log_likelihood(clean) + MUCH_LIKELIER:
            rough = Noise(1.0, its_upper, other, np.inf, 0.0, freedom, row_gap, by_rows=True)
            best = other
    averaged = float(np.median(weight)) > 1.5
    white_part = float(np.hypot(white_deg, 0.0 if averaged else rounding_sigma(resolution)))
    if white_part > 0.0:
        # Rounding has to show itself; noise of the torque is known to be there.
        least = 0.0 if white_deg > 0.0 else MUCH_LIKELIER
        rough = noise_with_white_part(clean, basis, rough, white_part, least) or rough
        best = rough.best_correlation
    one_part = rough.white_share == 0.0
    if one_part and not rides(rough, rough.whiten(left)):
        rough = noise_with_free_white_part(clean, basis, rough) or rough
        best = rough.best_correlation
    sigma, tail, moments, gain = _size(rough, left, basis, freedom)
    sigma = max(sigma, 1e-6 * float(np.ptp(angle)), 1e-12)
    by_interval = sigma**2 < COARSE * resolution**2
    if resolution > 0 and not averaged:
        if by_interval and count >= 60:
            coarse = _coarse_noise(angle, whole, rough, resolution, sigma)
            if coarse is not None:
                return coarse
        sigma = max(sigma, rounding_sigma(resolution))
    found = replace(rough, sigma_deg=sigma, tail=tail, score_moments=moments, tail_gain=gain)
    if all_noise:
        return found
    white = rough.whiten(left)
    mixed = rough.white_share > 0.0
    unsteady = best > SLOW_AS_MODEL_ERROR and unsteadiness(white, loud_only=mixed) > UNSTEADY
    if unsteady or rides(rough, white):
        # Readings that rest on a step look unsteady, and like noise larger than what is left.
        small = left @ left < COARSE * resolution**2 * freedom
        if small and not by_interval and not averaged:
            coarse = _coarse_noise(angle, whole, rough, resolution, sigma)
            if coarse is not None:
                return coarse
        return as_model_error(rough, left, resolution, float(np.ptp(angle)))
    return found


def as_model_error(noise: Noise, left: Floats, resolution: float, travel: float) -> Noise:
    """Noise of a recording in which what a flexible model leaves is error of the model.

    Filtered by its autocorrelation, error of the model would be fitted by its kinks. Rows count
    equally then, and noise is what differs from row to row.

    Parameters
    ----------
    noise : Noise
        What is left, described as noise.
    left : ndarray, shape (n,)
        What is left, in the order of the readings [deg].
    resolution : float
        Step of the angle reading [deg].
    travel : float
        Range of the measured twist [deg].

    Returns
    -------
    Noise
    """
    least = max(sigma_by_second_differences(left), rounding_sigma(resolution), 1e-6 * travel, 1e-12)
    return replace(
        noise,
        sigma_deg=least,
        correlation=0.0,
        white_share=0.0,
        tail=np.inf,
        score_moments=(1.0, 1.0),
        structured=True,
    )


def _coarse_noise(
    angle: Floats, basis: Floats, rough: Noise, resolution: float, start_sigma: float
) -> Noise | None:
    """Noise below a reading so coarse that its intervals count; None where it is fine enough.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    rough : Noise
        Estimate without regard to the steps of the reading, for how steps from row to row count.
    resolution : float
        Step of the reading [deg].
    start_sigma : float
        Standard deviation from which to start [deg].

    Returns
    -------
    Noise or None
    """
    count = len(angle)
    inner = basis[:, : max(count // 3, 3)]
    fine = _interval_sigma(angle, basis, resolution)
    if fine >= resolution / COARSE_STEP:
        return None
    freedom = max(count - inner.shape[1], 1)
    known = Noise(fine, 0.0, 0.0, np.inf, resolution, freedom, rough.gap, by_rows=rough.by_rows)
    mean = _scored_mean(angle, basis[:, :12], known, start_sigma)
    score, weight = known.residual(angle, mean)
    best, upper = autocorrelation(score, inner[:, :1], rough.gap)
    near_a_step = float(np.sum((weight * fine) ** 2))
    return replace(
        known, correlation=upper, best_correlation=best, freedom=max(near_a_step - 6.0, 4.0)
    )


def _size(
    noise: Noise, left: Floats, basis: Floats, freedom: float
) -> tuple[float, float, tuple[float, float], float]:
    """Size of the whitened noise, its tail, slope and square of its score, gain of the tail.

    Parameters
    ----------
    noise : Noise
        With the autocorrelation.
    left : ndarray, shape (n,)
        What the basis leaves of the twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    freedom : float
        Degrees of freedom that the basis leaves.

    Returns
    -------
    sigma, tail, moments, gain
        Standard deviation [deg], degrees of freedom, mean slope and mean square of the score, log
        density of a row beyond that of Gaussian rows of this standard deviation [nat].
    """
    white = noise.whiten(left)
    inner = orthonormal(noise.whiten(basis))
    white = white - inner @ (inner.T @ white)
    count = len(white)
    sigma = float(np.sqrt(white @ white / freedom))
    if count < 100 or sigma <= 0:
        return max(sigma, 1e-9), np.inf, (1.0, 1.0), 0.0
    inflate = np.sqrt(count / freedom)
    scale = robust_sigma(white) * inflate
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
            value = float(student_t.logpdf(white * inflate / trial, tail).sum()) - count * np.log(
                trial
            )
            value += count * np.log(inflate) - 3.0
            trial *= np.sqrt(tail / (tail - 2.0))
        if value > best_value:
            best_tail, best_value, best_sigma = tail, value, trial
    if np.isinf(best_tail):
        return best_sigma, best_tail, (1.0, 1.0), 0.0
    score, slope = student_score(white * inflate / best_sigma, best_tail)
    gaussian = -float(np.log(best_sigma / inflate)) - 0.5 * float(np.log(2 * np.pi * math.e))
    gain = best_value / count - gaussian
    return best_sigma, best_tail, (float(np.mean(slope)), float(np.mean(score**2))), gain


def _scoring_step(angle: Floats, basis: Floats, mean: Floats, sigma: float, step: float) -> Floats:
    """One damped Fisher-scoring step of the mean of a coarse reading within a basis.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    mean : ndarray, shape (n,)
        Modelled twist [deg].
    sigma : float
        Standard deviation before rounding [deg].
    step : float
        Step of the reading [deg].

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    score, information = interval_score(angle, mean, sigma, step)
    gram = basis.T @ (basis * information[:, None])
    gram += (1e-6 * np.trace(gram) / len(gram) + 1e-12) * np.eye(len(gram))
    change = basis @ np.linalg.solve(gram, basis.T @ score)
    longest = float(np.abs(change).max(initial=0.0))
    return mean + change * min(1.0, 0.5 * step / max(longest, 1e-300))


def _scored_mean(angle: Floats, basis: Floats, noise: Noise, start_sigma: float) -> Floats:
    """Mean of a coarse reading by Fisher scoring, from wide noise down to the given one.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    noise : Noise
    start_sigma : float
        Standard deviation from which to start [deg].

    Returns
    -------
    ndarray, shape (n,)
        In deg.
    """
    mean = basis @ (basis.T @ angle)
    sigma = max(start_sigma, noise.sigma_deg)
    while True:
        for _ in range(5):
            mean = _scoring_step(angle, basis, mean, sigma, noise.step_deg)
        if sigma <= noise.sigma_deg:
            return mean
        sigma = max(0.6 * sigma, noise.sigma_deg)


def _interval_sigma(angle: Floats, basis: Floats, step: float) -> float:
    """Standard deviation behind a coarse dial: the largest that the likelihood still allows.

    Only readings near a step tell anything, so the model that is taken out is kept small.

    Parameters
    ----------
    angle : ndarray, shape (n,)
        Measured twist [deg].
    basis : ndarray, shape (n, k)
        Orthonormal columns of the model.
    step : float
        Step of the reading [deg].

    Returns
    -------
    float
        In deg.
    """
    grid = step / np.geomspace(2.0, 60.0, 24)
    near_a_step = len(angle) * 4.0 * grid / step
    value = np.empty(len(grid))
    for width in (3, 12):
        part = basis[:, :width]
        mean = part @ (part.T @ angle)
        for k, sigma in enumerate(grid):
            if width > 3 and near_a_step[k] < 20 * width:
                break
            for _ in range(4):
                mean = _scoring_step(angle, part, mean, float(sigma), step)
            _, probability = bin_score(angle - mean, float(sigma), step)
            value[k] = float(np.log(np.maximum(probability, 1e-300)).sum())
    allowed = np.flatnonzero(value > value.max() - 1.0)
    return float(grid[allowed[0]])
