"""Rates of false alarms and of finds on simulated recordings of the same programme and noise."""

import numpy as np

from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.scan import likelihood_gain
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.result import SelfCheck

TWINS = 300


def self_check(search: Search, best: Candidate | None, rivals: list[Candidate]) -> SelfCheck:
    """False-alarm rate, power and confusion on twins of the recording.

    Twins have this recording's programme and noise, and nothing, the found effect, or a rival
    beyond the baseline. They are drawn on the projected problem, one accepted effect at a time.

    Parameters
    ----------
    search : Search
        The search whose rates are asked for.
    best : Candidate or None
        Structure that the verdict rests on.
    rivals : list of Candidate
        Other explanations.

    Returns
    -------
    SelfCheck
    """
    rng = np.random.default_rng([search.seed, 3])
    nothing = search.alarm.null(search.baseline.scan, rng, 2 * TWINS)
    false_alarm = float(np.mean(nothing > search.threshold))
    confusion: dict[str, dict[str, float]] = {}
    powers = []
    for candidate in [] if best is None else [best, *rivals]:
        for index, term in enumerate(candidate.fit.terms):
            parent = search.visited.get(candidate.names - {term.name}, search.baseline)
            if len(candidate.names) > 1 and parent is search.baseline:
                continue
            if term.name in confusion:
                continue
            power, row = _twins(search, parent, candidate, index, rng)
            confusion[term.name] = row
            if candidate is best:
                powers.append(power)
    return SelfCheck(
        false_alarm=false_alarm,
        power=min(powers, default=None),
        confusion=confusion,
        twins=TWINS,
    )


def _twins(
    search: Search, parent: Candidate, candidate: Candidate, index: int, rng: np.random.Generator
) -> tuple[float, dict[str, float]]:
    """Power, and the share of twins in which each hypothesis comes out on top.

    Parameters
    ----------
    search : Search
    parent : Candidate
        The structure without the term.
    candidate : Candidate
        The structure with it.
    index : int
        Index of the term.
    rng : numpy.random.Generator

    Returns
    -------
    float, dict of str to float
    """
    signal = candidate.fit.whitened_contribution(index, search.noise)
    tangent = parent.fit.tangent
    left = signal - tangent @ (tangent.T @ signal)
    scan = parent.scan
    score = scan.draws(TWINS, rng) + (search.whitened.T @ left)[:, None]
    excess = float(left @ left)
    gains = likelihood_gain(scan.gains(score), excess, search.noise.freedom)
    names = np.array(list(scan.groups))
    start = np.array([search.alarm.start.get(str(name), 0.0) for name in names])
    values = scan.evidences(gains) - start[:, None]
    found = values.max(axis=0) > search.threshold
    top = names[np.argmax(values, axis=0)]
    row = {str(name): float(np.mean(found & (top == name))) for name in np.unique(top[found])}
    row["nothing"] = float(np.mean(~found))
    return float(np.mean(found)), dict(sorted(row.items(), key=lambda item: -item[1]))
