"""Classes of behaviour that a term belongs to, and the effects that look like it."""

from collections.abc import Collection, Iterator

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_EFFECT,
    CLASSES_OF_FAMILY,
    EVEN_CURVE,
    LOOP,
    ODD_CURVE,
    OPENING_LOOP,
)
from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.terms import Term

BOTH_CURVES = frozenset({ODD_CURVE, EVEN_CURVE})
"""Classes of an effect whose twist has an odd and an even part, as an eccentric dial's."""


def own_classes(term: Term) -> tuple[str, ...]:
    """Classes of behaviour that a term of an effect belongs to.

    Parameters
    ----------
    term : Term

    Returns
    -------
    tuple of str
        None for an effect of a family that is no class.
    """
    assert term.effect is not None
    if not term.slips:
        return CLASSES_OF_EFFECT.get(term.name) or CLASSES_OF_FAMILY.get(term.family, ())
    plain, loaded = term.effect.friction_limits(term.shape)
    return (LOOP,) * (plain > 0) + (OPENING_LOOP,) * (loaded > 0)


def share_class(one: Term, other: Term) -> bool:
    """Whether two terms are effects of the same class of behaviour.

    Parameters
    ----------
    one : Term
    other : Term

    Returns
    -------
    bool
    """
    if one.effect is None or other.effect is None:
        return False
    return bool(set(own_classes(one)) & set(own_classes(other)))


def look_alikes(library: Library, names: Collection[str], term: Term) -> Iterator[str]:
    """Effects of the same class as a term that are not part of its structure.

    Parameters
    ----------
    library : Library
    names : collection of str
        Names of the terms of the structure.
    term : Term
        One of them.

    Yields
    ------
    str
    """
    for name, signature in library.effects.items():
        effect = signature.effect
        if effect is None or effect.slips or name in names:
            continue
        if share_class(term, Term(effect, signature.shape)):
            yield name
