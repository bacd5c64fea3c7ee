"""The result of a diagnosis: its types, its JSON form and schema, and its statement in words."""

from cyclosweep.result.answer import SCHEMA, Answer, Finding, RunToRunDrift
from cyclosweep.result.calibration import (
    Baseline,
    CalibratedParameter,
    Counted,
    NoiseEstimate,
    Thinning,
)
from cyclosweep.result.change import DriveChange
from cyclosweep.result.effects import (
    BehaviourClass,
    Bound,
    EffectParameter,
    Explanation,
    FoundEffect,
    Hypothesis,
    Remainder,
    Size,
    Untestable,
)
from cyclosweep.result.json_form import answer_of, content_of, json_text
from cyclosweep.result.mismatch import Explained, Mismatch, Region
from cyclosweep.result.plausibility import Doubt
from cyclosweep.result.play_and_stiffness import PlayAndStiffness, Reading
from cyclosweep.result.proof import (
    Between,
    HeldOutBlock,
    LearnedError,
    NextExperiment,
    Repair,
    SelfCheck,
    Sufficiency,
)
from cyclosweep.result.verdict import Verdict

__all__ = [
    "SCHEMA",
    "Answer",
    "Baseline",
    "BehaviourClass",
    "Between",
    "Bound",
    "CalibratedParameter",
    "Counted",
    "Doubt",
    "DriveChange",
    "EffectParameter",
    "Explained",
    "Explanation",
    "Finding",
    "FoundEffect",
    "HeldOutBlock",
    "Hypothesis",
    "LearnedError",
    "Mismatch",
    "NextExperiment",
    "NoiseEstimate",
    "PlayAndStiffness",
    "Reading",
    "Region",
    "Remainder",
    "Repair",
    "RunToRunDrift",
    "SelfCheck",
    "Size",
    "Sufficiency",
    "Thinning",
    "Untestable",
    "Verdict",
    "answer_of",
    "content_of",
    "json_text",
]
