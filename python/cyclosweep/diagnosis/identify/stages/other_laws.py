"""Other laws in the place of those that stages accepted.

A stage accepts a law while much is still unexplained, and its error of the model hides how two laws
of one class of behaviour differ. Once everything else is known the difference shows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import permutations, product

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import EVEN_CURVE, ODD_CURVE
from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    BOTH_CURVES,
    makes_others_grow,
    own_classes,
    share_class,
)
from cyclosweep.diagnosis.identify.structures.candidate import Candidate, prior_penalty
from cyclosweep.diagnosis.identify.structures.enrichment import freer_laws
from cyclosweep.diagnosis.identify.structures.search import MOST_SHAPE_ERROR, SHAPE_ERROR, Search
from cyclosweep.diagnosis.identify.structures.verdict import decide
from cyclosweep.simulation.effects.friction_hysteresis import FrictionHysteresis

CLEARLY = 3.0
"""Log evidence by which another law has to be ahead of the one that was accepted [nat]."""
LEAST_LEFT = 0.1
"""What is left beyond the noise counts from this share of the noise."""
DELAYED = ("relaxation", "hysteresis")
"""Families of what may make the loop of friction, and of twist that comes late: at the end of a run
some of it may go on in the next."""
FAR_LESS = 0.5
"""What another law leaves beyond the noise, over what the accepted one leaves, from which it takes
its place although the error of models that is allowed for makes both alike."""


def with_better_laws(
    search: Search,
) -> tuple[FittedStructure, list[tuple[Candidate, float]]]:
    """Put other laws in the place of accepted ones where the recording is likelier with them.

    Parameters
    ----------
    search : Search
        Of the last stage; its ``start`` holds what was accepted.

    Returns
    -------
    fitted : FittedStructure
        That structure, or one with other laws of the same classes.
    rivals : list of (Candidate, float)
        Structures with one law less likely in the place of one of its own, each with its odds over
        it, error of the laws allowed for.
    """
    fitted = _with_dial_for_two(search, search.start.fit)
    rivals = list[tuple[Candidate, float]]()
    for name in fitted.names:
        term = next(each for each in fitted.terms if each.name == name)
        names = [] if term.effect is None or term.slips else list(rivals_of(search, fitted, term))
        if not names:
            continue
        others = tuple(each for each in fitted.terms if each is not term)
        parent = search.refit(others, fitted) if others else search.baseline
        own = _as_accepted(search, _extended(search, parent, name), fitted)
        tried = [child for each in names if (child := _extended(search, parent, each)) is not None]
        tried = [_in_whole_class(search, child) for child in tried]
        if _is_dial(term):
            tried += list(_pairs(search, tried))
            tried += [] if own is None else [_in_whole_class(search, own)]
        if own is not None and own.fit.loss < fitted.loss - 2.0 * CLEARLY:
            # Beside everything else the accepted law has been given more freedom.
            fitted = own.fit
        best = max(tried, key=lambda child: child.score, default=None)
        taken = best is not None and _takes_the_place(best, own, fitted)
        if taken and best is not None:
            fitted = best.fit
        if own is not None:
            same = fitted.names if taken else own.fit.names
            winner = max(
                (each for each in (own, *tried) if each.names == frozenset(same)),
                key=lambda each: each.score,
            )
            explained = parent.fit.loss - winner.fit.loss
            rivals += [
                (each, _odds(each.score - winner.score, explained))
                for each in (own, *tried)
                if each.names != winner.names and each.all_recognised
            ]
    present = frozenset(fitted.names)
    return fitted, [each for each in rivals if len(each[0].names ^ present) == 2]


def _as_accepted(
    search: Search, own: Candidate | None, fitted: FittedStructure
) -> Candidate | None:
    """Candidate of the accepted law, in the fit that was accepted where that is the better one.

    A fit anew from the other effects alone may end in a worse optimum, beside which any other law
    would seem to be likelier.

    Parameters
    ----------
    search : Search
    own : Candidate or None
        The accepted law fitted anew.
    fitted : FittedStructure
        What was accepted.

    Returns
    -------
    Candidate or None
    """
    if own is None or own.fit.loss <= fitted.loss or own.names != frozenset(fitted.names):
        return own
    charges = [
        sum(prior_penalty(each.name, each.effect, each.shape) for each in fit.terms)
        for fit in (own.fit, fitted)
    ]
    gain = own.gain + 0.5 * search.chi2_gain(own.fit, fitted)
    return search.judged(fitted, gain, own.prior + charges[0] - charges[1])


def _takes_the_place(best: Candidate, own: Candidate | None, fitted: FittedStructure) -> bool:
    """Whether a structure with another law is likelier, and no other effect grows by it.

    Parameters
    ----------
    best : Candidate
        Structure with the best other law.
    own : Candidate or None
        The same with the accepted law, fitted in the same way.
    fitted : FittedStructure
        What was accepted.

    Returns
    -------
    bool
    """
    if not best.all_recognised or best.fit.loss >= fitted.loss:
        return False
    if any(makes_others_grow(best.fit, k, fitted) for k in range(len(best.fit.terms))):
        return False
    ahead = best.score - _score(own)
    leaves_less = left_beyond_noise(best.fit) < FAR_LESS * left_beyond_noise(fitted)
    return ahead > CLEARLY or (leaves_less and ahead > -CLEARLY)


def _odds(ahead: float, explained: float) -> float:
    """Odds of one law over another, none of which is exact.

    Parameters
    ----------
    ahead : float
        Log evidence by which it is ahead [nat].
    explained : float
        Chi-squared that the other one explains.

    Returns
    -------
    float
        No more than one: that one has been preferred.
    """
    error = min(0.5 * SHAPE_ERROR**2 * max(explained, 0.0), MOST_SHAPE_ERROR)
    return float(np.exp(min(ahead, 0.0) / (1.0 + error)))


def visit_rivals(search: Search) -> None:
    """Fit the rivals of each effect of the best structure in its place, and dials with a tilt.

    So is what stands for a side load and an odd curve together, which is a dial. A search in
    breadth follows the likeliest structures, and offers a dial without a tilt.

    Parameters
    ----------
    search : Search
        After it has run from the baseline.
    """
    best = decide(search).best
    if best is None:
        return
    near = [best.names]
    for part in [(t,) for t in best.fit.terms] + _even_with_odd(best.fit):
        rest = best.names - {term.name for term in part}
        parent = search.visited.get(rest) if rest else search.baseline
        if any(term.effect is None or term.slips for term in part) or parent is None:
            continue
        of_one = [set(rivals_of(search, best.fit, term)) for term in part]
        rivals = [name for name in search.library.effects if all(name in own for own in of_one)]
        for name in rivals:
            if rest | {name} not in search.visited:
                _extended(search, parent, name)
        near += [rest, *(rest | {name} for name in rivals)]
    for candidate in [search.visited[names] for names in near if names in search.visited]:
        for index in range(len(candidate.fit.terms)):
            whole = _in_whole_class(search, candidate, index)
            if whole is not candidate:
                search.visited[whole.names] = whole


def _with_dial_for_two(search: Search, fitted: FittedStructure) -> FittedStructure:
    """Put one law with an odd and an even part in the place of two, where it is likelier.

    Parameters
    ----------
    search : Search
    fitted : FittedStructure
        What was accepted.

    Returns
    -------
    FittedStructure
        The same, or one with a dial in the place of a side load and an odd curve.
    """
    for pair in _even_with_odd(fitted):
        others = tuple(each for each in fitted.terms if each not in pair)
        parent = search.refit(others, fitted) if others else search.baseline
        own = max(
            (found for order in permutations(pair) if (found := _both(search, parent, order))),
            key=lambda found: found.score,
            default=None,
        )
        for name in rivals_of(search, fitted, pair[0]):
            other = _extended(search, parent, name)
            if own is None or other is None or not _is_dial(other.fit.terms[-1]):
                continue
            other = _in_whole_class(search, other)
            if any(makes_others_grow(other.fit, k, fitted) for k in range(len(other.fit.terms))):
                continue
            if other.all_recognised and other.score > own.score + CLEARLY:
                return other.fit
    return fitted


def _even_with_odd(fitted: FittedStructure) -> list[tuple[Term, ...]]:
    """Pairs of a side load and an odd curve, which a dial makes alone."""
    curves = [t for t in fitted.terms if t.effect is not None and not t.slips]
    even = [t for t in curves if own_classes(t) == (EVEN_CURVE,)]
    odd = [t for t in curves if own_classes(t) == (ODD_CURVE,)]
    return list(product(even, odd))


def _both(search: Search, parent: Candidate, pair: Sequence[Term]) -> Candidate | None:
    """Add two effects to a structure, in this order.

    Parameters
    ----------
    search : Search
    parent : Candidate
    pair : sequence of Term

    Returns
    -------
    Candidate or None
    """
    first, second = (term.name for term in pair)
    one = _extended(search, parent, first)
    return None if one is None else _extended(search, one, second)


def _extended(search: Search, parent: Candidate, name: str) -> Candidate | None:
    """Add an effect to a structure; None where its residual shows nothing of it.

    Parameters
    ----------
    search : Search
    parent : Candidate
    name : str
        Name of the effect.

    Returns
    -------
    Candidate or None
    """
    return search.extend(parent, name) if name in parent.scan.groups else None


def _is_dial(term: Term) -> bool:
    """Whether a law has an odd and an even part, as that of an eccentric dial."""
    return set(own_classes(term)) >= BOTH_CURVES


def _in_whole_class(search: Search, child: Candidate, index: int = -1) -> Candidate:
    """Give a dial of a structure the form that holds nearly its whole class.

    An eccentric dial is hardly ever without a tilt, and the search offers it without.

    Parameters
    ----------
    search : Search
    child : Candidate
    index : int
        Which of its terms, the last one unless told.

    Returns
    -------
    Candidate
        The same for another law, and where the evidence does not prefer that form.
    """
    index %= len(child.fit.terms)
    term = child.fit.terms[index]
    if term.effect is None or not _is_dial(term):
        return child
    richer = search.first_better(child, freer_laws(child, search.library, index, whole_class=True))
    if richer is None:
        return child
    before, after = (each.fit.terms[index].shape for each in (child, richer))
    charge = term.effect.penalty(after) - term.effect.penalty(before)
    charged = replace(richer, prior=richer.prior - charge)
    return charged if charged.score > child.score else child


def _pairs(search: Search, tried: Sequence[Candidate]) -> Iterator[Candidate]:
    """Structures with an even curve and an odd one, which together make the curve of a dial.

    Parameters
    ----------
    search : Search
    tried : sequence of Candidate
        Structures with one of them.

    Yields
    ------
    Candidate
    """
    last = [each.fit.terms[-1] for each in tried]
    even = [term.name for term in last if own_classes(term) == (EVEN_CURVE,)]
    for odd in tried:
        if own_classes(odd.fit.terms[-1]) != (ODD_CURVE,):
            continue
        for name in even:
            pair = _extended(search, odd, name)
            if pair is not None:
                yield pair


def left_beyond_noise(fitted: FittedStructure) -> float:
    """Root mean square of what a structure leaves beyond the noise, or a tenth of the noise.

    Parameters
    ----------
    fitted : FittedStructure

    Returns
    -------
    float
        In deg.
    """
    return max(beyond_noise_deg(fitted), LEAST_LEFT * fitted.noise.spread_deg)


def _score(candidate: Candidate | None) -> float:
    """Log odds of a candidate; none where nothing could be fitted."""
    return float("-inf") if candidate is None else candidate.score


def rivals_of(search: Search, fitted: FittedStructure, term: Term) -> Iterator[str]:
    """Effects that may take the place of a term, and are not part of the structure.

    They are of its class. Where nothing slips, friction may take the place of a drag or of a creep:
    beside the error of models that a first stage allows for, fewer parameters count for more than
    what is left of a loop.

    Parameters
    ----------
    search : Search
    fitted : FittedStructure
        The structure.
    term : Term
        One of its terms.

    Yields
    ------
    str
    """
    slips = any(each.slips for each in fitted.terms)
    for name, signature in search.library.effects.items():
        effect = signature.effect
        if effect is None or name in fitted.names:
            continue
        if effect.slips:
            if term.family in DELAYED and not slips and name == FrictionHysteresis.name:
                yield name
        elif share_class(term, Term(effect, signature.shape)):
            yield name
