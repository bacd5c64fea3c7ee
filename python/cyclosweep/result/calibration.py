"""Noise of the recording and the calibrated published model."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from cyclosweep.result.part import LEFT_OUT, Part

Counted = Literal["readings in contact", "whole loops"]
"""Which readings an error counts."""


@dataclass(frozen=True, kw_only=True, slots=True)
class NoiseEstimate(Part):
    """Noise of the measured angle, row by row where a recording was thinned."""

    sigma_deg: float | None = None
    """Standard deviation by the likeliest autocorrelation, rounding included [deg]."""
    autocorrelation: float | None = None
    """Correlation of neighbouring samples."""
    autocorrelation_upper: float | None = None
    """Upper estimate of that correlation, with which all tests are made; null where they count
    independent pieces of a loop instead, as what is left repeats itself along it."""
    white_share: float | None = None
    """Share of the variance that is new in every sample, beside a part that varies slowly; null
    where the noise is of one part."""
    tail_degrees_of_freedom: float | None = None
    """Degrees of freedom of Student's t where the noise has heavy tails; null where Gaussian."""
    resolution_deg: float | None = None
    """Step of the angle reading [deg]; 0 for a continuous one."""
    torque_nm: float | None = None
    """Standard deviation of the noise of the torque that was smoothed before anything was fitted
    [N m]; 0 where none is seen."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Thinning(Part):
    """How a long recording was thinned to the rows that were fitted."""

    samples: int
    """Number of samples in the recording."""
    rows: int
    """Number of rows that they became."""
    averaged: int
    """Usual number of neighbouring samples averaged in a row; 1: none were averaged."""
    every: int
    """One of this many of these rows was taken; 1: all of them."""
    sample_sigma_deg: float | None = None
    """Standard deviation of the noise of one sample [deg]; that of a row is under ``noise``."""
    sample_autocorrelation: float | None = None
    """Correlation of the noise of neighbouring samples."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CalibratedParameter(Part):
    """One parameter of the published model, against its nominal value."""

    nominal: float | None = None
    """Value by the drive file."""
    estimate: float
    """Value that fits the recording."""
    std_error: float | None = None
    """Standard error of the estimate; null where the recording does not determine it."""
    unit: str = ""
    """Unit of nominal value, estimate and standard error."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Baseline(Part):
    """The published model with stiffness, free play and datum calibrated, and nothing added."""

    parameters: Mapping[str, CalibratedParameter] = field(default_factory=dict)
    """Calibrated parameters by name."""
    rmse_deg: float | None = None
    """Root mean square error on the fitted data [deg]."""
    holdout_rmse_deg: float | None = None
    """Root mean square error on data that were not fitted [deg]; 0 where it was not computed."""
    counted: Counted | None = field(default=None, metadata=LEFT_OUT)
    """Which readings the errors count, before and after the repair: those in contact, each on the
    flank that the recording shows; or those of whole loops, on the way through the play too, where
    the simulation finds the flank for itself and a crossing that comes early or late costs the
    whole play. Errors of one kind are not comparable with those of the other."""
