"""One recording's answer beside its diagnosis, as the campaign counts it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from cyclosweep_challenge.campaign.unseen import Unseen, unseen_of
from cyclosweep_challenge.rig.specimen import VOCABULARY
from cyclosweep_challenge.runner.stages import held_out_ratio
from cyclosweep_challenge.scoring.outcome import HeldOut, Outcome, make_outcome

BEHAVIOUR = {
    "friction_hysteresis": "loop",
    "load_dependent_friction": "loop that opens with the load",
    "viscous_drag": "loop that opens with the rate",
    "contact_stiffening": "odd curve",
    "clearance_takeup": "odd curve",
    "overload_softening": "odd curve",
    "load_asymmetry": "even curve",
    "dial_eccentricity": "curve of the reading",
    "creep": "relaxation",
    "transmission_error": "periodic in the position",
    "phase_dependent_compliance": "periodic in the position",
    "datum_drift": "moving zero",
    "thermal_drift": "follows the temperature",
}
"""Class of behaviour that each name of the vocabulary stands for."""
NAMING = frozenset({"IDENTIFIED", "MOSTLY_EXPLAINED"})
"""Verdicts that say which effects are at work."""
HUNDREDTH = 0.01
"""Visibility over that of the dominant effect above which a second one has to be named [-]."""
MODEL_ERROR = 0.15
"""Rms over that of a foreign friction above which a second effect exceeds what a law of another
family leaves of it: fitted friction left 4 to 13 % of such loops (design notes) [-]."""


@dataclass(frozen=True)
class Cause:
    """What is at work.

    Attributes
    ----------
    name, kind : str
        Name, and whether it is an ``effect``, an ``alien`` or an ``alias``.
    d : float
        Signal-to-noise with only the calibration taken out [-].
    rms_deg : float
        Size after calibration [deg].
    """

    name: str
    kind: str
    d: float
    rms_deg: float


@dataclass(frozen=True)
class Result:
    """One diagnosis beside its answer.

    Attributes
    ----------
    part : str
        Part of the campaign.
    outcome : Outcome
        What the first records score.
    causes : tuple of Cause
        What is at work, aliases left out.
    friction_family : str
        ``library`` or ``other`` where friction is dominant, else empty.
    unseen : Unseen
        What the repaired model removes on the second programme.
    """

    part: str
    outcome: Outcome
    causes: tuple[Cause, ...]
    friction_family: str
    unseen: Unseen

    @property
    def names(self) -> frozenset[str]:
        """Names that were accepted, under any verdict."""
        return frozenset(self.outcome.named)

    @property
    def right(self) -> bool:
        """Whether the verdict names effects, exactly those at work."""
        at_work = {cause.name for cause in self.causes}
        return self.outcome.verdict in NAMING and self.names == at_work

    @property
    def false_name(self) -> bool:
        """Whether a name of the vocabulary was accepted that is not at work."""
        return bool(self.names & set(VOCABULARY) - {cause.name for cause in self.causes})

    @property
    def false_class(self) -> bool:
        """Whether a name was accepted that stands for another class than all that is at work."""
        at_work = {BEHAVIOUR.get(cause.name) for cause in self.causes}
        return any(BEHAVIOUR[name] not in at_work for name in self.names & set(VOCABULARY))

    @property
    def dominant(self) -> Cause | None:
        """Most visible cause."""
        return max(self.causes, key=lambda cause: cause.d, default=None)

    @property
    def alien_d(self) -> float:
        """Visibility of the cause on nobody's list; zero without one [-]."""
        return max((cause.d for cause in self.causes if cause.kind == "alien"), default=0.0)

    @property
    def dominant_named(self) -> bool:
        """Whether the most visible cause was accepted by its name."""
        return self.dominant is not None and self.dominant.name in self.names

    @property
    def all_visible_named(self) -> bool:
        """Whether each cause above a hundredth of the dominant one was named, and nothing false."""
        first = self.dominant
        least = HUNDREDTH * first.d if first else 0.0
        return not self.false_name and all(
            c.name in self.names for c in self.causes if c.d >= least
        )

    @property
    def all_beyond_model_error_named(self) -> bool:
        """Whether the dominant cause and what exceeds its model error were named, nothing false."""
        first = self.dominant
        if first is None or self.false_name:
            return False
        least = MODEL_ERROR * first.rms_deg
        wanted = {first.name} | {c.name for c in self.causes if c.rms_deg >= least}
        return wanted <= self.names

    @property
    def right_or_insufficient(self) -> bool:
        """Whether the verdict is right, or says that the readings cannot tell."""
        if self.outcome.verdict == "INSUFFICIENT_DATA":
            return True
        if not self.causes:
            return self.outcome.verdict == "NOTHING_MISSING"
        return self.right


def make_result(
    part: str, answer: dict[str, Any], diagnosis: dict[str, Any], prediction: Path
) -> Result:
    """Lay a diagnosis beside its answer.

    Parameters
    ----------
    part : str
        Part of the campaign.
    answer : dict
        The opened answer.
    diagnosis : dict
        The diagnosis as it was kept.
    prediction : pathlib.Path
        CSV of the repaired model's prediction; it may be absent.
    """
    visible = [cause for cause in answer["causes"] if cause["kind"] != "alias"]
    for cause in visible:
        cause.setdefault("oracle_z", math.nan)
    held_out = HeldOut()
    if diagnosis.get("verdict") == "IDENTIFIED" and "held_out_clean_deg" in answer:
        held_out = held_out_ratio(answer, prediction)
    outcome = make_outcome(answer, diagnosis, held_out)
    return Result(
        part,
        replace(outcome, key=f"{part}/{outcome.key}"),
        tuple(_cause(cause) for cause in visible),
        str(answer.get("friction_family", "")),
        unseen_of(answer, prediction),
    )


def _cause(cause: Mapping[str, Any]) -> Cause:
    """Cause of an answer."""
    return Cause(cause["name"], cause["kind"], float(cause["d_alone"]), float(cause["rms_deg"]))
