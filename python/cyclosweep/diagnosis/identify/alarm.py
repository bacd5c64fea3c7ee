"""When to say that something is missing: every hypothesis against its own null, all together.

Evidences of different hypotheses have different null distributions: one that averages over twenty
shapes hardly ever reaches what a single column reaches by chance. Each is therefore measured from
its own null quantile, shapes without a name pay a little more, and the largest excess is judged
against the largest excess of recordings with nothing missing.
"""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses import sinusoid
from cyclosweep.diagnosis.identify.scan import Scan
from cyclosweep.simulation.effects.history import Floats

DRAWS = 1000
LEVEL = 0.01
"""Nominal level of the global test."""
OWN = 0.02
"""Null probability at which the excess of a hypothesis begins."""
NAMELESS = 1.5
"""What a shape without a name pays: the logarithm by which its share of the level is smaller."""
FLOOR = 2.5
"""Smallest threshold of the excess."""


@dataclass(frozen=True, eq=False)
class Alarm:
    """Calibration of the global test on one recording.

    Attributes
    ----------
    start : dict
        Evidence at which the excess of each hypothesis begins.
    maxima : ndarray, shape (DRAWS,)
        Largest excess in recordings with nothing missing.
    threshold : float
        Excess beyond which something is said to be missing.
    """

    start: dict[str, float]
    maxima: Floats
    threshold: float

    @classmethod
    def calibrate(cls, rest: Scan, rng: np.random.Generator) -> "Alarm":
        """Draw recordings with nothing beyond the model at hand."""
        drawn = rest.null_evidences(DRAWS, rng)
        start = {
            name: tail_quantile(row, OWN) + (0.0 if _named(rest, name) else NAMELESS)
            for name, row in zip(rest.groups, drawn, strict=True)
        }
        waves = sinusoid.null_wave(DRAWS, rng)
        start |= dict.fromkeys(sinusoid.FAMILIES, tail_quantile(waves, OWN) + NAMELESS)
        part = cls(start, np.zeros(0), np.inf)
        maxima = part.largest(rest, drawn, waves)
        return cls(start, maxima, max(tail_quantile(maxima, LEVEL), FLOOR))

    def largest(self, rest: Scan, drawn: Floats, waves: Floats) -> Floats:
        """Largest excess of each draw."""
        begin = np.array([self.start.get(name, 0.0) for name in rest.groups])
        wave = waves - self.start[sinusoid.FAMILIES[0]]
        beyond = (drawn - begin[:, None]).max(axis=0, initial=-np.inf)
        return np.asarray(np.maximum(beyond, wave))

    def null(self, rest: Scan, rng: np.random.Generator, draws: int = DRAWS) -> Floats:
        """Largest excess in recordings in which this model is all there is."""
        return self.largest(rest, rest.null_evidences(draws, rng), sinusoid.null_wave(draws, rng))

    def excess(self, name: str, evidence: float) -> float:
        """How far a hypothesis is beyond the start of its excess."""
        return evidence - self.start.get(name, 0.0)

    def p_value(self, excess: float) -> float:
        """Probability of as large an excess of anything where nothing is missing."""
        return probability(self.maxima, excess)


def probability(null: Floats, value: float) -> float:
    """Share of null draws at or beyond a value, never zero."""
    return float((1 + np.count_nonzero(null >= value)) / (1 + len(null)))


def tail_quantile(values: Floats, level: float) -> float:
    """Value exceeded with a small probability, by the exponential tail of the largest draws.

    The tail of an evidence falls by a factor of e per nat, near enough to steady the estimate.
    """
    within = max(level, 0.03)
    edge = float(np.quantile(values, 1.0 - within))
    over = values[values > edge] - edge
    scale = (float(over.sum()) + 20.0) / (len(over) + 20.0)
    return edge + scale * float(np.log(within / level))


def _named(rest: Scan, name: str) -> bool:
    return bool(rest.library.signatures[rest.groups[name][0]].named)
