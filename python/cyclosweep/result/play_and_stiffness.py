"""Free play, stiffness and friction of the measured loop: one value each, by one definition."""

from dataclasses import dataclass, field

from cyclosweep.result.part import LEFT_OUT, Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Reading(Part):
    """A value that is read from the loop, with its interval."""

    estimate: float
    """Mean over the runs."""
    ci95: tuple[float, float] | None = None
    """Interval that holds the value with 95 % confidence; null for a single run."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PlayAndStiffness(Part):
    """The free play and the stiffness of the drive, read from the loop itself.

    They are the distance of the straight lines through both flanks at zero torque, and the slope of
    these lines, each line being the mean of the rising and the falling branch.
    """

    definition: str = ""
    """How the values were read."""
    runs: int = 0
    """Number of runs that they were read from; 0 where the published model was fitted to all."""
    free_play_deg: Reading | None = None
    """Whole free play at the measured shaft, from one flank to the other [deg]."""
    free_play_at_output_deg: Reading | None = None
    """The same at the output shaft [deg]."""
    compliance_deg_per_nm: Reading | None = None
    """Compliance at the measured shaft [deg/(N m)]."""
    stiffness_at_output_nm_per_arcmin: Reading | None = None
    """Stiffness at the output shaft [N m/arcmin]."""
    friction_nm: Reading | None = None
    """Half the width of the loop in torque at equal angle, at the measured shaft [N m]."""
    reason: str | None = field(default=None, metadata=LEFT_OUT)
    """Why a value is missing."""
