"""Recordings of a metal bar that is bent to and fro beyond its yield point."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

import cyclosweep as cs

ELASTIC_NM_PER_DEG = 200.0
"""Stiffness below the yield point, and right after each reversal."""
YIELDS_DEG = np.array([20.0, 28.0, 36.0, 44.0, 60.0]) / ELASTIC_NM_PER_DEG
"""Twists at which parts of the bar yield, so that the loop is rounded."""


def metal(
    every: int = 1,
    *,
    peaks_deg: Sequence[float] = (2.0,) * 6,
    hardening_nm_per_deg: float = 2.0,
    torque_factor: float = 1.0,
    angle_factor: float = 1.0,
) -> cs.Recording:
    """Recording of a bar that yields, to both sides of each peak in turn.

    Parameters
    ----------
    every : int
        So many-th reading is kept, whether or not a turning point is among the others.
    peaks_deg : sequence of float
        Largest angle of each cycle [deg].
    hardening_nm_per_deg : float
        Stiffness that is left beyond the yield point [N m/deg].
    torque_factor, angle_factor : float
        By what the readings are too large.

    Returns
    -------
    cyclosweep.Recording
    """
    rng = np.random.default_rng(11)
    path = [0.0, *(side * peak for peak in peaks_deg for side in (1.0, -1.0)), 0.0]
    steps = [max(2, round(50 * abs(b - a))) for a, b in pairwise(path)]
    angle = np.concatenate(
        [np.linspace(a, b, 13 * n)[:-1] for (a, b), n in zip(pairwise(path), steps, strict=True)]
    )
    slip, torque = np.zeros(len(YIELDS_DEG)), np.zeros(len(angle))
    for k, at in enumerate(angle):
        slip = np.clip(slip, at - YIELDS_DEG, at + YIELDS_DEG)
        torque[k] = ELASTIC_NM_PER_DEG * float(np.mean(at - slip)) + hardening_nm_per_deg * at
    rows = np.arange(7, len(angle), 13 * 5)[::every]
    torque = torque[rows] + rng.normal(0.0, 0.1, len(rows))
    return cs.Recording.from_arrays(
        torque * torque_factor, angle[rows] * angle_factor, side="output"
    )
