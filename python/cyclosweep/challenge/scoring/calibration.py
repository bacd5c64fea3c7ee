"""Whether stated probabilities are borne out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.challenge.scoring.intervals import Estimate, share
from cyclosweep.challenge.scoring.outcome import Outcome


@dataclass(frozen=True)
class Bin:
    """Explanations whose stated probabilities are alike.

    Attributes
    ----------
    stated : float
        Their mean probability [-].
    frequency : Estimate
        How often they were the true set.
    """

    stated: float
    frequency: Estimate


def stated_and_true(outcomes: Sequence[Outcome]) -> tuple[list[float], list[bool]]:
    """Collect every stated probability, and whether its explanation was the true set."""
    stated, true = [], []
    for outcome in outcomes:
        for names, probability in outcome.explanations:
            if np.isfinite(probability):
                stated.append(probability)
                true.append(set(names) == set(outcome.causes))
    return stated, true


def calibration_bins(outcomes: Sequence[Outcome], count: int = 10) -> list[Bin]:
    """Group stated probabilities into equal steps of probability."""
    stated, true = (np.asarray(column) for column in stated_and_true(outcomes))
    bins = []
    for k in range(count):
        upper = stated <= (k + 1) / count if k == count - 1 else stated < (k + 1) / count
        here = (stated >= k / count) & upper if stated.size else np.zeros(0, dtype=bool)
        if here.any():
            bins.append(
                Bin(float(stated[here].mean()), share(int(true[here].sum()), int(here.sum())))
            )
    return bins


def calibration_error(outcomes: Sequence[Outcome]) -> float:
    """Mean distance between stated probability and frequency, weighted by cases [-]."""
    bins = calibration_bins(outcomes)
    total = sum(b.frequency.count for b in bins)
    if total == 0:
        return float("nan")
    return sum(abs(b.stated - b.frequency.value) * b.frequency.count for b in bins) / total
