"""Share found against visibility: of the diagnosis, and of the test that knows the effect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.scoring.power import LEVEL, PROGRAMMES, Points, by_d, d_for_power
from cyclosweep_challenge.trial.oracle import oracle_d

DETECTED = "detected"
NAMED = "named right"
KNOWING = "test that knows the effect"


@dataclass(frozen=True)
class Curve:
    """Share of cases against visibility on one programme.

    Attributes
    ----------
    who, programme, noise : str
        Whose curve it is, on which programme and under which noise.
    needed : Estimate
        Visibility for 90 % power [-]; of ``named right`` there is none.
    points : tuple of (float, Estimate)
        Visibility and share with its interval.
    """

    who: str
    programme: str
    noise: str
    needed: Estimate
    points: Points


def detection_curves(outcomes: Sequence[Outcome]) -> list[Curve]:
    """Detection, naming and the knowing test's detection of single effects."""
    threshold = oracle_d(0.5, LEVEL)
    curves = []
    for noise in dict.fromkeys(o.noise for o in outcomes if o.tier == "C0"):
        for programme in PROGRAMMES:
            single = [
                o for o in outcomes if (o.tier, o.programme, o.noise) == ("C0", programme, noise)
            ]
            d = [o.d for o in single]
            flagged: dict[str, list[bool]] = {
                DETECTED: [o.alarm for o in single],
                NAMED: [o.named_right for o in single],
                KNOWING: [abs(o.oracle_z) > threshold for o in single],
            }
            for who, flags in flagged.items():
                needed = NOTHING if who == NAMED else d_for_power(d, flags, LEVEL)
                curves.append(Curve(who, programme, noise, needed, by_d(single, flags)))
    return curves


def needed_by(curves: Sequence[Curve], who: str, programme: str, noise: str) -> Estimate:
    """The d that a detector needs for 90 % power [-], or nothing where it has no curve."""
    for curve in curves:
        if (curve.who, curve.programme, curve.noise) == (who, programme, noise):
            return curve.needed
    return NOTHING
