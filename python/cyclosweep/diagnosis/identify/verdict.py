"""The verdict: what the evidence allows to say, and no more."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from cyclosweep.diagnosis.identify.search import Node, Search
from cyclosweep.diagnosis.identify.testability import Testability

Verdict = Literal[
    "IDENTIFIED",
    "AMBIGUOUS",
    "UNKNOWN_PHYSICS",
    "NOTHING_MISSING",
    "INSUFFICIENT_DATA",
    "DATA_FAULT",
]

SURE = 0.5
"""Posterior probability from which the best explanation is named as the one: more probable than
all others together. What else is possible stands beside it."""
COVERAGE = 0.95
"""Probability that the explanation set holds together."""


@dataclass(frozen=True, eq=False)
class Decision:
    """Verdict with the structures it rests on.

    Attributes
    ----------
    verdict : str
    best : Node or None
        Structure on which effects, repair and sizes rest.
    explanations : list of (Node, probability)
        Most probable first, together at least 95 % where anything was found.
    unexplained : bool
        Something without a name remains or is the better explanation.
    """

    verdict: Verdict
    best: Node | None
    explanations: list[tuple[Node, float]]
    unexplained: bool


def decide(search: Search, bounds: list[Testability], tolerance_deg: float) -> Decision:
    """Choose the verdict from the visited structures.

    ``bounds`` are the testable effects at the baseline, for the case that nothing is found.
    """
    if search.root.left < search.threshold:
        clear = bool(bounds) and all(b.upper95_deg < tolerance_deg for b in bounds)
        return Decision("NOTHING_MISSING" if clear else "INSUFFICIENT_DATA", None, [], False)
    structures = search.explanations()
    if not structures:
        return Decision("UNKNOWN_PHYSICS", None, [], True)
    enough = [node for node in structures if search.suffices(node)]
    if not enough:
        best = structures[0]
        return Decision("UNKNOWN_PHYSICS", best, [(best, 1.0)], True)
    score = np.array([node.score for node in enough])
    probability = np.exp(score - score.max())
    probability /= probability.sum()
    held = int(np.searchsorted(np.cumsum(probability), COVERAGE)) + 1
    explained = [(n, float(p)) for n, p in zip(enough[:held], probability[:held], strict=True)]
    nameless = float(sum(p for n, p in zip(enough, probability, strict=True) if not n.named_only))
    if nameless > 0.5:
        best = next(n for n in enough if not n.named_only)
        return Decision("UNKNOWN_PHYSICS", best, explained, True)
    best = next(n for n in enough if n.named_only)
    sure = probability[enough.index(best)] >= SURE
    return Decision("IDENTIFIED" if sure else "AMBIGUOUS", best, explained, False)


def decide_structured(search: Search, repeats: bool) -> Decision:
    """Verdict where the residual is error of the model: only what repeats counts as physics left.

    Effects that paid for themselves are named; whether they are all is told by the replicates.
    """
    best = search.settled
    if best is None or not best.fit.terms:
        return Decision("INSUFFICIENT_DATA", None, [], False)
    verdict: Verdict = "UNKNOWN_PHYSICS" if repeats else "IDENTIFIED"
    return Decision(verdict, best, [(best, 1.0)], repeats)


def unit_slip(ratio: float, gear_ratio: float) -> str | None:
    """Name the mistake behind a compliance so many times its nominal value."""
    known = (
        (180 / np.pi, "57.3: angles in rad read as deg, or the reverse"),
        (1000.0, "1000: N mm read as N m, or mrad as rad"),
        (gear_ratio**2, "the ratio squared: measured at the other shaft than stated"),
        (gear_ratio, "the ratio: torque or angle taken at the other shaft"),
        (360.0, "360: revolutions read as deg, or the reverse"),
        (9.80665, "9.81: kgf m read as N m"),
    )
    size = abs(np.log(abs(ratio)))
    distance = [abs(size - np.log(factor)) for factor, _ in known]
    best = int(np.argmin(distance))
    return known[best][1] if distance[best] < np.log(1.35) else None
