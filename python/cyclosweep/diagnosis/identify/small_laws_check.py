"""Small laws beside a large one, whose law's error they may be.

No law of the literature is another one: stiffening as by Hertz and as by a logarithm differ by some
hundredths. Where the larger effect is far above the noise, a small law of the same class takes up
what the larger one's law misses, leaves nothing, and is no effect. So does one of another class
that the whole class of the larger one can replace, as a wave along the travel of the mesh on a
recording in which the twist is one curve of the torque.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.class_check import most_missed
from cyclosweep.diagnosis.identify.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.law_in_class import (
    LEAST_OF_CLASS,
    LawBeside,
    LawCheck,
    own_classes,
    share_class,
)
from cyclosweep.diagnosis.identify.testability import size_of
from cyclosweep.simulation.effects.history import Floats

LOUD = 100.0
"""Signal-to-noise ratio of the larger one from which its law's error counts."""
ALIKE = 0.8
"""Correlation of the twist by two laws of a class from which both together make one curve, whatever
their sizes; loops of friction are told apart by how they open."""


def without_small_laws(fitted: FittedStructure, checks: Sequence[LawCheck]) -> tuple[LawCheck, ...]:
    """Withdraw laws that are small beside a loud one of the same class, or look like it.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    checks : sequence of LawCheck
        Of its laws.

    Returns
    -------
    tuple of LawCheck
    """
    judged = {check.name for check in checks}
    terms = {term.name: term for term in fitted.terms if term.name in judged}
    size = {t.name: size_of(fitted, k) for k, t in enumerate(fitted.terms) if t.name in judged}

    def least_beside(name: str, other: str) -> float:
        curves = not (terms[name].slips or terms[other].slips)
        alike = curves and np.corrcoef(size[name], size[other])[0, 1] > ALIKE
        return 1.0 if alike else LEAST_OF_CLASS

    def is_small(name: str) -> bool:
        return any(
            share_class(terms[name], terms[other])
            and np.std(size[name]) < least_beside(name, other) * np.std(size[other])
            and _visibility(fitted, size[other]) > LOUD
            for other in size
            if other != name
        )

    errors = errors_of_larger(fitted)
    return tuple(
        replace(c, holds=False) if c.name in errors or is_small(c.name) else c for c in checks
    )


def errors_of_larger(fitted: FittedStructure) -> frozenset[str]:
    """Names of laws that may be no more than the error of a much larger one's law.

    Parameters
    ----------
    fitted : FittedStructure
        A structure.

    Returns
    -------
    frozenset of str
        Laws far smaller than another, of which little is left beside the whole class of the other.
    """
    size = [size_of(fitted, k) for k in range(len(fitted.terms))]
    found = set[str]()
    for k, term in enumerate(fitted.terms):
        if term.effect is None:
            continue
        larger = {
            behaviour
            for j, other in enumerate(fitted.terms)
            if other.effect is not None
            and np.std(size[k]) < most_missed(own_classes(other)) * np.std(size[j])
            and _visibility(fitted, size[j]) > LOUD
            for behaviour in own_classes(other)
        }
        if not larger:
            continue
        classes = ClassColumns.of(fitted)
        law = LawBeside.of(fitted, classes, [k])
        if any(law.is_replaced(classes, each) for each in larger & set(classes.columns)):
            found.add(term.name)
    return frozenset(found)


def _visibility(fitted: FittedStructure, size_deg: Floats) -> float:
    """Signal-to-noise ratio of a part of the twist.

    Parameters
    ----------
    fitted : FittedStructure
        The structure, with the noise.
    size_deg : ndarray, shape (fitted,)
        Part of the twist [deg].

    Returns
    -------
    float
    """
    return float(np.linalg.norm(fitted.whitened(size_deg, fitted.noise.plain)))
