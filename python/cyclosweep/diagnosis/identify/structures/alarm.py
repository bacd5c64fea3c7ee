"""The alarm that something is missing: all hypotheses tested together at one level.

Evidences of different hypotheses are distributed differently where nothing is missing: one that
averages over twenty shapes hardly ever reaches what a single column reaches by chance. Each is
therefore counted from a quantile of its own distribution, unnamed shapes from a little higher, and
the largest such excess is compared with the largest excess of recordings with nothing missing.
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses.sinusoid import FAMILIES, null_evidence
from cyclosweep.diagnosis.identify.structures.scan import Scan
from cyclosweep.simulation.effects.history import Floats

DRAWS = 1000
"""Simulated recordings with nothing missing."""
LEVEL = 0.01
"""Nominal level of the global test."""
OWN_LEVEL = 0.02
"""Probability, with nothing missing, at which the excess of a hypothesis begins."""
UNNAMED_CHARGE = 1.5
"""What an unnamed shape is charged: the logarithm by which its share of the level is smaller."""
LEAST_THRESHOLD = 2.5
"""Smallest threshold of the excess [nat]."""


@dataclass(frozen=True, eq=False)
class _Calibration:
    """What recordings with nothing missing show, see `Alarm`."""

    start: dict[str, float]
    maxima: Floats
    threshold: float


class Alarm:
    """Calibration of the global test on one recording, made when it is first asked for.

    Parameters
    ----------
    scan : Scan
        The library, projected on what the baseline leaves.
    seed : int
        Seed of the recordings that are drawn.
    """

    def __init__(self, scan: Scan, seed: int) -> None:
        self._scan, self._seed = scan, seed

    @property
    def start(self) -> dict[str, float]:
        """Evidence at which the excess of each hypothesis begins [nat]."""
        return self._calibration.start

    @property
    def maxima(self) -> Floats:
        """Largest excess in recordings with nothing missing, shape (DRAWS,) [nat]."""
        return self._calibration.maxima

    @property
    def threshold(self) -> float:
        """Excess beyond which something is said to be missing [nat]."""
        return self._calibration.threshold

    @cached_property
    def _calibration(self) -> _Calibration:
        """Thresholds from simulated recordings with nothing beyond the baseline."""
        scan, rng = self._scan, np.random.default_rng([self._seed, 1])
        drawn = scan.null_evidences(DRAWS, rng)
        start = {
            name: tail_quantile(row, OWN_LEVEL) + (0.0 if _named(scan, name) else UNNAMED_CHARGE)
            for name, row in zip(scan.groups, drawn, strict=True)
        }
        sinusoids = null_evidence(DRAWS, rng)
        start |= dict.fromkeys(FAMILIES, tail_quantile(sinusoids, OWN_LEVEL) + UNNAMED_CHARGE)
        maxima = _largest(start, scan, drawn, sinusoids)
        return _Calibration(start, maxima, max(tail_quantile(maxima, LEVEL), LEAST_THRESHOLD))

    def null(self, scan: Scan, rng: np.random.Generator, draws: int = DRAWS) -> Floats:
        """Largest excess in recordings in which one structure is all there is.

        Parameters
        ----------
        scan : Scan
            The library, projected on what that structure leaves.
        rng : numpy.random.Generator
        draws : int

        Returns
        -------
        ndarray, shape (draws,)
        """
        drawn = scan.null_evidences(draws, rng)
        return _largest(self.start, scan, drawn, null_evidence(draws, rng))

    def excess(self, name: str, evidence: float) -> float:
        """How far the evidence of a hypothesis is beyond the start of its excess [nat].

        Parameters
        ----------
        name : str
            Name of an effect, or family of an unnamed shape.
        evidence : float
            In nat.

        Returns
        -------
        float
            In nat.
        """
        return evidence - self.start.get(name, 0.0)

    def p_value(self, excess: float) -> float:
        """Probability of as large an excess of anything where nothing is missing."""
        return probability(self.maxima, excess)


def probability(null: Floats, value: float) -> float:
    """Share of null draws at or beyond a value, never zero.

    Parameters
    ----------
    null : ndarray, shape (draws,)
    value : float

    Returns
    -------
    float
        From 1 / (draws + 1) to 1.
    """
    return float((1 + np.count_nonzero(null >= value)) / (1 + len(null)))


def tail_quantile(values: Floats, level: float) -> float:
    """Value exceeded with a small probability, by the exponential tail of the largest draws.

    The tail of an evidence falls by a factor of e per nat, near enough to steady the estimate.

    Parameters
    ----------
    values : ndarray, shape (draws,)
    level : float
        Probability of a larger value.

    Returns
    -------
    float
    """
    within = max(level, 0.03)
    edge = float(np.quantile(values, 1.0 - within))
    over = values[values > edge] - edge
    scale = (float(over.sum()) + 20.0) / (len(over) + 20.0)
    return edge + scale * float(np.log(within / level))


def _largest(start: dict[str, float], scan: Scan, drawn: Floats, sinusoids: Floats) -> Floats:
    """Largest excess of each draw.

    Parameters
    ----------
    start : dict
        Evidence at which the excess of each hypothesis begins [nat].
    scan : Scan
    drawn : ndarray, shape (hypotheses, draws)
        Evidence of each hypothesis of the library [nat].
    sinusoids : ndarray, shape (draws,)
        Evidence of the strongest sinusoid [nat].

    Returns
    -------
    ndarray, shape (draws,)
    """
    begin = np.array([start.get(name, 0.0) for name in scan.groups])
    beyond = (drawn - begin[:, None]).max(axis=0, initial=-np.inf)
    return np.asarray(np.maximum(beyond, sinusoids - start[FAMILIES[0]]))


def _named(scan: Scan, name: str) -> bool:
    """Whether a hypothesis is a named effect.

    Parameters
    ----------
    scan : Scan
    name : str
        Name of the hypothesis.

    Returns
    -------
    bool
    """
    return bool(scan.library.signatures[scan.groups[name][0]].named)
