"""The opponents' power, at their defaults and at one false alarm in a hundred."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cyclosweep_challenge.rig.noise import NOISES
from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate, share_of
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.scoring.power import (
    FEWEST,
    LEVEL,
    PROGRAMMES,
    Points,
    by_d,
    d_for_power,
)

Array = NDArray[np.float64]

OURS = "the diagnosis, tuned alike"
"""Our own evidence, with its threshold set as an opponent's is."""
MIDDLE = (2.5, 10.5)
"""Visibilities over which two detectors are compared: below, none sees much; above, most do."""


@dataclass(frozen=True)
class Setting:
    """A detector at the threshold that one in a hundred recordings with nothing missing exceeds.

    Attributes
    ----------
    threshold : float
        In the detector's units.
    alarms : tuple of (str, Estimate)
        Family of noise, and false alarms under it at that threshold.
    needed : Estimate
        Visibility for 90 % power; beyond 20, none is to be read from it [-]. Its interval holds
        the uncertainty of the threshold.
    ahead, tuned_ahead : Estimate
        Share found by the diagnosis as it is, or with its evidence tuned alike, minus the share
        found by this detector, on the same recordings of d = 3 to 10 [-]. The intervals draw
        recordings with nothing missing, and so thresholds, again as well.
    power, naming : tuple of (float, Estimate)
        Visibility and share found, or named right; naming is empty for who names nothing.
    """

    threshold: float
    alarms: tuple[tuple[str, Estimate], ...]
    needed: Estimate
    ahead: Estimate
    tuned_ahead: Estimate
    power: Points
    naming: Points

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "threshold": self.threshold,
            "alarms": {family: vars(e) for family, e in self.alarms},
            "needed": vars(self.needed),
            "ahead": vars(self.ahead),
            "tuned_ahead": vars(self.tuned_ahead),
            "power": _listed(self.power),
            "naming": _listed(self.naming),
        }


@dataclass(frozen=True)
class OpponentCurve:
    """One opponent on one programme.

    Attributes
    ----------
    who, programme, noise : str
        The opponent, the programme, and the noise of the recordings with an effect.
    default_alarms : Estimate
        False alarms at its defaults, on recordings with nothing missing and that noise.
    default_power : tuple of (float, Estimate)
        Visibility and share found at its defaults.
    own : Setting
        Tuned on recordings with nothing missing and that noise: it knows the family beforehand.
    every : Setting or None
        Tuned on recordings with nothing missing under all families of ``NOISES``, each family
        counting the same; nothing where it has not seen enough of each.
    """

    who: str
    programme: str
    noise: str
    default_alarms: Estimate
    default_power: Points
    own: Setting
    every: Setting | None

    def as_dict(self) -> dict[str, Any]:
        """Return plain data."""
        return {
            "who": self.who,
            "programme": self.programme,
            "noise": self.noise,
            "default_alarms": vars(self.default_alarms),
            "default_power": _listed(self.default_power),
            "own": self.own.as_dict(),
            "every": self.every and self.every.as_dict(),
        }


def _listed(points: Points) -> list[dict[str, Any]]:
    """Points as plain data."""
    return [{"d": d, **vars(e)} for d, e in points]


def tuned(statistics: Array, weights: Array | None = None) -> float:
    """Return the threshold that one in a hundred null statistics exceeds.

    It is itself one of them, so that no more than one in a hundred of these is above; of others,
    slightly more than one in a hundred are, which favours whoever is tuned so.

    Parameters
    ----------
    statistics : ndarray, shape (n,)
        Statistics of recordings with nothing missing.
    weights : ndarray, shape (n,), optional
        What each counts; all the same if absent.
    """
    counted = np.ones(statistics.size) if weights is None else weights
    order = np.argsort(-statistics, kind="stable")
    share = np.cumsum(counted[order]) / counted.sum()
    return float(statistics[order[np.argmax(share > LEVEL * (1.0 + 1e-9))]])


@dataclass(frozen=True, eq=False)
class _Nulls:
    """Recordings with nothing missing on which thresholds are set.

    Attributes
    ----------
    theirs, ours : ndarray, shape (n,)
        Statistic of the opponent, and excess of the diagnosis.
    family : ndarray, shape (n,)
        Family of noise of each, as a number; every family counts the same.
    """

    theirs: Array
    ours: Array
    family: NDArray[np.int64]

    @classmethod
    def of(cls, who: str, outcomes: Sequence[Outcome], replies: Mapping[str, Any]) -> _Nulls:
        """Collect the replies to some recordings."""
        return cls(
            np.array([replies[o.key][who]["score"] for o in outcomes]),
            np.array([o.excess for o in outcomes]),
            np.array([NOISES.index(o.noise) for o in outcomes]),
        )

    def again(self, rng: np.random.Generator) -> _Nulls:
        """Draw as many of each family again."""
        pick = np.arange(self.family.size)
        for one in np.unique(self.family):
            there = np.flatnonzero(self.family == one)
            pick[there] = rng.choice(there, there.size)
        return _Nulls(self.theirs[pick], self.ours[pick], self.family)

    @property
    def weights(self) -> Array:
        """What each recording counts."""
        return 1.0 / np.bincount(self.family)[self.family]

    @property
    def fine_enough(self) -> bool:
        """Whether no single recording decides a threshold of one in a hundred."""
        return bool(self.weights.max() <= LEVEL * self.weights.sum())

    @property
    def threshold(self) -> float:
        """Of the opponent."""
        return tuned(self.theirs, self.weights)

    @property
    def own_threshold(self) -> float:
        """Of the diagnosis, tuned alike."""
        return tuned(self.ours, self.weights)


def _found(d: Array, hits: NDArray[np.bool_]) -> float:
    """Visibility for 90 % power: infinite where nothing is found, zero where everything is."""
    if hits.size and hits.all() != hits.any():
        return d_for_power(list(d), list(hits), LEVEL, draws=0).value
    return 0.0 if hits.all() else np.inf


def _needed(d: Sequence[float], scores: Array, nulls: _Nulls, draws: int = 60) -> Estimate:
    """Visibility for 90 % power, with threshold and recordings drawn again for its interval."""
    x = np.array(d)
    value = _found(x, scores > nulls.threshold)
    if x.size < FEWEST or value == 0.0:
        return NOTHING
    rng = np.random.default_rng(2468)
    drawn = []
    for _ in range(draws):
        pick = rng.integers(0, x.size, x.size)
        drawn.append(_found(x[pick], scores[pick] > nulls.again(rng).threshold))
    low, high = np.quantile(drawn, [0.025, 0.975], method="nearest")
    return Estimate(value, float(low), float(high), x.size)


def _ahead(middle: Sequence[Outcome], theirs: Array, nulls: _Nulls, equal_alarms: bool) -> Estimate:
    """Share that the diagnosis finds beyond an opponent's, on the same recordings."""
    if not middle:
        return NOTHING
    alarm = np.array([o.alarm for o in middle])
    excess = np.array([o.excess for o in middle])

    def difference(pick: NDArray[np.int64], drawn: _Nulls) -> float:
        ours = excess[pick] > drawn.own_threshold if equal_alarms else alarm[pick]
        return float(np.mean(ours) - np.mean(theirs[pick] > drawn.threshold))

    every = np.arange(len(middle))
    rng = np.random.default_rng(1357)
    drawn = [difference(rng.choice(every, every.size), nulls.again(rng)) for _ in range(400)]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Estimate(difference(every, nulls), float(low), float(high), len(middle))


def _setting(
    who: str,
    single: Sequence[Outcome],
    nulls: Sequence[Outcome],
    every: Sequence[Outcome],
    replies: Mapping[str, Any],
) -> Setting:
    """Tune one detector on some of all the recordings with nothing missing that it saw."""
    tuning = _Nulls.of(who, nulls, replies)
    limit = tuning.threshold
    scores = np.array([replies[o.key][who]["score"] for o in single])
    found = scores > limit
    inside = [MIDDLE[0] < o.d < MIDDLE[1] for o in single]
    middle = [o for o, there in zip(single, inside, strict=True) if there]
    names = [replies[o.key][who]["named"] for o in single]
    right = [
        bool(hit) and set(named or ()) == set(o.causes)
        for o, hit, named in zip(single, found, names, strict=True)
    ]
    return Setting(
        threshold=limit,
        alarms=tuple(
            (family, share_of([replies[o.key][who]["score"] > limit for o in there]))
            for family in NOISES
            if (there := [o for o in every if o.noise == family])
        ),
        needed=_needed([o.d for o in single], scores, tuning),
        ahead=_ahead(middle, scores[inside], tuning, equal_alarms=False),
        tuned_ahead=_ahead(middle, scores[inside], tuning, equal_alarms=True),
        power=by_d(single, found),
        naming=() if any(named is None for named in names) else by_d(single, right),
    )


def _curve(
    who: str, programme: str, noise: str, outcomes: Sequence[Outcome], replies: Mapping[str, Any]
) -> OpponentCurve | None:
    """Curve of one opponent, or nothing where it saw no recording."""
    shown = [o for o in outcomes if o.programme == programme and who in replies.get(o.key, {})]
    single = [o for o in shown if o.tier == "C0" and o.noise == noise]
    nulls = [o for o in shown if o.tier == "C6"]
    own = [o for o in nulls if o.noise == noise]
    if not own or not single:
        return None
    saw_all = {o.noise for o in nulls} == set(NOISES) and _Nulls.of(who, nulls, replies).fine_enough
    return OpponentCurve(
        who=who,
        programme=programme,
        noise=noise,
        default_alarms=share_of([replies[o.key][who]["flagged"] for o in own]),
        default_power=by_d(single, [replies[o.key][who]["flagged"] for o in single]),
        own=_setting(who, single, own, nulls, replies),
        every=_setting(who, single, nulls, nulls, replies) if saw_all else None,
    )


def _own(outcome: Outcome) -> dict[str, Any]:
    """Reply of the diagnosis in the form of an opponent's."""
    return {"score": outcome.excess, "flagged": outcome.alarm, "named": None}


def opponent_curves(outcomes: Sequence[Outcome], replies: Mapping[str, Any]) -> list[OpponentCurve]:
    """Curves of every opponent on rich and poor programmes, under the noise of each."""
    names = sorted({who for record in replies.values() for who in record})
    if names:
        # Ours is tuned on, and shown, every recording that any opponent saw.
        replies = {o.key: {**replies[o.key], OURS: _own(o)} for o in outcomes if replies.get(o.key)}
        names.append(OURS)
    noises = [n for n in NOISES if any(o.tier == "C0" and o.noise == n for o in outcomes)]
    curves = [
        _curve(who, programme, noise, outcomes, replies)
        for noise in noises
        for who in names
        for programme in PROGRAMMES
    ]
    return [curve for curve in curves if curve is not None]
