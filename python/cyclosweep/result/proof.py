"""Whether the repaired model holds: what is left, data not used, synthetic twins, what to test."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from cyclosweep.result.calibration import CalibratedParameter
from cyclosweep.result.part import LEFT_OUT, Part

Between = Literal["runs", "passes", "loads"]
"""Between what an error repeats: runs, passes of one run, neighbouring loads of a single pass."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sufficiency(Part):
    """Whether the accepted effects leave anything beyond noise."""

    p_value: float | None = None
    """Probability of as large a remainder by noise, what has no name taken out as well; null where
    the residual is model error."""
    residual_repeats_between_runs: float | None = field(default=None, metadata=LEFT_OUT)
    """Correlation of the residuals of two runs, where the residual is model error."""
    cells: int | None = field(default=None, metadata=LEFT_OUT)
    """Number of places at which the two runs were compared."""


@dataclass(frozen=True, kw_only=True, slots=True)
class HeldOutBlock(Part):
    """Errors on one block of data that was not fitted.

    Where the model forecasts whole loops, crossings of the dead zone included, three errors are
    given: over all samples; over samples in contact with the flank taken from the recording
    (``told_...``); and the distance to the predicted curve (``near_...``).
    """

    block: str
    """Which data."""
    samples: int | None = None
    """How many readings."""
    before_deg: float
    """Error of the calibrated published model [deg]."""
    after_deg: float
    """Error of the repaired model [deg]."""
    told_before_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Error of the published model with the flank taken from the recording [deg]."""
    told_after_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Error of the repaired model with the flank taken from the recording [deg]."""
    near_before_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Root mean square distance to the curve of the published model [deg]."""
    near_after_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Root mean square distance to the curve of the repaired model [deg]."""
    floor_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Error that an earlier run leaves as a prediction of this one [deg]."""

    @property
    def is_forecast(self) -> bool:
        """Whether the model had to find the flank in contact by itself."""
        return self.told_after_deg is not None


@dataclass(frozen=True, kw_only=True, slots=True)
class LearnedError(Part):
    """What the effects of a repaired model miss at the same state of load: a table of the model."""

    rms_deg: float
    """Root mean square of the table over the fitted readings [deg]."""
    repeats: float
    """Share of the variance of what the effects miss that is the same in another of ``between``."""
    between: Between
    """Whether it was found between runs, between passes of one run, or, from a single pass, between
    neighbouring loads."""
    compared: int
    """Most runs or passes of the same loads."""
    holdout_rmse_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """Root mean square error on runs that were held out, crossings of the play included [deg]."""
    holdout_without_deg: float | None = field(default=None, metadata=LEFT_OUT)
    """The same without the table [deg]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Repair(Part):
    """The published model with the accepted effects added and calibrated again."""

    parameters: Mapping[str, CalibratedParameter] = field(default_factory=dict)
    """Calibrated parameters by name."""
    rmse_deg: float | None = None
    """Root mean square error of the effects on the fitted data [deg]."""
    holdout_rmse_deg: float | None = None
    """Root mean square error of the effects on data that were not fitted [deg]; 0 where it was not
    computed. What ``model_error`` adds is not in it."""
    holdout: str = ""
    """What was held out."""
    blocks: tuple[HeldOutBlock, ...] = ()
    """Errors block by block."""
    stand_ins: tuple[str, ...] = ()
    """Effects of the repaired model that are not named: their laws were not found to hold, and
    stand in for others of their class."""
    model_error: LearnedError | None = field(default=None, metadata=LEFT_OUT)
    """What they miss at the same state of load, where that is known."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SelfCheck(Part):
    """What the diagnosis says of synthetic recordings with this programme and known causes."""

    false_alarm: float | None = None
    """Share in which something is said to be missing though nothing is."""
    power: float | None = None
    """Share in which the named effect is noticed; the smallest of several."""
    confusion: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Effect that is there -> what comes out on top -> share."""
    twins: int | None = None
    """Number of synthetic recordings of each kind."""


@dataclass(frozen=True, kw_only=True, slots=True)
class NextExperiment(Part):
    """The load programme that would tell most."""

    program: str = ""
    """What to do."""
    separates: tuple[str, ...] = ()
    """Explanations that it separates, or the effect that it shows or rules out."""
    detectability: float | None = None
    """Expected signal-to-noise ratio of what separates them."""
    minutes: int | None = None
    """How long it takes."""
    loads_nm: tuple[float, ...] = ()
    """Torques at the measured shaft between which the load is ramped, in order [N m]."""
    rig_programme: str = ""
    """Programme of ``examples/rigs`` for such a rig, to start from."""
