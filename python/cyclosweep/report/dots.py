"""The dots of a residual panel: samples, or means of neighbours where the diagnosis averaged."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cyclosweep.report.data import ReportData
from cyclosweep.report.regions import located
from cyclosweep.report.residual_scale import MAY_BE_IN_PLAY_SHARE, scale_deg
from cyclosweep.report.thin import DISPLAY_LIMIT

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ResidualDots:
    """What a residual panel draws.

    Attributes
    ----------
    x : ndarray of float, shape (k,)
        Place on the panel's axis.
    before_deg, after_deg : ndarray of float, shape (k,)
        Residual of the calibrated published model and of the repaired one [deg].
    located : ndarray of bool, shape (k,)
        Whether a dot lies where simulation and recording were found to differ.
    sigma_deg : float
        Standard deviation of the noise of a dot [deg].
    averaged : int
        Neighbouring samples in a dot.
    limit_deg : float
        Residual that the axis ends at [deg].
    """

    x: Floats
    before_deg: Floats
    after_deg: Floats
    located: Mask
    sigma_deg: float
    averaged: int
    limit_deg: float


def residual_dots(data: ReportData, shown: NDArray[np.int64], x: Floats) -> ResidualDots:
    """Dots of the residual before and after over one axis.

    Parameters
    ----------
    data : ReportData
        Recording with both residuals.
    shown : ndarray of int
        Scored samples to draw where none are averaged.
    x : ndarray of float, shape (n,)
        Value on the axis of every sample.
    """
    before, after = data.residual_before_deg, data.residual_after_deg
    assert before is not None
    assert after is not None
    torque, inside = data.recording.torque_nm, located(data)
    sigma, _ = data.noise
    thinning, averaged = data.result.thinning, 1
    if thinning is not None and thinning.averaged > 1 and data.result.noise.sigma_deg:
        averaged, sigma = thinning.averaged, data.result.noise.sigma_deg
        mean = _means_of_neighbours(data, averaged)
        x, before, after, torque = (mean(values) for values in (x, before, after, torque))
        inside = mean(inside.astype(np.float64)) > 0.5
    else:
        x, before, after, torque = (values[shown] for values in (x, before, after, torque))
        inside = inside[shown]
    limit = max(scale_deg(torque, before), scale_deg(torque, after), 2 * sigma, 1e-9)
    return ResidualDots(
        x=x,
        before_deg=before,
        after_deg=after,
        located=inside,
        sigma_deg=sigma,
        averaged=averaged,
        limit_deg=1.2 * limit,
    )


def _means_of_neighbours(data: ReportData, averaged: int) -> Callable[[Floats], Floats]:
    """Return what averages a quantity over neighbours of one branch and side of the dead zone."""
    recording = data.recording
    rows = np.flatnonzero(data.scored & ~data.on_the_way_through)
    torque = recording.torque_nm[rows]
    light = np.abs(torque) <= MAY_BE_IN_PLAY_SHARE * float(np.abs(torque).max())
    kinds = (recording.run[rows], recording.structure.loading[rows], np.sign(torque), light)
    changes = np.zeros(len(rows), dtype=bool)
    for kind in kinds:
        changes[1:] |= kind[1:] != kind[:-1]
    starts = np.flatnonzero(np.r_[True, changes[1:]]) if len(rows) else np.zeros(0, dtype=np.int64)
    lengths = np.diff(np.r_[starts, len(rows)])
    place = np.arange(len(rows)) - np.repeat(starts, lengths)
    new = np.r_[True, changes[1:]] | (place % averaged == 0)
    label = np.cumsum(new) - 1
    counts = np.bincount(label)
    whole = np.flatnonzero(counts >= averaged // 2 + 1)
    whole = whole[:: -(-len(whole) // DISPLAY_LIMIT) or 1]

    def mean(values: Floats) -> Floats:
        means: Floats = np.bincount(label, values[rows])[whole] / counts[whole]
        return means

    return mean


def dot_size(samples: int) -> float:
    """Radius of a dot [px]: the fewer, the larger."""
    return 3.2 if samples <= 100 else 2.0 if samples <= 600 else 1.3
