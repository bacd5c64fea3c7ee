"""One criterion of a score: a number with its interval, its target and whether that is met."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

from cyclosweep_challenge.scoring.intervals import Estimate, share


@dataclass(frozen=True)
class Criterion:
    """One line of the table.

    Attributes
    ----------
    name : str
        What is measured.
    estimate : Estimate
        Value with its 95 % interval.
    target : str
        What is to be reached, in words.
    required : str
        What must be reached, where that is less; empty where nothing is.
    met, met_required : bool or None
        Whether value or bound is on the right side; None where there are too few cases to say.
    comparable : bool
        Whether another run should reach the same; not what belongs to a machine, nor what depends
        on the number of cases, as departures summed without sign do.
    """

    name: str
    estimate: Estimate
    target: str
    required: str
    met: bool | None
    met_required: bool | None
    comparable: bool = True

    def as_dict(self) -> dict[str, Any]:
        """Return the line as plain data."""
        return asdict(self)


def criterion(
    name: str,
    estimate: Estimate,
    *,
    at_least: float | None = None,
    at_most: float | None = None,
    must: float | None = None,
    by_upper_bound: bool = False,
    within: tuple[float, float] | None = None,
    comparable: bool = True,
) -> Criterion:
    """Compare an estimate with its target."""

    def judge(low: float | None, high: float | None) -> bool | None:
        if estimate.count == 0 or math.isnan(estimate.value):
            return None
        if by_upper_bound and share(0, estimate.count).high > (high or 1.0):
            return None
        seen = estimate.high if by_upper_bound else estimate.value
        return (low is None or seen >= low) and (high is None or seen <= high)

    of = "upper bound " if by_upper_bound else ""
    if within is not None:
        target, met = f"{within[0]:g} to {within[1]:g}", judge(*within)
    elif at_least is not None:
        target, met = f"{of}at least {at_least:g}", judge(at_least, None)
    elif at_most is not None:
        target, met = f"{of}at most {at_most:g}", judge(None, at_most)
    else:
        target, met = "none", None
    required, met_required = "", None
    if must is not None:
        lower = at_least is not None
        required = f"{of}at {'least' if lower else 'most'} {must:g}"
        met_required = judge(must, None) if lower else judge(None, must)
    return Criterion(name, estimate, target, required, met, met_required, comparable)
