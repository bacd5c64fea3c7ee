"""Other laws in the place of those that stages accepted.

A stage accepts a law while much is still unexplained, and its error of the model hides how two laws
of one class of behaviour differ. Once everything else is known the difference shows.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from cyclosweep.diagnosis.hypotheses.behaviour_classes import EVEN_CURVE, ODD_CURVE
from cyclosweep.diagnosis.identify.candidate import Candidate
from cyclosweep.diagnosis.identify.class_check import LITTLE_MISSED, check_laws
from cyclosweep.diagnosis.identify.enrichment import freer_laws
from cyclosweep.diagnosis.identify.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.law_in_class import (
    BOTH_CURVES,
    makes_others_grow,
    own_classes,
    share_class,
)
from cyclosweep.diagnosis.identify.search import Search
from cyclosweep.diagnosis.identify.terms import Term

CLEARLY = 3.0
"""Log evidence by which another law has to be ahead of the one that was accepted [nat]."""
ERROR_OF_LAWS = 0.05
"""The same as a share of the evidence of the accepted one: no law is exact, and of two of a loud
effect the one that errs less need not be the right one."""

LEAST_LEFT = 0.1
"""What is left beyond the noise counts from this share of the noise."""
FAR_LESS = 0.5
"""What another law leaves beyond the noise, over what the accepted one leaves, from which it takes
its place although the error of models that is allowed for makes both alike; or what it misses of
its class over what the accepted one misses, from which a small lead is enough."""


def with_better_laws(search: Search) -> FittedStructure:
    """Put other laws in the place of accepted ones where the recording is likelier with them.

    Parameters
    ----------
    search : Search
        Of the last stage; its ``start`` holds what was accepted.

    Returns
    -------
    FittedStructure
        That structure, or one with other laws of the same classes.
    """
    fitted = search.start.fit
    for name in fitted.names:
        term = next(each for each in fitted.terms if each.name == name)
        rivals = [] if term.effect is None or term.slips else list(rivals_of(search, fitted, term))
        if not rivals:
            continue
        others = tuple(each for each in fitted.terms if each is not term)
        parent = search.refit(others, fitted) if others else search.baseline
        own = _extended(search, parent, name)
        tried = [child for each in rivals if (child := _extended(search, parent, each)) is not None]
        tried = [_in_whole_class(search, child) for child in tried]
        if _is_dial(term):
            tried += list(_pairs(search, tried))
            tried += [] if own is None else [_in_whole_class(search, own)]
        if own is not None and own.fit.loss < fitted.loss - 2.0 * CLEARLY:
            # Beside everything else the accepted law has been given more freedom.
            fitted = own.fit
        best = max(tried, key=lambda child: child.score, default=None)
        if best is None or not best.all_recognised or best.fit.loss >= fitted.loss:
            continue
        if any(makes_others_grow(best.fit, k, fitted) for k in range(len(best.fit.terms))):
            continue
        ahead = best.score - _score(own)
        leaves_less = left_beyond_noise(best.fit) < FAR_LESS * left_beyond_noise(fitted)
        clearly = max(CLEARLY, ERROR_OF_LAWS * _score(own))
        better = ahead > clearly or (leaves_less and ahead > -CLEARLY)
        if better or (own is not None and ahead > CLEARLY and misses_far_less(best.fit, own.fit)):
            fitted = best.fit
    return fitted


def misses_far_less(other: FittedStructure, own: FittedStructure) -> bool:
    """Whether the last law of a structure misses far less of its class than that of another.

    Parameters
    ----------
    other : FittedStructure
        Structure with another law in the last place.
    own : FittedStructure
        Structure with the accepted law there.

    Returns
    -------
    bool
        False unless all laws of the other structure may be named, it has as many as this one, and
        the accepted law misses more than any law may.
    """
    if len(other.terms) != len(own.terms):
        return False
    accepted = next(check for check in check_laws(own) if check.name == own.names[-1])
    if accepted.missed_share < LITTLE_MISSED:
        return False
    checks = {check.name: check for check in check_laws(other)}
    missed = checks[other.names[-1]].missed_share
    return all(each.holds for each in checks.values()) and missed < FAR_LESS * accepted.missed_share


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


def _in_whole_class(search: Search, child: Candidate) -> Candidate:
    """Give a dial that a structure got last the form that holds nearly its whole class.

    An eccentric dial is hardly ever without a tilt, and the search offers it without.

    Parameters
    ----------
    search : Search
    child : Candidate

    Returns
    -------
    Candidate
        The same for another law, and where the evidence does not prefer that form.
    """
    last = len(child.fit.terms) - 1
    effect = child.fit.terms[last].effect
    if effect is None or not _is_dial(child.fit.terms[last]):
        return child
    richer = search.first_better(child, freer_laws(child, search.library, last, whole_class=True))
    if richer is None:
        return child
    before, after = (each.fit.terms[last].shape for each in (child, richer))
    return replace(richer, prior=richer.prior - effect.penalty(after) + effect.penalty(before))


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
    """Effects of the same class as a term that are not part of the structure.

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
    for name, signature in search.library.effects.items():
        effect = signature.effect
        if effect is None or effect.slips or name in fitted.names:
            continue
        if share_class(term, Term(effect, signature.shape)):
            yield name
