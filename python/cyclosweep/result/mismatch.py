"""Where recording and model differ."""

from dataclasses import dataclass, field
from typing import Literal

from cyclosweep.result.part import LEFT_OUT, Part

Direction = Literal["loading", "unloading", "both"]


@dataclass(frozen=True, kw_only=True, slots=True)
class Region(Part):
    """A part of the recording whose mean residual is not noise.

    Ranges are [from, to]; null where the region is not limited in that respect.
    """

    torque_nm: tuple[float, float] | None = None
    """Range of torque [N m]."""
    direction: Direction | None = None
    """Whether the torque grows in size there, falls, or both."""
    run: tuple[int, int] | None = None
    """First and last run, numbered as in the recording."""
    time_s: tuple[float, float] | None = None
    """Range of time [s]."""
    readings: tuple[int, int] | None = field(default=None, metadata=LEFT_OUT)
    """First and last reading, counted from 1, where there is no clock."""
    crank_deg: tuple[float, float] | None = None
    """Range of the mesh position [deg]."""
    temperature_c: tuple[float, float] | None = None
    """Temperatures that were read there [degC]."""
    repaired: bool = False
    """Whether the repaired model is off there, as the named effects leave it; else the calibrated
    one, before the repair."""
    mean_residual_deg: float
    """Mean of measured less modelled twist [deg]."""
    share_of_excess: float | None = None
    """Share of the mean square residual beyond noise that the mean of this region makes up, without
    the rows of the regions before it."""
    p_value: float | None = None
    """Probability of as large a mean anywhere by noise alone."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Mismatch(Part):
    """Global test of the calibrated model, and the regions in which it fails."""

    p_value: float | None = None
    """Probability of as large a mismatch where nothing is missing from the model."""
    evidence: float | None = None
    """Largest log evidence of any hypothesis beyond what it reaches by chance."""
    threshold: float | None = None
    """Evidence from which something is said to be missing."""
    regions: tuple[Region, ...] = ()
    """Regions, the strongest first, each after the ones before are taken out."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Explained(Part):
    """How much of the mismatch the accepted effects explain."""

    share: float | None = None
    """Share of the mean square difference beyond the noise; null where there is none."""
    ci95: tuple[float, float] | None = None
    """95 % interval of the share."""
