"""The opponents' power, at their defaults and at one false alarm in a hundred."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep.challenge.noise import NOISES
from cyclosweep.challenge.scoring.intervals import NOTHING, Estimate, share_of
from cyclosweep.challenge.scoring.outcome import Outcome
from cyclosweep.challenge.scoring.power import d_for_power

Array = NDArray[np.float64]

LEVEL = 0.01
OURS = "the diagnosis, tuned alike"
"""Our own evidence, with its threshold set as an opponent's is."""
MIDDLE = (2.5, 10.5)
"""Visibilities over which two detectors are compared: below, none sees much; above, most do."""


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
        Its interval holds the uncertainty of the threshold.
    ahead, tuned_ahead : Estimate
        Share found by the diagnosis as it is, or with its evidence tuned alike, minus the share
        found by the opponent at that threshold, on the same recordings of d = 3 to 10 [-]. The
        intervals draw recordings with nothing missing, and so thresholds, again as well.
    elsewhere : tuple of (str, Estimate)
        Family of noise, and false alarms at that threshold under it: it was set on white noise.
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
    ahead: Estimate
    tuned_ahead: Estimate
    elsewhere: tuple[tuple[str, Estimate], ...]
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
            "ahead": vars(self.ahead),
            "tuned_ahead": vars(self.tuned_ahead),
            "elsewhere": {family: vars(e) for family, e in self.elsewhere},
            "default_power": listed(self.default_power),
            "tuned_power": listed(self.tuned_power),
            "tuned_naming": listed(self.tuned_naming),
        }


def tuned(statistics: Array) -> float:
    """Return the threshold that one in a hundred null statistics exceeds.

    It is itself one of them, so that no more than one in a hundred of these is above; of others,
    slightly more than one in a hundred are, which favours whoever is tuned so.
    """
    allowed = int(np.floor(LEVEL * statistics.size))
    return float(np.sort(statistics)[::-1][allowed])


def _needed(d: Sequence[float], scores: Sequence[float], nulls: Array, draws: int = 60) -> Estimate:
    """Visibility for 90 % power, with threshold and recordings drawn again for its interval."""
    x, y = np.array(d), np.array(scores)
    value = d_for_power(list(x), list(y > tuned(nulls)), LEVEL, draws=0)
    if value.count == 0:
        return value
    rng = np.random.default_rng(2468)
    drawn = []
    for _ in range(draws):
        pick = rng.integers(0, x.size, x.size)
        limit = tuned(nulls[rng.integers(0, nulls.size, nulls.size)])
        again = d_for_power(list(x[pick]), list(y[pick] > limit), LEVEL, draws=0)
        drawn.append(again.value if again.count else np.inf)
    low, high = np.quantile(drawn, [0.025, 0.975], method="nearest")
    return Estimate(value.value, float(low), float(high), value.count)


def _ahead(
    middle: Sequence[Outcome], theirs: Array, nulls: Array, own_nulls: Array | None
) -> Estimate:
    """Share that the diagnosis finds beyond an opponent's, on the same recordings."""
    if not middle:
        return NOTHING
    alarm = np.array([o.alarm for o in middle])
    excess = np.array([o.excess for o in middle])

    def difference(pick: NDArray[np.int64], drawn: NDArray[np.int64]) -> float:
        ours = alarm[pick] if own_nulls is None else excess[pick] > tuned(own_nulls[drawn])
        return float(np.mean(ours) - np.mean(theirs[pick] > tuned(nulls[drawn])))

    every, all_nulls = np.arange(len(middle)), np.arange(nulls.size)
    rng = np.random.default_rng(1357)
    drawn = [
        difference(rng.choice(every, every.size), rng.choice(all_nulls, all_nulls.size))
        for _ in range(400)
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Estimate(difference(every, all_nulls), float(low), float(high), len(middle))


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
    own = np.array([o.excess for o in there if o.tier == "C6" and o.noise == "white"])
    threshold = tuned(statistics)
    levels = sorted({round(o.d) for o in single})
    flagged, found, named = [], [], []
    for d in levels:
        here = [(o, said[o.key][who]) for o in single if round(o.d) == d]
        flagged.append((float(d), share_of([s["flagged"] for _, s in here])))
        found.append((float(d), share_of([s["score"] > threshold for _, s in here])))
        if all(s["named"] is not None for _, s in here):
            right = [s["score"] > threshold and set(s["named"]) == set(o.causes) for o, s in here]
            named.append((float(d), share_of(right)))
    middle = [o for o in single if MIDDLE[0] < o.d < MIDDLE[1]]
    theirs = np.array([said[o.key][who]["score"] for o in middle])
    return OpponentCurve(
        who=who,
        programme=programme,
        default_alarms=share_of([n["flagged"] for n in nulls]),
        threshold=threshold,
        tuned_alarms=share_of(statistics > threshold),
        needed=_needed(
            [o.d for o in single], [said[o.key][who]["score"] for o in single], statistics
        ),
        ahead=_ahead(middle, theirs, statistics, None),
        tuned_ahead=_ahead(middle, theirs, statistics, own),
        elsewhere=tuple(
            (family, share_of([said[o.key][who]["score"] > threshold for o in others]))
            for family in NOISES
            if (others := [o for o in there if o.tier == "C6" and o.noise == family])
            and family != "white"
        ),
        default_power=tuple(flagged),
        tuned_power=tuple(found),
        tuned_naming=tuple(named),
    )


def _own(outcome: Outcome) -> dict[str, Any]:
    """Words of the diagnosis in the form of an opponent's."""
    return {"score": outcome.excess, "flagged": outcome.alarm, "named": None}


def opponent_curves(outcomes: Sequence[Outcome], said: Mapping[str, Any]) -> list[OpponentCurve]:
    """Curves of every opponent on rich and poor programmes."""
    names = sorted({who for record in said.values() for who in record})
    if names:
        # Ours is tuned on, and shown, every recording that any opponent saw.
        said = {o.key: {**said[o.key], OURS: _own(o)} for o in outcomes if said.get(o.key)}
        names.append(OURS)
    curves = [_curve(w, p, outcomes, said) for w in names for p in ("rich", "poor")]
    return [curve for curve in curves if curve is not None]
