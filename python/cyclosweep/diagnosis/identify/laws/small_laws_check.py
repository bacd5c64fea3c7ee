"""Small laws beside a large one, whose law's error they may be.

No law of the literature is another one: stiffening as by Hertz and as by a logarithm differ by some
hundredths. Where the larger effect is far above the noise, a small law of the same class takes up
what the larger one's law misses, leaves nothing, and is no effect. So does one of another class
that the whole class of the larger one can replace, as a wave along the travel of the mesh on a
recording in which the twist is one curve of the torque.
"""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.laws.class_comparison import most_missed
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LEAST_LEFT,
    LEAST_OF_CLASS,
    LOUD_LAW,
    LawBeside,
    LawCheck,
    own_classes,
    size_of_class,
    withdrawn_where,
)
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.simulation.effects.history import Floats

HALF = 0.5
"""Share of the evidence of a law of little evidence that has to be left beside a class."""
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
    size = {
        t.name: recalibrated_twist(fitted, k)
        for k, t in enumerate(fitted.terms)
        if t.name in judged
    }

    def least_beside(name: str, other: str) -> float:
        curves = not (terms[name].slips or terms[other].slips)
        alike = curves and np.corrcoef(size[name], size[other])[0, 1] > ALIKE
        return 1.0 if alike else LEAST_OF_CLASS

    def is_small(name: str) -> bool:
        least = (
            (least_beside(name, other) * float(np.std(size[other])), terms[other])
            for other in size
            if other != name and _signal_to_noise(fitted, size[other]) > LOUD_LAW
        )
        return float(np.std(size[name])) < size_of_class(terms[name], least)

    errors = errors_of_larger(fitted)
    return withdrawn_where(lambda name: name in errors or is_small(name), checks)


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
    laws = [k for k, term in enumerate(fitted.terms) if term.effect is not None]
    sizes = {k: recalibrated_twist(fitted, k) for k in laws}
    spread = {k: float(np.std(size)) for k, size in sizes.items()}
    own = {k: own_classes(fitted.terms[k]) for k in laws}
    loud = [k for k in laws if _signal_to_noise(fitted, sizes[k]) > LOUD_LAW]
    larger = {
        k: {name for j in loud if spread[k] < most_missed(own[j]) * spread[j] for name in own[j]}
        for k in laws
    }
    small = [k for k in laws if larger[k]]
    if not small:
        return frozenset()
    classes = ClassColumns.of(fitted)

    def is_replaced(k: int) -> bool:
        law, known = LawBeside.of(fitted, classes, [k]), larger[k] & set(classes.columns)
        if law.evidence <= 0.0:
            return bool(known)
        # Beside a large model error a law has little evidence: that alone does not replace it.
        least = min(LEAST_LEFT, HALF * law.evidence)
        return any(law.is_replaced(classes, name, least) for name in known)

    return frozenset(fitted.terms[k].name for k in small if is_replaced(k))


def _signal_to_noise(fitted: FittedStructure, size_deg: Floats) -> float:
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
