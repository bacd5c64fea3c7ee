"""Richer shapes of the effects of a structure, offered where its residual asks for them."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.scan import evidence
from cyclosweep.simulation.effects.base import Shape
from cyclosweep.simulation.effects.orders import more_than_positions

MOST_BESIDE_FRICTION = 2
"""Most shape parameters by which a law gets richer at once beside friction."""
TRIED = 3
"""Shapes of an effect that are tried, those that explain most of the residual."""


def richer_structures(
    candidate: Candidate,
    library: Library,
    threshold: float,
    *,
    suffices: bool,
    accepted: frozenset[str],
) -> Iterator[tuple[tuple[Term, ...], int]]:
    """Structures in which one effect has more freedom of shape.

    Parameters
    ----------
    candidate : Candidate
        The structure.
    library : Library
        All hypotheses.
    threshold : float
        Excess of an effect's own shapes beyond which it is given more freedom [nat].
    suffices : bool
        Whether the structure leaves nothing but noise. Friction is given more freedom whatever the
        residual looks like, where it does not: what a law of friction misses looks like loops,
        curves and drifts.
    accepted : frozenset of str
        Names of terms whose freedom was decided before.

    Yields
    ------
    terms : tuple of Term
    rank : int
        Parameters added, at least one.
    """
    terms = candidate.fit.terms
    slips = [k for k, term in enumerate(terms) if term.slips]
    if slips and not suffices and terms[slips[0]].name not in accepted:
        for freer in _freer_frictions(terms[slips[0]], candidate, alone=len(slips) == 1):
            yield _with_term(terms, slips[0], freer), 1
    for k, term in enumerate(terms):
        if term.effect is None or term.slips:
            continue
        if candidate.excesses.get(term.name, 0.0) > threshold:
            yield from freer_laws(candidate, library, k)


def freer_laws(
    candidate: Candidate,
    library: Library,
    index: int,
    costly: int = 1,
    *,
    whole_class: bool = False,
) -> Iterator[tuple[tuple[Term, ...], int]]:
    """Structures in which the law of one effect has more freedom of shape.

    Parameters
    ----------
    candidate : Candidate
        The structure.
    library : Library
        All hypotheses.
    index : int
        Which of its terms.
    costly : int
        Most offers of more shape parameters beside friction, where each costs a path of the shaft
        in every step of a fit.
    whole_class : bool
        Whether shapes are offered, too, that hold nearly their whole class, such as free offsets
        of the runs.

    Yields
    ------
    terms : tuple of Term
    rank : int
        Parameters added, at least one.
    """
    found, terms = candidate.scan, candidate.fit.terms
    term = terms[index]
    if term.effect is None:
        return
    if term.name in found.groups:
        members = found.groups[term.name]
        each = evidence(found.observed[members], found.ranks[members])
        members = members[np.argsort(-each)]
    else:
        # The term explains whatever its other shapes on the grid could.
        own = [signature.hypothesis == term.name for signature in library.signatures]
        members = np.flatnonzero(own)
    slips = any(other.slips for other in terms)
    before = _freedom(term, term.shape, candidate)
    tried: list[Shape] = []
    for member in members:
        shape = term.effect.combined(term.shape, library.signatures[member].shape)
        if shape is None or shape in tried or more_than_positions(candidate.fit.history, shape):
            continue
        if term.effect.penalty(shape) > 0.0 and not whole_class:
            continue
        if len(tried) == TRIED:
            return
        tried.append(shape)
        after = _freedom(term, shape, candidate)
        if slips and after[1] > before[1]:
            if costly == 0 or after[1] > before[1] + MOST_BESIDE_FRICTION:
                continue
            costly -= 1
        freer = _with_term(terms, index, replace(term, shape=shape))
        yield freer, max(sum(after) - sum(before), 1)


def freer_friction(term: Term) -> Term | None:
    """Friction that may forget its turning points; None for another term, and where it may."""
    shape = term.effect.combined(term.shape, {}) if term.effect is not None and term.slips else None
    return None if shape is None else replace(term, shape=shape)


def _freer_frictions(term: Term, candidate: Candidate, *, alone: bool) -> Iterator[Term]:
    """Frictions of one more shape parameter.

    Parameters
    ----------
    term : Term
        A friction.
    candidate : Candidate
        Structure with it.
    alone : bool
        Whether it is the only friction, so that its limit may be no line of the load.

    Yields
    ------
    Term
    """
    freer = freer_friction(term)
    if freer is not None:
        yield freer
    if alone and term.effect is not None:
        for shape in term.effect.refinements(candidate.fit.history, term.shape):
            yield replace(term, shape=shape)


def _freedom(term: Term, shape: Shape, candidate: Candidate) -> tuple[int, int]:
    """Numbers of amplitudes and of shape parameters that are fitted.

    Parameters
    ----------
    term : Term
        Of a named effect.
    shape : mapping
        Shape that it is to have.
    candidate : Candidate
        Structure with the term.

    Returns
    -------
    tuple of int
    """
    assert term.effect is not None
    shapes = sum(parameter.name in shape for parameter in term.effect.shape_parameters)
    columns = replace(term, shape=shape).columns(candidate.fit.history)
    return columns.shape[1], shapes


def _with_term(terms: tuple[Term, ...], index: int, term: Term) -> tuple[Term, ...]:
    """Terms of which one is another.

    Parameters
    ----------
    terms : tuple of Term
    index : int
        Which of them.
    term : Term
        The other one.

    Returns
    -------
    tuple of Term
    """
    return (*terms[:index], term, *terms[index + 1 :])
