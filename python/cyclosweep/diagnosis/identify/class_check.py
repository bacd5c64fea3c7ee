"""Whether a named law stands for its class of behaviour, and which classes a residual shows.

A law is named only where it explains as much as its whole class could: a neighbour that takes the
place of a law that is on no list explains less than the flexible group of the class does, or a
flexible group of another class explains it better.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_FAMILY,
    EVEN_CURVE,
    LOOP,
    ODD_CURVE,
    OPENING_LOOP,
    RATE_LOOP,
)
from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.scan import evidence, likelihood_gain
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.simulation.effects.history import Floats

LEAST_EVIDENCE = 0.5
"""Log evidence of its own that a law must have to be named [nat]. That something is missing was
decided before; a faint law, whose shape the recording leaves open, is charged too much for it."""
LEAST_LEFT = 3.0
"""Log evidence that has to be left of a law beside a rival class that explains more [nat]."""
FURTHER_LAW = 6.0
"""Log prior odds against each further law in the same class [nat], as in the search."""
SHAPE_CHARGE = 1.0
"""Log evidence that a parameter of a law's shape is charged, as is usual in the search [nat]."""
CLOSE = 1.6
"""Log evidence by which a class may be ahead of a law that is named [nat]: odds of five to one."""
CLOSE_OTHER = 4.0
"""The same for classes other than curves: their flexible groups hold some laws exactly, and they
have fewer twins."""
CLOSE_BESIDE = 1.5
"""What is added beside other laws, whose errors reach into every class [nat]."""
CLEARLY = 300.0
"""Log evidence of a law from which it is the law's own error that counts [nat]."""
CLOSE_SHARE, CLOSE_LOOP_SHARE = 0.005, 0.02
"""Share of the evidence beyond that by which the class may be ahead of curves, and of loops."""
LITTLE_MISSED = 0.05
"""What a law of more evidence may miss inside its class in any case, as root mean squares: where
the noise is small no law is exact, and flexible groups are."""
MOST_MISSED, MOST_MISSED_LOOP = 0.1, 0.25
"""What a named law may miss inside its class, as a share of both in root mean squares: laws of the
literature leave 0 to 0.1 of each other where they are curves, to 0.25 where they are loops."""
LEAST_SUM = 0.6
"""Size of the sum of laws in one class over that of the largest, below which they are not named."""
LEFT_BESIDE = 0.1
"""The same as a share of the law's evidence."""
CLEAR = 6.0
"""Log evidence from which a residual shows a class [nat]."""
MOST_CLASSES = 4
"""Classes that are looked for in a residual."""
LEAST_SIZE = 0.1
"""Size of a class over that of the largest from which it is listed."""


@dataclass(frozen=True, slots=True)
class LawCheck:
    """How a law stands to its class of behaviour.

    Attributes
    ----------
    name : str
        Effect whose law it is.
    behaviour : str
        Class that explains what the law explains, best of all; empty where the recording shows
        none.
    missed_share : float
        What the law misses inside its class over what both explain, as root mean squares.
    deficit : float
        Log evidence of the class over the law [nat].
    holds : bool
        Whether the law may be named.
    """

    name: str
    behaviour: str
    missed_share: float
    deficit: float
    holds: bool


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
    found = [_check(fitted, classes, indices, own, taken - own) for indices, own in groups]
    return tuple(check for group in found for check in group)


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
        return CLASSES_OF_FAMILY.get(term.family, ())
    plain, loaded = term.effect.friction_limits(term.shape)
    return (LOOP,) * (plain > 0) + (OPENING_LOOP,) * (loaded > 0)


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
        best = max(every, key=lambda name: every[name].evidence, default=None)
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


def _check(
    fitted: FittedStructure,
    classes: ClassColumns,
    indices: Sequence[int],
    own: Collection[str],
    taken: Collection[str] = (),
) -> list[LawCheck]:
    """Compare laws of the same class, together, with the flexible groups of all classes.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    classes : ClassColumns
        Columns of every class.
    indices : sequence of int
        Which of the structure's terms.
    own : collection of str
        Their classes.
    taken : collection of str
        Classes that are fitted whole beside them.

    Returns
    -------
    list of LawCheck
        One for each of the terms.
    """
    names = [fitted.terms[index].name for index in indices]
    places = [place for index in indices for place in _places(fitted, index)]
    amplitudes = sum(_amplitudes(fitted, index) for index in indices)
    charged = (amplitudes, len(places) - amplitudes)
    others = [k for k in range(fitted.sensitivity.shape[1]) if k not in places]
    known = orthonormal(fitted.sensitivity[:, others], 1e-6)
    tangent, whole_residual = fitted.tangent, classes.scale * fitted.residual
    for name in sorted(set(taken) & set(classes.columns)):
        known, tangent = classes.beside(known, name), classes.beside(tangent, name)
        whole_residual = whole_residual - tangent @ (tangent.T @ whole_residual)
    single = [
        classes.scale * fitted.whitened_contribution(index, fitted.noise) for index in indices
    ]
    law = np.sum(single, axis=0)
    cancels = _cancel(fitted, single)
    law = law - known @ (known.T @ law)
    residual = whole_residual + law
    residual = residual - known @ (known.T @ residual)
    by_law = _law_evidence(residual, law, charged, classes.freedom)
    every = {
        name: classes.evidence(name, known, residual)
        for name in classes.columns
        if name not in taken
    }
    family = [name for name in every if name in own]
    rivals = [name for name in every if name not in own]
    by_law -= FURTHER_LAW * (len(indices) - 1)
    deficit = max((every[name].evidence for name in family), default=-np.inf) - by_law
    left = [classes.evidence(k, tangent, whole_residual) for k in family]
    missed = max((each.explained for each in left), default=0.0)
    share = float(np.sqrt(missed / max(missed + float(law @ law), 1e-300)))
    replaced = False
    loop = bool({LOOP, OPENING_LOOP, RATE_LOOP} & set(own))
    close = CLOSE_BESIDE * (len(indices) < len(fitted.terms))
    close += CLOSE if {ODD_CURVE, EVEN_CURVE} & set(own) else CLOSE_OTHER
    beyond = max(by_law - CLEARLY, 0.0)
    rival = max(rivals, key=lambda name: every[name].evidence, default=None)
    if rival is not None and every[rival].evidence > by_law + close:
        beside = classes.beside(known, rival)
        left_law, left_over = (each - beside @ (beside.T @ each) for each in (law, residual))
        remains = _law_evidence(left_over, left_law, charged, classes.freedom)
        replaced = remains < max(LEAST_LEFT, LEFT_BESIDE * by_law)
    stands = deficit <= close + (CLOSE_LOOP_SHARE if loop else CLOSE_SHARE) * beyond
    stands |= beyond > 0.0 and share <= LITTLE_MISSED
    whole = share <= (MOST_MISSED_LOOP if loop else MOST_MISSED)
    whole |= deficit < 0.0 or max((each.evidence for each in left), default=0.0) < CLEAR
    # The terms of a whole loop were chosen by what they predict.
    seen = by_law >= LEAST_EVIDENCE or fitted.independent_share < 1.0
    holds = seen and stands and whole and not (replaced or cancels)
    listed = family if holds and family else list(every)
    behaviour = max(listed, key=lambda name: every[name].evidence, default="")
    if behaviour and every[behaviour].evidence <= 0.0:
        behaviour = ""
    return [LawCheck(name, behaviour, share, float(deficit), holds) for name in names]


def _cancel(fitted: FittedStructure, laws: Sequence[Floats]) -> bool:
    """Whether laws of one class mostly cancel each other, as any curve is a difference of two.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    laws : sequence of ndarray, shape (fitted,)
        Twist by each law, whitened.

    Returns
    -------
    bool
    """
    line = orthonormal(fitted.sensitivity[:, : fitted.problem.line_columns], 1e-8)
    seen = [law - line @ (line.T @ law) for law in laws]
    largest = max(float(np.linalg.norm(each)) for each in seen)
    return float(np.linalg.norm(np.sum(seen, axis=0))) < LEAST_SUM * largest


def _places(fitted: FittedStructure, index: int) -> list[int]:
    """Places of all parameters of a term.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Which of the structure's terms.

    Returns
    -------
    list of int
    """
    linear = [] if fitted.terms[index].slips else fitted.amplitude_places(index)
    return linear + fitted.nonlinear_places(index)


def _amplitudes(fitted: FittedStructure, index: int) -> int:
    """Count the amplitudes of a term; a friction has its limit.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Which of the structure's terms.

    Returns
    -------
    int
    """
    return 1 if fitted.terms[index].slips else len(fitted.amplitude_places(index))


def _law_evidence(residual: Floats, law: Floats, charged: tuple[int, int], freedom: float) -> float:
    """Log evidence of a law with fitted amplitudes and shape [nat].

    Parameters
    ----------
    residual : ndarray, shape (fitted,)
        White unit-variance residual without the law.
    law : ndarray, shape (fitted,)
        Twist by the law, whitened.
    charged : tuple of int
        Number of its amplitudes, and of its other parameters.
    freedom : float
        Degrees of freedom with which the noise is known.

    Returns
    -------
    float
    """
    amplitudes, others = charged
    drop = max(2.0 * float(law @ residual) - float(law @ law), 0.0)
    excess = max(float(residual @ residual) - freedom, 0.0)
    gain = float(likelihood_gain(np.array(drop), excess, freedom))
    return float(evidence(gain, float(amplitudes))) - SHAPE_CHARGE * others
