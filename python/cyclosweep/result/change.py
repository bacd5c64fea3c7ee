"""Change of the drive while it was tested."""

from dataclasses import dataclass

from cyclosweep.result.part import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveChange(Part):
    """How far the compliance moved over the recording, the load history being the same."""

    compliance_early_deg_per_nm: float
    """Compliance at the first sweep that was compared [deg/(N m)]."""
    compliance_late_deg_per_nm: float
    """Compliance at the last one [deg/(N m)]."""
    share: float
    """Late compliance over the early one, less one."""
    ci95: tuple[float, float]
    """Interval that holds the share with 95 % confidence."""
    p_value: float
    """Share of random orders of equal sweeps with as large a trend."""
    sweeps: int
    """Number of sweeps between reversals that were compared."""
