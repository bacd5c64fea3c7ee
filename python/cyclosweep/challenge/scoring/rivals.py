"""The opponents' power, at their defaults and at one false alarm in a hundred."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cyclosweep.challenge.scoring.intervals import Estimate, share_of
from cyclosweep.challenge.scoring.outcome import Outcome
from cyclosweep.challenge.scoring.power import d_for_power

LEVEL = 0.01


@dataclass(frozen=True)
class OpponentCurve:
    """One opponent on one programme.

    Attributes
    ----------
    who, programme : str
        The opponent and the programme.
    default_alarms : Estimate
        False alarms at its defaults, on recordings with nothing missing and white noise.
    threshold : float
        Statistic exceeded by one in a hundred of those recordings, in the opponent's units.
    tuned_alarms : Estimate
        False alarms at that threshold, on the same recordings.
    needed : Estimate
        Visibility for 90 % power at that threshold; beyond 20, none is to be read from it [-].
    default_power, tuned_power, tuned_naming : tuple of (float, Estimate)
        Visibility and share found, or named right, at defaults and at that threshold; naming
        is empty for opponents that name nothing.
    """

    who: str
    programme: str
    default_alarms: Estimate
    threshold: float
    tuned_alarms: Estimate
    needed: Estimate
    default_power: tuple[tuple[float, Estimate], ...]
    tuned_power: tuple[tuple[float, Estimate], ...]
    tuned_naming: tuple[tuple[float, Estimate], ...]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""

        def listed(points: tuple[tuple[float, Estimate], ...]) -> list[dict[str, Any]]:
            return [{"d": d, **vars(e)} for d, e in points]

        return {
            "who": self.who,
            "programme": self.programme,
            "default_alarms": vars(self.default_alarms),
            "threshold": self.threshold,
            "tuned_alarms": vars(self.tuned_alarms),
            "needed": vars(self.needed),
            "default_power": listed(self.default_power),
            "tuned_power": listed(self.tuned_power),
            "tuned_naming": listed(self.tuned_naming),
        }


def _curve(
    who: str, programme: str, outcomes: Sequence[Outcome], said: Mapping[str, Any]
) -> OpponentCurve | None:
    """Curve of one opponent, or nothing where it saw no recording."""
    there = [o for o in outcomes if o.programme == programme and who in said.get(o.key, {})]
    nulls = [said[o.key][who] for o in there if o.tier == "C6" and o.noise == "white"]
    single = [o for o in there if o.tier == "C0"]
    if not nulls or not single:
        return None
    statistics = np.array([n["score"] for n in nulls])
    # The threshold is itself one of the null statistics, so that the tuned rate is never above.
    allowed = int(np.floor(LEVEL * statistics.size))
    threshold = float(np.sort(statistics)[::-1][allowed])
    levels = sorted({round(o.d) for o in single})
    flagged, found, named = [], [], []
    for d in levels:
        here = [(o, said[o.key][who]) for o in single if round(o.d) == d]
        flagged.append((float(d), share_of([s["flagged"] for _, s in here])))
        found.append((float(d), share_of([s["score"] > threshold for _, s in here])))
        if all(s["named"] is not None for _, s in here):
            right = [s["score"] > threshold and set(s["named"]) == set(o.causes) for o, s in here]
            named.append((float(d), share_of(right)))
    return OpponentCurve(
        who=who,
        programme=programme,
        default_alarms=share_of([n["flagged"] for n in nulls]),
        threshold=threshold,
        tuned_alarms=share_of(statistics > threshold),
        needed=d_for_power(
            [o.d for o in single],
            [said[o.key][who]["score"] > threshold for o in single],
            LEVEL,
            draws=100,
        ),
        default_power=tuple(flagged),
        tuned_power=tuple(found),
        tuned_naming=tuple(named),
    )


def opponent_curves(outcomes: Sequence[Outcome], said: Mapping[str, Any]) -> list[OpponentCurve]:
    """Curves of every opponent on rich and poor programmes."""
    names = sorted({who for record in said.values() for who in record})
    curves = [_curve(w, p, outcomes, said) for w in names for p in ("rich", "poor")]
    return [curve for curve in curves if curve is not None]
