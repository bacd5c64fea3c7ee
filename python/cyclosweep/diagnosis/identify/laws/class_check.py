"""Whether a named law stands for its class of behaviour, and which classes a residual shows.

A law is named only where it explains as much as its whole class could: a neighbour that takes the
place of a law that is on no list explains less than the flexible group of the class does, or a
flexible group of another class explains it better.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_comparison import CLEAR, ClassComparison
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.laws.dial_check import without_other_dials
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LawCheck,
    own_classes,
    withdrawn_where,
)
from cyclosweep.diagnosis.identify.laws.run_offsets_check import (
    without_any_offsets,
    without_leftovers,
)
from cyclosweep.diagnosis.identify.laws.scatter_check import without_widest_scatter
from cyclosweep.diagnosis.identify.structures.starting_terms import TIED_DIGITS
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.simulation.effects.history import Floats

MOST_CLASSES = 4
"""Classes that are looked for in a residual."""
LEAST_SIZE = 0.1
"""Size of a class over that of the largest from which it is listed."""


@dataclass(frozen=True, slots=True)
class ShownClass:
    """A class of behaviour that a residual shows.

    Attributes
    ----------
    behaviour : str
        Its name.
    evidence : float
        Log evidence, classes found before it taken out [nat].
    visibility : float
        Signal-to-noise ratio of what it explains.
    """

    behaviour: str
    evidence: float
    visibility: float


def check_laws(fitted: FittedStructure, stand_ins: Sequence[LawCheck] = ()) -> tuple[LawCheck, ...]:
    """Compare the laws of a structure with the flexible groups of all classes.

    Laws that share a class are compared with it together: two laws make any curve.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    stand_ins : sequence of LawCheck
        Laws of the structure that were found not to hold. They stay in it, and the others are
        compared beside the whole of their classes, so that no law is named for their errors.

    Returns
    -------
    tuple of LawCheck
        One for each other term that has the law of an effect.
    """
    withdrawn = {each.name for each in stand_ins}
    groups: list[tuple[list[int], set[str]]] = []
    for index, term in enumerate(fitted.terms):
        if term.effect is None or term.name in withdrawn:
            continue
        indices, own = [index], set(own_classes(term))
        for other in [each for each in groups if each[1] & own]:
            groups.remove(other)
            indices, own = other[0] + indices, own | other[1]
        groups.append((indices, own))
    if not groups:
        return ()
    classes = ClassColumns.of(fitted)
    taken = {each.behaviour for each in stand_ins if each.behaviour}
    for term in fitted.terms:
        taken |= set(own_classes(term)) if term.name in withdrawn else set()
    sizes = [recalibrated_twist(fitted, index) for index in range(len(fitted.terms))]
    compared = [
        ClassComparison.of(fitted, classes, indices, own, taken - own, _size_over(sizes, indices))
        for indices, own in groups
    ]
    alone = [check for each in compared for check in each.checks()]
    checks = withdrawn_where(_smaller_than_errors(compared).__contains__, alone)
    judged = without_any_offsets(fitted, without_leftovers(fitted, classes, checks))
    return without_widest_scatter(fitted, without_other_dials(fitted, judged))


def _smaller_than_errors(compared: Sequence[ClassComparison]) -> frozenset[str]:
    """Names of laws with less evidence than what a larger law misses inside its own classes.

    The error of a law reaches into other classes, too: what is smaller than its error where it is
    known may be its error elsewhere. The terms of a whole loop were chosen by what they predict.

    Parameters
    ----------
    compared : sequence of ClassComparison
        Of all laws of a structure, each with those of its class.

    Returns
    -------
    frozenset of str
    """
    small = set[str]()
    for each in compared:
        larger = [other for other in compared if other.by_law > each.by_law]
        missed = max((left.evidence for other in larger for left in other.left), default=0.0)
        if each.by_law < missed and each.fitted.independent_share == 1.0:
            small |= {each.fitted.terms[index].name for index in each.indices}
    return frozenset(small)


def shown_classes(fitted: FittedStructure) -> tuple[ShownClass, ...]:
    """Classes that the residual of a structure shows, each found beside those before it.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.

    Returns
    -------
    tuple of ShownClass
        Strongest evidence first; those far smaller than the largest are left out.
    """
    classes = ClassColumns.of(fitted)
    known, residual = fitted.tangent, classes.scale * fitted.residual
    found: list[ShownClass] = []
    for _ in range(MOST_CLASSES):
        taken = {each.behaviour for each in found}
        every = {
            name: classes.evidence(name, known, residual)
            for name in classes.columns
            if name not in taken
        }
        # Runs that are each at a place of their own are the same as their places.
        best = max(every, key=lambda name: round(every[name].evidence, TIED_DIGITS), default=None)
        if best is None or every[best].evidence < CLEAR:
            break
        found.append(ShownClass(best, every[best].evidence, float(np.sqrt(every[best].explained))))
        known = classes.beside(known, best)
        residual = residual - known @ (known.T @ residual)
    largest = max((each.visibility for each in found), default=0.0)
    return tuple(each for each in found if each.visibility >= LEAST_SIZE * largest)


def candidates_of(behaviour: str, library: Library) -> tuple[str, ...]:
    """Effects of a library that belong to a class.

    Parameters
    ----------
    behaviour : str
        Name of the class.
    library : Library

    Returns
    -------
    tuple of str
    """
    found = (
        each.hypothesis
        for each in library.signatures
        if each.effect is not None and behaviour in own_classes(Term(each.effect, each.shape))
    )
    return tuple(dict.fromkeys(found))


def _size_over(sizes: Sequence[Floats], indices: Sequence[int]) -> float:
    """Size of the largest other law over that of some laws together, as root mean squares.

    Parameters
    ----------
    sizes : sequence of ndarray, shape (n,)
        Twist by each law of a structure, calibration taken out [deg].
    indices : sequence of int
        Which of them.

    Returns
    -------
    float
        Zero where there is no other law.
    """
    own = np.sum([sizes[index] for index in indices], axis=0)
    others = [each for k, each in enumerate(sizes) if k not in indices]
    largest = max((float(np.std(each)) for each in others), default=0.0)
    return largest / max(float(np.std(own)), 1e-300)
