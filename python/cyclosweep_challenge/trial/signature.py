"""What an effect adds to a recording once the calibration is free: signature, d and overlap."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.noise import Noise
from cyclosweep_challenge.rig.programme import Programme

Array = NDArray[np.float64]


def calibration(programme: Programme) -> Array:
    """Directions that a free calibration moves: datum, free play and compliance, shape (N, 3)."""
    torque = programme.torque_nm
    return np.column_stack([np.ones(len(programme)), np.sign(torque), torque])


def basis(columns: Array) -> Array:
    """Orthonormal basis of the columns' span; directions below 1e-9 of the largest dropped."""
    size = np.linalg.norm(columns, axis=0)
    left, singular, _ = np.linalg.svd(
        columns / np.where(size > 0.0, size, 1.0), full_matrices=False
    )
    return left[:, singular > 1e-9 * max(float(singular[0]), 1e-300)]


def without(columns: Array, span: Array) -> Array:
    """Columns with their part in an orthonormal span taken out."""
    return columns - span @ (span.T @ columns)


@dataclass(frozen=True)
class Visibility:
    """How visible each cause is in one recording.

    Attributes
    ----------
    d : array, shape (K,)
        Signal-to-noise after calibration and the other causes are projected out [-].
    d_alone : array, shape (K,)
        The same with the calibration alone projected out [-].
    absorbed : array, shape (K,)
        Part of the signature that a calibration hides: one minus the ratio of norms [-].
    cosine : array, shape (K, K)
        Overlap of the projected signatures [-].
    rms_deg, peak_deg : array, shape (K,)
        Size after re-calibration, as rms and as largest value [deg].
    raw_rms_deg, raw_peak_deg : array, shape (K,)
        Size before re-calibration [deg].
    direction : array, shape (N, K)
        Whitened signatures with everything else projected out, of unit norm.
    """

    d: Array
    d_alone: Array
    absorbed: Array
    cosine: Array
    rms_deg: Array
    peak_deg: Array
    raw_rms_deg: Array
    raw_peak_deg: Array
    direction: Array


def visibility(
    signatures_deg: Array, programme: Programme, noise: Noise, compliance_deg_per_nm: float
) -> Visibility:
    """Project signatures off the calibration and each other, in units of the true noise.

    Parameters
    ----------
    signatures_deg : array, shape (N, K)
        Angle that each cause adds at every recorded sample [deg].
    programme : Programme
        The recorded samples.
    noise : Noise
        The true noise; its information enters d, so that heavy tails make an effect more
        visible and a coarse dial less.
    compliance_deg_per_nm : float
        Compliance of the specimen [deg/(N m)].
    """
    information = np.sqrt(noise.information())
    fixed = calibration(programme)
    plain = without(signatures_deg, basis(fixed))
    white = noise.whiten(signatures_deg, programme, compliance_deg_per_nm)
    span = basis(noise.whiten(fixed, programme, compliance_deg_per_nm))
    alone = without(white, span)
    size_alone = np.linalg.norm(alone, axis=0)
    size_white = np.linalg.norm(white, axis=0)
    count = signatures_deg.shape[1]
    direction = np.zeros_like(alone)
    d = np.zeros(count)
    for k in range(count):
        others = np.delete(alone, k, axis=1)
        rest = without(alone[:, k : k + 1], basis(others)) if others.size else alone[:, k : k + 1]
        d[k] = np.linalg.norm(rest)
        direction[:, k] = rest[:, 0] / max(d[k], 1e-300)
    unit = alone / np.maximum(size_alone, 1e-300)
    return Visibility(
        d=information * d,
        d_alone=information * size_alone,
        absorbed=1.0 - size_alone / np.maximum(size_white, 1e-300),
        cosine=unit.T @ unit,
        rms_deg=np.sqrt(np.mean(plain**2, axis=0)),
        peak_deg=np.abs(plain).max(axis=0),
        raw_rms_deg=np.sqrt(np.mean(signatures_deg**2, axis=0)),
        raw_peak_deg=np.abs(signatures_deg).max(axis=0),
        direction=direction,
    )
