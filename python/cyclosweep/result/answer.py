"""The whole answer of a diagnosis: the content of ``diagnosis.json`` as one typed value."""

from dataclasses import dataclass, field
from typing import Literal

from cyclosweep.result.calibration import Baseline, NoiseEstimate, Thinning
from cyclosweep.result.change import DriveChange
from cyclosweep.result.effects import (
    BehaviourClass,
    Bound,
    Explanation,
    FoundEffect,
    Remainder,
    Untestable,
)
from cyclosweep.result.mismatch import Explained, Mismatch
from cyclosweep.result.part import EMPTY, LEFT_OUT, Part
from cyclosweep.result.plausibility import Doubt
from cyclosweep.result.play_and_stiffness import PlayAndStiffness
from cyclosweep.result.proof import NextExperiment, Repair, SelfCheck, Sufficiency
from cyclosweep.result.verdict import Verdict

Schema = Literal["cyclosweep.diagnosis/1"]
SCHEMA: Schema = "cyclosweep.diagnosis/1"
"""Name and version of the form of ``diagnosis.json``."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Finding(Part):
    """One thing that a measured loop shows, in the words of a gear test."""

    topic: str
    """What it is about."""
    text: str
    """What is found."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RunToRunDrift(Part):
    """How far a model of some runs fails on others, where the drive changed between them."""

    own_deg: float
    """Root mean square error on the runs that the model was fitted to [deg]."""
    other_deg: float
    """Root mean square error on the others [deg]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Answer(Part):
    """What a diagnosis says of a recording."""

    schema: Schema = SCHEMA
    """Name and version of this form."""
    tolerance_deg: float | None = None
    """Size below which an effect does not matter [deg]."""
    verdict: Verdict
    """The conclusion."""
    statement: str = ""
    """One paragraph that an engineer can act on."""
    summary: str = ""
    """The same in one or two sentences."""
    do_now: str = ""
    """What to look at or to do first."""
    noise: NoiseEstimate = field(default_factory=NoiseEstimate)
    """How far the measured angle scatters."""
    thinning: Thinning | None = field(default=None, metadata=LEFT_OUT)
    """How a long recording was thinned; left out where every sample was used as it is."""
    baseline: Baseline = field(default_factory=Baseline)
    """The calibrated published model."""
    mismatch: Mismatch = field(default_factory=Mismatch)
    """Whether and where the calibrated published model and the recording differ."""
    plausibility: tuple[Doubt, ...] = ()
    """Calibrated values far from nominal, with the mistakes that would explain them."""
    explained: Explained = field(default_factory=Explained)
    """How much of that difference the accepted effects explain."""
    effects: tuple[FoundEffect, ...] = ()
    """Effects that were accepted by name, also where something unknown remains."""
    classes: tuple[BehaviourClass, ...] = ()
    """Classes of behaviour that the recording shows: those of named effects, then those that no law
    of the vocabulary stands for."""
    explanation_set: tuple[Explanation, ...] = ()
    """Explanations that fit, the most probable first, together at least 95 % probable."""
    ruled_out: tuple[Bound, ...] = ()
    """Effects whose upper bound is below the tolerance."""
    undecided: tuple[Bound, ...] = ()
    """Effects that were not found and may still be larger than the tolerance."""
    not_testable: tuple[Untestable, ...] = ()
    """What the recording cannot show."""
    sufficiency: Sufficiency = field(default_factory=Sufficiency)
    """What the accepted effects leave."""
    repaired: Repair = field(default_factory=Repair)
    """The repaired model."""
    self_check: SelfCheck | None = field(default=None, metadata=EMPTY)
    """Synthetic recordings with known causes; empty where it was not asked for."""
    next_experiment: NextExperiment | None = field(default=None, metadata=EMPTY)
    """The load programme that would tell most; empty where it was not asked for."""
    model: str | None = None
    """File of the repaired model, beside this one."""
    notes: tuple[str, ...] = ()
    """What was recognised in the recording when it was read."""
    unknown: Remainder | None = field(default=None, metadata=LEFT_OUT)
    """What is missing and belongs to no effect of the vocabulary."""
    stationary: bool | None = None
    """Whether all runs are of one drive; null where there is no diagnosis."""
    drift: RunToRunDrift | None = field(default=None, metadata=LEFT_OUT)
    """How far they are not."""
    play_and_stiffness: PlayAndStiffness | None = field(default=None, metadata=LEFT_OUT)
    """The free play, the stiffness and the friction of the drive; left out where nothing could be
    diagnosed."""
    change: DriveChange | None = field(default=None, metadata=LEFT_OUT)
    """How far the compliance moved while the drive was tested."""
    findings: tuple[Finding, ...] = ()
    """What the measured loops show, where whole loops were fitted."""
