"""Power against d, and the d at which nine in ten recordings are found."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy import optimize
from scipy.special import ndtr, ndtri

from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate, share_of
from cyclosweep_challenge.scoring.outcome import Outcome
from cyclosweep_challenge.trial.oracle import oracle_d

Array = NDArray[np.float64]
Points = tuple[tuple[float, Estimate], ...]

LEVEL = 0.01
"""False alarms at which detectors are compared."""
PROGRAMMES = ("rich", "poor")
"""Programmes on which power is shown."""
FEWEST = 20
"""Recordings below which no power curve is drawn."""


def _fit(d: Array, hit: Array, level: float) -> float:
    """Fit a probit curve above a false-alarm floor; return where it reaches 0.9."""

    def loss(theta: Array) -> float:
        curve = level + (1.0 - level) * ndtr((d - theta[0]) / np.exp(theta[1]))
        chance = np.clip(curve, 1e-9, 1.0 - 1e-9)
        return float(-np.sum(hit * np.log(chance) + (1.0 - hit) * np.log(1.0 - chance)))

    best = optimize.minimize(loss, [4.0, 0.2], method="Nelder-Mead")
    needed = ndtri((0.9 - level) / (1.0 - level))
    return float(best.x[0] + np.exp(best.x[1]) * needed)


def d_for_power(
    d: Sequence[float], hits: Sequence[bool], level: float = LEVEL, draws: int = 200
) -> Estimate:
    """Visibility at which nine in ten are found, with a bootstrap interval [-].

    Without ``draws`` the bounds are the value itself. Returns nothing where fewer than twenty
    cases, or cases of one outcome only, are there.
    """
    x, y = np.asarray(d, dtype=float), np.asarray(hits, dtype=float)
    if x.size < FEWEST or y.min() == y.max():
        return NOTHING
    value = _fit(x, y, level)
    if draws == 0:
        return Estimate(value, value, value, int(x.size))
    rng = np.random.default_rng(54321)
    drawn = []
    for _ in range(draws):
        pick = rng.integers(0, x.size, x.size)
        if y[pick].min() != y[pick].max():
            drawn.append(_fit(x[pick], y[pick], level))
    low, high = np.quantile(drawn, [0.025, 0.975])
    return Estimate(value, float(low), float(high), int(x.size))


def relative_to_oracle(needed: Estimate, level: float = LEVEL) -> Estimate:
    """Visibility needed over that of the test that knows the effect [-]."""
    oracle = oracle_d(0.9, level)
    return Estimate(needed.value / oracle, needed.low / oracle, needed.high / oracle, needed.count)


def by_d(single: Sequence[Outcome], hits: Sequence[bool] | NDArray[np.bool_]) -> Points:
    """Share of hits at every visibility."""
    levels = sorted({round(o.d) for o in single})
    return tuple(
        (float(d), share_of([h for o, h in zip(single, hits, strict=True) if round(o.d) == d]))
        for d in levels
    )
