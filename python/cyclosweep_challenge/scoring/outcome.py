"""One case's answer beside its diagnosis, as one flat row."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

from scipy.stats import norm

from cyclosweep_challenge.rig.specimen import VOCABULARY

ALARMS = frozenset({"IDENTIFIED", "AMBIGUOUS", "MOSTLY_EXPLAINED", "UNKNOWN_PHYSICS"})


@dataclass(frozen=True)
class HeldOut:
    """Held-out error of a repaired model over that of the true one.

    Attributes
    ----------
    known : float
        Over the true model's with its true parameters [-].
    fitted : float
        Over the true model's with parameters fitted to the same recording [-].
    """

    known: float = math.nan
    fitted: float = math.nan


@dataclass(frozen=True)
class Sized:
    """Size of a rightly named effect.

    Attributes
    ----------
    name : str
        The effect.
    true_deg, estimate_deg, low_deg, high_deg : float
        True largest value after re-calibration, its estimate and 95 % interval [deg].
    true_rms_deg, estimate_rms_deg : float
        True root mean square after re-calibration, and its estimate [deg].
    d : float
        Signal-to-noise; the Cramer-Rao bound of the rms is ``true_rms_deg / d`` [-].
    """

    name: str
    true_deg: float
    estimate_deg: float
    low_deg: float
    high_deg: float
    true_rms_deg: float
    estimate_rms_deg: float
    d: float

    @property
    def error(self) -> float:
        """Error of the rms over its Cramer-Rao bound [-]; not-a-number where none is stated."""
        return (self.estimate_rms_deg - self.true_rms_deg) / (self.true_rms_deg / self.d)


@dataclass(frozen=True)
class Outcome:
    """What is scored of one case.

    Attributes
    ----------
    key, stratum, tier, programme, noise : str
        The case.
    causes, effects, aliens, aliases : tuple of str
        What is at work: all visible causes, and by kind.
    removed : str
        Effect taken out of the library; empty for none.
    d : float
        Smallest d among the visible causes; zero with none [-].
    oracle_z : float
        Statistic of the test that knows the least visible cause [-].
    verdict : str
        Verdict of the diagnosis; ``FAILURE`` where it gave none.
    named : tuple of str
        Effects it accepted by name.
    explanations : tuple of (tuple of str, float)
        Its explanation set with probabilities.
    untestable : tuple of str
        What it called not testable.
    p_mismatch : float
        Its p-value that something is missing.
    sizes : tuple of Sized
        Sizes of the effects rightly named.
    pulls : dict
        Departure of repaired calibration parameters in their standard errors.
    held_out : HeldOut
        Held-out error over that of the true model; not-a-number where nothing was predicted.
    elapsed_s : float
        Time of the diagnosis [s].
    failure : str
        What went wrong, if something did.
    rivals : dict
        Overlap of the first cause's signature with that of every other effect.
    excess : float
        Its evidence that something is missing over its own threshold [nat]; minus infinity
        where it stated none.
    """

    key: str
    stratum: str
    tier: str
    programme: str
    noise: str
    causes: tuple[str, ...]
    effects: tuple[str, ...]
    aliens: tuple[str, ...]
    aliases: tuple[str, ...]
    removed: str
    d: float
    oracle_z: float
    verdict: str
    named: tuple[str, ...]
    explanations: tuple[tuple[tuple[str, ...], float], ...]
    untestable: tuple[str, ...]
    p_mismatch: float
    sizes: tuple[Sized, ...]
    pulls: dict[str, float]
    held_out: HeldOut
    elapsed_s: float
    failure: str
    rivals: dict[str, float] = field(default_factory=dict)
    excess: float = -math.inf

    @property
    def alarm(self) -> bool:
        """Whether something was said to be missing."""
        return self.verdict in ALARMS

    @property
    def named_right(self) -> bool:
        """Whether exactly the true set was identified."""
        return self.verdict == "IDENTIFIED" and set(self.named) == set(self.causes)

    @property
    def naming_bound(self) -> float:
        """Chance that a test of the true effect against its nearest rival would be right [-].

        For two known signatures of projected cosine c it is Phi(d sqrt((1 - c) / 2)).
        """
        nearest = max(self.rivals.values(), default=0.0)
        return float(norm.cdf(self.d * math.sqrt(max(0.0, 0.5 * (1.0 - nearest)))))

    @property
    def covered(self) -> bool:
        """Whether the explanation set holds the true set."""
        return any(set(names) == set(self.causes) for names, _ in self.explanations)

    @property
    def false_names(self) -> tuple[str, ...]:
        """Names of the vocabulary accepted though they are not at work."""
        return tuple(n for n in self.named if n in VOCABULARY and n not in self.causes)

    @property
    def recognised(self) -> bool:
        """Whether an unknown cause was called unknown, or by no more than its class."""
        known = {n for n in self.named if n in VOCABULARY}
        if known - set(self.effects):
            return False
        mentioned = set(self.named) | {name for names, _ in self.explanations for name in names}
        class_only = self.alarm and bool(mentioned) and not mentioned & set(VOCABULARY)
        return self.verdict == "UNKNOWN_PHYSICS" or class_only


def _number(value: Any) -> float:
    """Float of a JSON number; not-a-number for anything else."""
    return float(value) if isinstance(value, (int, float)) else math.nan


def _sizes(truth: dict[str, Any], diagnosis: dict[str, Any]) -> tuple[Sized, ...]:
    """Sizes of the effects that were named and are at work."""
    true = {c["name"]: c for c in truth["causes"] if c["kind"] == "effect"}
    found = []
    for effect in diagnosis.get("effects") or []:
        size = effect.get("size_deg") or {}
        bounds = size.get("ci95") or [None, None]
        if effect.get("name") in true:
            cause = true[effect["name"]]
            found.append(
                Sized(
                    effect["name"],
                    cause["peak_deg"],
                    _number(size.get("estimate")),
                    _number(bounds[0]),
                    _number(bounds[1]),
                    cause["rms_deg"],
                    _number(effect.get("rms_deg")),
                    cause["d"],
                )
            )
    return tuple(found)


def _pulls(truth: dict[str, Any], diagnosis: dict[str, Any]) -> dict[str, float]:
    """Departure of each repaired calibration parameter from its true value, in standard errors."""
    repaired = (diagnosis.get("repaired") or {}).get("parameters") or {}
    pulls = {}
    for name, value in truth["calibration"].items():
        entry = repaired.get(name)
        if isinstance(entry, dict):
            estimate, error = _number(entry.get("estimate")), _number(entry.get("std_error"))
            if error > 0.0:
                pulls[name] = (estimate - value) / error
    return pulls


def make_outcome(truth: dict[str, Any], diagnosis: dict[str, Any], held_out: HeldOut) -> Outcome:
    """Score one diagnosis by its answer.

    Parameters
    ----------
    truth : dict
        The opened answer.
    diagnosis : dict
        The diagnosis as read from ``diagnosis.json``, or ``{"failure": message}``.
    held_out : HeldOut
        Held-out error over that of the true model [-].
    """
    visible = [c for c in truth["causes"] if c["kind"] != "alias"]
    least = min(visible, key=lambda c: c["d"], default=None)
    explanations = tuple(
        # A part without a name keeps an explanation from being the true set of named effects.
        (
            tuple(sorted([*(e.get("effects") or []), *(e.get("without_name") or [])])),
            _number(e.get("probability")),
        )
        for e in diagnosis.get("explanation_set") or []
    )
    mismatch = diagnosis.get("mismatch") or {}
    excess = _number(mismatch.get("evidence")) - _number(mismatch.get("threshold"))
    return Outcome(
        key=truth["key"],
        stratum=truth["stratum"],
        tier=truth["tier"],
        programme=truth["programme"],
        noise=truth["noise"]["family"],
        causes=tuple(c["name"] for c in visible),
        effects=tuple(truth["effects"]),
        aliens=tuple(truth["aliens"]),
        aliases=tuple(truth["aliases"]),
        removed=truth.get("removed", ""),
        d=float(least["d"]) if least else 0.0,
        oracle_z=float(least["oracle_z"]) if least else math.nan,
        verdict=str(diagnosis.get("verdict", "FAILURE")),
        named=tuple(str(e.get("name")) for e in diagnosis.get("effects") or []),
        explanations=explanations,
        untestable=tuple(str(e.get("name")) for e in diagnosis.get("not_testable") or []),
        p_mismatch=_number(mismatch.get("p_value")),
        sizes=_sizes(truth, diagnosis),
        pulls=_pulls(truth, diagnosis),
        held_out=held_out,
        elapsed_s=_number(diagnosis.get("challenge_elapsed_s")),
        failure=str(diagnosis.get("failure", "")),
        rivals=truth.get("rivals", {}),
        excess=excess if math.isfinite(excess) else -math.inf,
    )
