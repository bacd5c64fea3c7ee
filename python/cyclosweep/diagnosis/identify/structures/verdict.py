"""The verdict: which explanation, if any, the evidence supports."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import Testability
from cyclosweep.result import Verdict

SURE = 0.5
"""Posterior probability from which the best explanation is named as the one: more probable than
all others together. What else is possible stands beside it."""
BEYOND_NOISE = 3.0
"""Root mean square error over noise and rounding from which something is missing, whatever the
tests say."""
WITHIN_NOISE = 2.0
"""Root mean square error over noise and rounding up to which named effects may be said to leave
nothing: an estimate of strongly correlated noise may be too small by as much."""
MOSTLY = 0.9
"""Share of the mismatch from which named effects are said to explain most of it."""
COVERAGE = 0.95
"""Probability that the explanation set holds together."""
CLOSE_TO_UNNAMED = 5.0
"""Log evidence by which a structure with a shape without a name may be ahead of one of named
effects that leaves no more: against the error of models such odds decide nothing."""
NEARLY_ALL = 0.98
"""Share of the mean square explained by a structure with shapes without a name, from which one of
named effects is taken in its place, whatever the evidence: what is left, a seventh as a root mean
square, may be the error of their laws, and the next stage looks at it."""


@dataclass(frozen=True, eq=False)
class Decision:
    """Verdict with the structures it rests on.

    Attributes
    ----------
    verdict : str
    best : Candidate or None
        Structure on which effects, repair and sizes rest.
    explanations : list of (Candidate, probability)
        Most probable first, together at least 95 % where anything was found.
    unexplained : bool
        Something without a name remains or is the better explanation.
    """

    verdict: Verdict
    best: Candidate | None
    explanations: list[tuple[Candidate, float]]
    unexplained: bool


def decide(
    search: Search, bounds: Sequence[Testability] = (), tolerance_deg: float = 0.0
) -> Decision:
    """Choose the verdict from the visited structures.

    Parameters
    ----------
    search : Search
        After it has run.
    bounds : sequence of Testability
        The testable effects beside the baseline. Only where all of them are below the tolerance
        does it mean that nothing is missing when nothing is found; without bounds it never does.
    tolerance_deg : float
        Size below which an effect does not matter [deg].

    Returns
    -------
    Decision
    """
    if search.baseline.largest_excess < search.threshold:
        if search.baseline.fit.rmse_deg > BEYOND_NOISE * search.noise.spread_deg:
            return Decision("UNKNOWN_PHYSICS", None, [], True)
        clear = bool(bounds) and all(b.upper95_deg < tolerance_deg for b in bounds)
        return Decision("NOTHING_MISSING" if clear else "INSUFFICIENT_DATA", None, [], False)
    structures = search.explanations()
    if not structures:
        return Decision("UNKNOWN_PHYSICS", None, [], True)
    enough = [candidate for candidate in structures if search.suffices(candidate)]
    if not enough:
        best = structures[0]
        return Decision("UNKNOWN_PHYSICS", best, [(best, 1.0)], True)
    probable = probabilities(enough)
    unnamed = [(n, p) for n, p in probable if not n.all_recognised]
    if sum(p for _, p in unnamed) > 1.0 - SURE:
        return Decision("UNKNOWN_PHYSICS", unnamed[0][0], likely(probable), True)
    best, probability = next((n, p) for n, p in probable if n.all_recognised)
    return Decision(verdict_by_probability(probability), best, likely(probable), False)


def verdict_by_probability(probability: float) -> Verdict:
    """Verdict where the best explanation, of this probability, leaves nothing but noise."""
    return "IDENTIFIED" if probability >= SURE else "AMBIGUOUS"


def verdict_by_share(share: float) -> Verdict:
    """Verdict where something remains beside named effects that explain this share."""
    return "MOSTLY_EXPLAINED" if share >= MOSTLY else "UNKNOWN_PHYSICS"


def named_if_close(search: Search, decision: Decision, nearly_all: float = np.inf) -> Decision:
    """Take the best structure of named effects where it is as good as one with unnamed shapes.

    It is where it is hardly less likely, what may be error of its laws counted, or explains nearly
    all that the other one does.

    Parameters
    ----------
    search : Search
        Search of a stage, judged against the error of its models.
    decision : Decision
        Which structure it is by the evidence.
    nearly_all : float
        Share of what that one explains, from which a named structure is taken however much less
        likely it is.

    Returns
    -------
    Decision
        The same, or AMBIGUOUS with the named structures as explanations.
    """
    if not decision.unexplained or decision.best is None:
        return decision
    listed = search.explanations()
    named = [each for each in listed if search.suffices(each) and each.all_recognised]
    if not named:
        return decision
    close = _with_its_errors(search, named[0], listed) >= decision.best.score - CLOSE_TO_UNNAMED
    if not close and _explained_of(search, named[0], decision.best) < nearly_all:
        return decision
    return Decision("AMBIGUOUS", named[0], likely(probabilities(named)), False)


def _with_its_errors(search: Search, named: Candidate, listed: list[Candidate]) -> float:
    """Log odds of named effects, or of these and what may be error of their laws if that is more.

    A structure that holds hardly more than a sufficient one is no explanation of its own. But a
    rival has to be likelier than that as well, since it may hold such errors too.

    Parameters
    ----------
    search : Search
        After it has run.
    named : Candidate
        Sufficient structure of named effects.
    listed : list of Candidate
        Explanations of their own, which give no support.

    Returns
    -------
    float
        In nat.
    """

    def holds(other: Candidate) -> bool:
        names = {n for n, own in zip(other.fit.names, other.recognised, strict=True) if own}
        return named.names <= names and other not in listed

    return max([named.score, *(each.score for each in search.visited.values() if holds(each))])


def _explained_of(search: Search, named: Candidate, best: Candidate) -> float:
    """Mean square that one structure explains over what another one does.

    Parameters
    ----------
    search : Search
        Search of a stage; what it starts from is explained already.
    named, best : Candidate
        The one and the other.

    Returns
    -------
    float
        Minus infinity where the other one explains nothing.
    """
    left = search.start.fit.rmse_deg**2
    most = left - best.fit.rmse_deg**2
    return float((left - named.fit.rmse_deg**2) / most) if most > 0.0 else -np.inf


def probabilities(candidates: list[Candidate]) -> list[tuple[Candidate, float]]:
    """Posterior probability of each of some structures, of which one is taken to be right.

    Parameters
    ----------
    candidates : list of Candidate
        Most probable first, at least one.

    Returns
    -------
    list of (Candidate, probability)
    """
    score = np.array([candidate.score for candidate in candidates])
    probability = np.exp(score - score.max())
    probability /= probability.sum()
    return list(zip(candidates, map(float, probability), strict=True))


def with_further_rivals(
    rivals: list[tuple[Candidate, float]], further: list[tuple[Candidate, float]]
) -> list[tuple[Candidate, float]]:
    """Rivals of an accepted structure, and further ones by their odds over it.

    Parameters
    ----------
    rivals : list of (Candidate, probability)
        Other explanations that are known.
    further : list of (Candidate, float)
        Structures with their odds over the accepted one. Of several of the same effects the
        likeliest counts, and none that is a known rival already.

    Returns
    -------
    list of (Candidate, probability)
    """
    seen, new = {candidate.names for candidate, _ in rivals}, list[tuple[Candidate, float]]()
    for candidate, odds in sorted(further, key=lambda each: -each[1]):
        if candidate.names not in seen:
            seen.add(candidate.names)
            new.append((candidate, odds))
    left = 1.0 - sum(share for _, share in rivals)
    whole = 1.0 + sum(odds for _, odds in new)
    return [*rivals, *((candidate, left * odds / whole) for candidate, odds in new)]


def likely(probable: list[tuple[Candidate, float]]) -> list[tuple[Candidate, float]]:
    """The most probable structures that together have a probability of `COVERAGE`.

    Parameters
    ----------
    probable : list of (Candidate, probability)
        Most probable first.

    Returns
    -------
    list of (Candidate, probability)
    """
    sums = np.cumsum([probability for _, probability in probable])
    return probable[: int(np.searchsorted(sums, COVERAGE)) + 1]


def decide_in_stages(search: Search, explained_share: float) -> Decision:
    """Verdict where effects were accepted in stages, against the error of their models.

    Parameters
    ----------
    search : Search
        The search of the last stage.
    explained_share : float
        Share of the mismatch that the accepted structure explains.

    Returns
    -------
    Decision
        IDENTIFIED, or AMBIGUOUS, where the accepted effects leave nothing but noise,
        MOSTLY_EXPLAINED where they explain nine tenths or more, else UNKNOWN_PHYSICS.
    """
    best = search.chosen or search.start
    probability = 1.0 - sum(share for _, share in search.rivals_of_start)
    own = (best, probability)
    explanations = likely(sorted([own, *search.rivals_of_start], key=lambda each: -each[1]))
    explanations += [own] if own not in explanations else []
    if search.suffices(best) and best.fit.noise.model_error_factor == 1.0:
        return Decision(verdict_by_probability(probability), best, explanations, False)
    return Decision(verdict_by_share(explained_share), best, explanations, True)


def accepted_in_stages(search: Search) -> Candidate | None:
    """The structure that a search in stages accepted.

    Parameters
    ----------
    search : Search
        After it has run.

    Returns
    -------
    Candidate or None
        None where structures are compared by their evidence.
    """
    if search.noise.structured or search.start is not search.baseline:
        return search.chosen or search.start
    return None


def no_more_than_fits(
    decision: Decision, accepted: Candidate, search: Search, explained_share: float
) -> Decision:
    """Verdict without the claim that nothing is left, where the error says otherwise.

    A fit may end in a bad optimum; what it leaves then passes tests that look for other shapes.

    Parameters
    ----------
    decision : Decision
        Verdict by the tests.
    accepted : Candidate
        The structure that it names.
    search : Search
        With the noise.
    explained_share : float
        Share of the mismatch that the accepted structure explains.

    Returns
    -------
    Decision
        The same where the verdict claims no more than the error allows.
    """
    claims = decision.verdict in ("IDENTIFIED", "AMBIGUOUS")
    if not claims or accepted.fit.rmse_deg <= WITHIN_NOISE * search.noise.spread_deg:
        return decision
    return replace(decision, verdict=verdict_by_share(explained_share), unexplained=True)
