"""What a report is made of: the recording, what was predicted, the tables behind the verdict."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep.recording import Recording

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Hypothesis:
    """One effect of the library, as it fared.

    Attributes
    ----------
    name : str
        Name in the vocabulary of effects.
    outcome : str
        ``accepted``, ``ruled out``, ``undecided`` or ``not testable``.
    absorbed_share : float or None
        Share of its signature that a refitted baseline hides.
    size_deg, ci95_deg : float, (float, float), or None
        Size of the effect [deg] and its 95 % interval.
    p_value, e_value : float or None
        Evidence of the scan and of the held-out data.
    smallest_detectable_deg : float or None
        Size that this recording would show [deg].
    """

    name: str
    outcome: str
    absorbed_share: float | None = None
    size_deg: float | None = None
    ci95_deg: tuple[float, float] | None = None
    p_value: float | None = None
    e_value: float | None = None
    smallest_detectable_deg: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldOut:
    """Errors on one block of data that was not used.

    Attributes
    ----------
    block : str
        Which samples.
    samples : int
        How many.
    rmse_before_deg, rmse_after_deg : float
        Error of the published model and of the repaired one [deg].
    floor_deg : float or None
        What noise or replicates leave [deg].
    told_before_deg, told_after_deg : float or None
        Where the errors are of a forecast: those of the same models told the flank in contact.
    near_before_deg, near_after_deg : float or None
        Where they are: root mean square distance to the predicted curve.
    """

    block: str
    samples: int
    rmse_before_deg: float
    rmse_after_deg: float
    floor_deg: float | None = None
    told_before_deg: float | None = None
    told_after_deg: float | None = None
    near_before_deg: float | None = None
    near_after_deg: float | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class ReportData:
    """Everything a report shows.

    Attributes
    ----------
    recording : Recording
        What was measured.
    result : mapping
        Content of ``diagnosis.json``.
    before_deg, after_deg : ndarray of float, shape (n,), or None
        Angle by the calibrated published model and by the repaired model [deg]; None where there
        is nothing to predict from.
    rated_torque_nm : float or None
        Rated torque at the measured shaft [N m].
    ratio : float or None
        Reduction of the drive.
    compliance_deg_per_nm : float or None
        Calibrated compliance at the measured shaft, to express sizes in N m.
    hypotheses : tuple of Hypothesis
        Rows of the hypothesis table.
    held_out : tuple of HeldOut
        Rows of the held-out table.
    provenance : mapping of str to str
        Hashes, versions, seeds.
    """

    recording: Recording
    result: Mapping[str, Any]
    before_deg: Floats | None = None
    after_deg: Floats | None = None
    rated_torque_nm: float | None = None
    ratio: float | None = None
    compliance_deg_per_nm: float | None = None
    hypotheses: tuple[Hypothesis, ...] = ()
    held_out: tuple[HeldOut, ...] = ()
    provenance: Mapping[str, str] = field(default_factory=dict)

    @property
    def residual_before_deg(self) -> Floats | None:
        """Measured minus predicted by the published model [deg]."""
        return self._residual(self.before_deg)

    @property
    def residual_after_deg(self) -> Floats | None:
        """Measured minus predicted by the repaired model [deg]."""
        return self._residual(self.after_deg)

    @property
    def is_repaired(self) -> bool:
        """Whether the repaired model differs from the published one."""
        return bool(self.result.get("effects"))

    @property
    def scored(self) -> NDArray[np.bool_]:
        """Samples that count: all but conditioning runs and those beyond the limits of [score]."""
        return self.recording.counts

    @property
    def noise(self) -> tuple[float, float]:
        """Standard deviation [deg] and lag-one autocorrelation of the noise."""
        told: Mapping[str, Any] = self.result.get("noise") or {}
        sigma, rho = told.get("sigma_deg"), told.get("autocorrelation")
        if not isinstance(sigma, int | float) or not np.isfinite(sigma) or sigma <= 0:
            residual = self.residual_after_deg
            sigma = 0.0 if residual is None else 1.4826 * float(np.median(np.abs(residual)))
        known = isinstance(rho, int | float) and bool(np.isfinite(rho))
        return float(sigma), float(rho or 0.0) if known else 0.0

    def _residual(self, predicted: Floats | None) -> Floats | None:
        measured = self.recording.angle_deg
        return None if predicted is None or measured is None else measured - predicted
