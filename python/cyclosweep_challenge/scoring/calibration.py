"""Stated probabilities against frequencies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep_challenge.scoring.intervals import NOTHING, Estimate, share
from cyclosweep_challenge.scoring.outcome import Outcome

BINS = 10
"""Steps of probability in which stated probabilities are grouped."""


@dataclass(frozen=True)
class Bin:
    """Explanations with stated probabilities in one step.

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


def calibration_bins(outcomes: Sequence[Outcome], count: int = BINS) -> list[Bin]:
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


def chance_error(outcomes: Sequence[Outcome], draws: int = 200) -> Estimate:
    """Calibration error that probabilities exactly as stated would show by chance alone [-].

    The mean distance cannot be negative, so that few cases make honest probabilities look bad.
    Of every recording at most one of the stated explanations is made true, each with its stated
    probability; the bounds hold 95 % of the draws.
    """
    by_case = [
        np.array([p for _, p in o.explanations if np.isfinite(p)])
        for o in outcomes
        if any(np.isfinite(p) for _, p in o.explanations)
    ]
    if not by_case:
        return NOTHING
    stated = np.concatenate(by_case)
    place = np.clip((stated * BINS).astype(int), 0, BINS - 1)
    start = np.cumsum([0, *[len(p) for p in by_case[:-1]]])
    reach = np.concatenate([np.cumsum(p) for p in by_case])
    owner = np.repeat(np.arange(len(by_case)), [len(p) for p in by_case])
    rng = np.random.default_rng(77)
    errors = []
    for _ in range(draws):
        chance = rng.random(len(by_case))[owner]
        first = np.concatenate([[0.0], reach[:-1]])
        first[start] = 0.0
        true = (chance < reach) & (chance >= first)
        miss = np.bincount(place, true - stated, minlength=BINS)
        errors.append(float(np.abs(miss).sum() / stated.size))
    low, high = np.quantile(errors, [0.025, 0.975])
    return Estimate(float(np.mean(errors)), float(low), float(high), int(stated.size))
