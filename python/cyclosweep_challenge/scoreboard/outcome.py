"""What the scoreboard keeps of one diagnosis: the figures that its checks and tables read."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any, Self

from cyclosweep.diagnosis.outcome import Diagnosis

FAILURE = "FAILURE"
"""Stands in place of a verdict where the diagnosis ended in an error."""


@dataclass(frozen=True)
class Outcome:
    """One diagnosis in short; None where the diagnosis says nothing.

    Attributes
    ----------
    verdict, statement : str
        As in ``diagnosis.json``.
    named : tuple of str
        Effects accepted by name.
    rows : int
        Readings of the recording.
    seconds : float
        Processor time of the diagnosis, one thread [s].
    share, share_low, share_high : float or None
        Share of the mismatch that the named effects explain, and its 95 % interval [-].
    noise_deg : float or None
        Standard deviation of the noise, as the diagnosis states it [deg].
    scale_calibrated, scale_repaired, scale_error : float or None
        Compliance over its nominal value before and after the repair, and the latter's standard
        error [-].
    play_deg : float or None
        Free play on each side after the repair [deg].
    rms_calibrated_deg, rms_repaired_deg : float or None
        Error on the readings that were fitted [deg].
    held_calibrated_deg, held_repaired_deg : float or None
        Error on readings that were not fitted [deg].
    stationary : bool or None
        Whether the diagnosis takes all runs for those of one drive.
    words : str
        All that the diagnosis says in words beside the statement: remainder, findings, what
        cannot be tested, notes.
    parameters : dict
        Estimates of the accepted effects' parameters, by ``effect.parameter``.
    figures : dict
        What the line itself measures on the recording and the repaired model.
    """

    verdict: str
    statement: str = ""
    named: tuple[str, ...] = ()
    rows: int = 0
    seconds: float = 0.0
    share: float | None = None
    share_low: float | None = None
    share_high: float | None = None
    noise_deg: float | None = None
    scale_calibrated: float | None = None
    scale_repaired: float | None = None
    scale_error: float | None = None
    play_deg: float | None = None
    rms_calibrated_deg: float | None = None
    rms_repaired_deg: float | None = None
    held_calibrated_deg: float | None = None
    held_repaired_deg: float | None = None
    stationary: bool | None = None
    words: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)
    figures: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, found: Diagnosis, seconds: float, figures: Mapping[str, float]) -> Self:
        """Take from a diagnosis what is kept of it.

        Parameters
        ----------
        found : Diagnosis
            The diagnosis.
        seconds : float
            Its processor time [s].
        figures : mapping
            Further figures of the line; those that are not finite are left out.
        """
        content = found.content
        explained = content.get("explained") or {}
        interval = explained.get("ci95") or (None, None)
        calibrated = content.get("baseline") or {}
        repaired = content.get("repaired") or {}
        effects = content.get("effects") or []
        return cls(
            verdict=found.verdict,
            statement=found.statement,
            named=tuple(str(each["name"]) for each in effects),
            rows=len(found.recording.torque_nm),
            seconds=round(seconds, 2),
            share=explained.get("share"),
            share_low=interval[0],
            share_high=interval[1],
            noise_deg=(content.get("noise") or {}).get("sigma_deg"),
            scale_calibrated=_parameter(calibrated, "compliance_scale"),
            scale_repaired=_parameter(repaired, "compliance_scale"),
            scale_error=_parameter(repaired, "compliance_scale", "std_error"),
            play_deg=_parameter(repaired, "free_play_deg"),
            rms_calibrated_deg=calibrated.get("rmse_deg"),
            rms_repaired_deg=repaired.get("rmse_deg"),
            held_calibrated_deg=calibrated.get("holdout_rmse_deg"),
            held_repaired_deg=repaired.get("holdout_rmse_deg"),
            stationary=content.get("stationary"),
            words=_words(content),
            parameters={
                f"{each['name']}.{name}": float(value["estimate"])
                for each in effects
                for name, value in (each.get("parameters") or {}).items()
            },
            figures={key: value for key, value in figures.items() if math.isfinite(value)},
        )

    @classmethod
    def from_dict(cls, content: Mapping[str, Any]) -> Self:
        """Read what `as_dict` wrote."""
        known = {f.name for f in fields(cls)}
        given = {key: value for key, value in content.items() if key in known}
        return cls(**{**given, "named": tuple(given.get("named", ()))})

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain data."""
        return asdict(self)

    @property
    def text(self) -> str:
        """All that the diagnosis says in words."""
        return f"{self.statement} {self.words}"


def _parameter(part: Mapping[str, Any], name: str, which: str = "estimate") -> float | None:
    """Estimate of a calibrated parameter, or its standard error."""
    value = ((part.get("parameters") or {}).get(name) or {}).get(which)
    return None if value is None else float(value)


def _words(content: Mapping[str, Any]) -> str:
    """Remainder, findings, untestable things and notes in one text."""
    unknown = content.get("unknown") or {}
    parts = [f"{unknown.get('shape', '')} {unknown.get('place', '')}".strip()]
    parts += [f"{f.get('topic')}: {f.get('text')}" for f in content.get("findings") or []]
    parts += [f"{u.get('name')}: {u.get('reason')}" for u in content.get("not_testable") or []]
    parts += [str(note) for note in content.get("notes") or []]
    return " | ".join(part for part in parts if part)
