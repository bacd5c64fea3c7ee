"""How visible a cause is: its signature with the baseline's tangents projected out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.second_generator.sensor import Sensor

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Size:
    """Size of one cause in one recording.

    Attributes
    ----------
    d : float
        Projected signal-to-noise, compliance, play and datum free [-].
    d_apart : float
        The same with the other causes' signatures free too [-].
    rms_deg, peak_deg : float
        Size after least squares of the baseline [deg].
    raw_rms_deg, raw_peak_deg : float
        With the cause less without it, as it stands [deg].
    """

    d: float
    d_apart: float
    rms_deg: float
    peak_deg: float
    raw_rms_deg: float
    raw_peak_deg: float


def tangents(side: Array, load: Array) -> Array:
    """Directions in which datum, play and compliance move the angle, shape (N, 3)."""
    return np.column_stack([np.ones(len(load)), side, load])


def without(columns: Array, free: Array) -> Array:
    """Columns with their least-squares part in the free directions taken out."""
    scale = np.linalg.norm(free, axis=0)
    left, singular, _ = np.linalg.svd(free / np.where(scale > 0.0, scale, 1.0), full_matrices=False)
    span = left[:, singular > 1e-9 * max(float(singular[0]), 1e-300)]
    return np.asarray(columns - span @ (span.T @ columns), dtype=float)


def size_of(
    signature_deg: Array,
    free: Array,
    others_deg: Array,
    sensor: Sensor,
    starts: NDArray[np.bool_],
) -> Size:
    """Size of a signature.

    Parameters
    ----------
    signature_deg : array, shape (N,)
        Angle with the cause less angle without it [deg].
    free : array, shape (N, 3)
        Tangents of the baseline.
    others_deg : array, shape (N, K)
        Signatures of the other causes [deg].
    sensor : Sensor
        True noise.
    starts : array of bool, shape (N,)
        Rows that begin a run.
    """
    column = signature_deg[:, None]
    white = sensor.whitened(np.hstack([column, free, others_deg]), starts)
    left = without(column, free)[:, 0]
    return Size(
        d=float(np.linalg.norm(without(white[:, :1], white[:, 1:4]))),
        d_apart=float(np.linalg.norm(without(white[:, :1], white[:, 1:]))),
        rms_deg=float(np.sqrt(np.mean(left**2))),
        peak_deg=float(np.abs(left).max()),
        raw_rms_deg=float(np.sqrt(np.mean(signature_deg**2))),
        raw_peak_deg=float(np.abs(signature_deg).max()),
    )
