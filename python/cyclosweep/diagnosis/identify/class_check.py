"""Whether a named law stands for its class of behaviour, and which classes a residual shows.

A law is named only where it explains as much as its whole class could: a neighbour that takes the
place of a law that is on no list explains less than the flexible group of the class does, or a
flexible group of another class explains it better.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    EVEN_CURVE,
    LOOPS,
    ODD_CURVE,
    ONE_CAUSE,
    RUN,
    WAYS_APART,
)
from cyclosweep.diagnosis.hypotheses.library import Library
from cyclosweep.diagnosis.identify.candidate import FURTHER
from cyclosweep.diagnosis.identify.class_evidence import ClassColumns, ClassEvidence
from cyclosweep.diagnosis.identify.dial_check import without_other_dials
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.law_in_class import (
    BOTH_CURVES,
    LEAST_SUM,
    LawBeside,
    LawCheck,
    amplitude_count,
    basis_of_others,
    law_evidence,
    law_places,
    own_classes,
)
from cyclosweep.diagnosis.identify.loop_check import is_without_loop
from cyclosweep.diagnosis.identify.run_offsets_check import (
    without_any_offsets,
    without_leftovers,
)
from cyclosweep.diagnosis.identify.scatter_check import without_widest_scatter
from cyclosweep.diagnosis.identify.starting_terms import TIED_DIGITS
from cyclosweep.diagnosis.identify.terms import Term
from cyclosweep.diagnosis.identify.testability import size_of
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.simulation.effects.history import Floats

LEAST_EVIDENCE = 0.5
"""Log evidence of its own that a law must have to be named [nat]. That something is missing was
decided before; a faint law, whose shape the recording leaves open, is charged too much for it."""
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
"""Share of the evidence beyond that by which the class may be ahead of curves, and of others."""
MANY_AMPLITUDES = 3
"""Amplitudes from which a curve has as much freedom as its class, and no error of its own that
would have to be allowed for."""
LITTLE_MISSED = 0.05
"""What a law of more evidence may miss inside its class in any case, as root mean squares: where
the noise is small no law is exact, and flexible groups are."""
MOST_MISSED, MOST_MISSED_LOOP = 0.1, 0.25
"""What a named law may miss inside its class, as a share of both in root mean squares: laws of the
literature leave 0 to 0.1 of each other where they are curves, to 0.25 where they are loops or
follow a position or a temperature."""
ERROR_OF_OTHERS = 0.01
"""What another law misses, as a share of its own size, that may lie in the class of a smaller one:
no law is exact to a hundredth."""
WITHIN = 0.25
"""What offsets of all runs may leave, over what they explain, as root mean squares, for any law of
the datum to stand: what changes within the runs is no zero that moves from run to run."""
CLEAR = 6.0
"""Log evidence from which a residual shows a class [nat]."""
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
    sizes = [size_of(fitted, index) for index in range(len(fitted.terms))]
    found = [
        _check(fitted, classes, indices, own, taken - own, _size_over(sizes, indices))
        for indices, own in groups
    ]
    checks = [check for group in found for check in group]
    judged = without_any_offsets(fitted, without_leftovers(fitted, classes, checks))
    return without_widest_scatter(fitted, without_other_dials(fitted, judged))


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


def most_missed(classes: Collection[str]) -> float:
    """Largest share that a named law of some classes may miss inside them."""
    return MOST_MISSED_LOOP if _is_loose(classes) else MOST_MISSED


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


def _is_loose(classes: Collection[str]) -> bool:
    """Whether laws of some classes may differ as loops do, or what follows one known cause."""
    return bool(LOOPS.union(ONE_CAUSE) & set(classes))


def _check(
    fitted: FittedStructure,
    classes: ClassColumns,
    indices: Sequence[int],
    own: Collection[str],
    taken: Collection[str],
    size_of_others: float,
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
    size_of_others : float
        Size of the largest other law over theirs, see `_size_over`.

    Returns
    -------
    list of LawCheck
        One for each of the terms.
    """
    names = [fitted.terms[index].name for index in indices]
    places = [place for index in indices for place in law_places(fitted, index)]
    amplitudes = sum(amplitude_count(fitted, index) for index in indices)
    charged = (amplitudes, len(places) - amplitudes)
    known = basis_of_others(fitted, places)
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
    by_law = law_evidence(residual, law, charged, classes.freedom)
    every = {
        name: classes.evidence(name, known, residual)
        for name in classes.columns
        if name not in taken
    }
    family = [name for name in every if name in own]
    rivals = [name for name in every if name not in own]
    by_law -= FURTHER * (len(indices) - 1)
    by_class = max((every[name].evidence for name in family), default=-np.inf)
    if len(indices) == 1 and set(family) >= BOTH_CURVES:
        both = {name: every[name] for name in sorted(BOTH_CURVES)}
        by_class = max(by_class, classes.evidence_together(both, known, residual))
    deficit = by_class - by_law
    left = [classes.evidence(k, tangent, whole_residual) for k in family]
    missed = max((each.explained for each in left), default=0.0)
    share = float(np.sqrt(missed / max(missed + float(law @ law), 1e-300)))
    loose = _is_loose(own)
    close = CLOSE_BESIDE * (len(indices) < len(fitted.terms))
    close += CLOSE if {ODD_CURVE, EVEN_CURVE} & set(own) else CLOSE_OTHER
    many = set(own) <= BOTH_CURVES and any(
        amplitude_count(fitted, k) >= MANY_AMPLITUDES for k in indices
    )
    beyond = 0.0 if many else max(by_law - CLEARLY, 0.0)
    rival = max(rivals, key=lambda name: every[name].evidence, default=None)
    follows = bool(own) and set(own) <= set(ONE_CAUSE)
    # Where the class itself says what the twist follows, it is the class that has to be beaten.
    beaten = max([by_law, *(every[name].evidence for name in family if follows)])
    replaced = any(fitted.terms[k].slips and is_without_loop(fitted, k) for k in indices)
    # A class that the recording does not show replaces no law.
    if rival is not None and every[rival].evidence > max(beaten + close, CLEAR):
        replaced |= LawBeside(known, law, residual, charged, by_law).is_replaced(classes, rival)
    room = close + (CLOSE_LOOP_SHARE if loose else CLOSE_SHARE) * beyond
    loops = [every[name].evidence for name in rivals if name in WAYS_APART]
    if loops and family and set(family) <= WAYS_APART:
        # A law with enough parameters may make a loop of another kind; its class does not. So it
        # is not named where another class explains more than its own, and the law no more.
        ahead = max(loops) - max(every[name].evidence for name in family)
        clear = max(CLEAR, CLOSE_LOOP_SHARE * beyond)
        replaced |= ahead > clear and by_law <= max(loops) + close
    # A law is judged by its class no closer than to the error that much larger ones leave there.
    error = ERROR_OF_OTHERS * size_of_others
    little = float(np.clip(np.hypot(LITTLE_MISSED, error), 0.0, MOST_MISSED_LOOP))
    most = float(np.clip(np.hypot(MOST_MISSED, error), 0.0, MOST_MISSED_LOOP))
    stands = deficit <= room
    stands |= follows or ((beyond > 0.0 or error > LITTLE_MISSED) and share <= little)
    if set(own) == {RUN} and RUN in every and _within_runs(every[RUN], residual, classes) <= WITHIN:
        stands, loose = True, True
    whole = share <= (MOST_MISSED_LOOP if loose else most)
    whole |= deficit < 0.0 or max((each.evidence for each in left), default=0.0) < CLEAR
    # The terms of a whole loop were chosen by what they predict.
    seen = by_law >= LEAST_EVIDENCE or fitted.independent_share < 1.0
    holds = seen and stands and whole and not (replaced or cancels)
    listed = family if holds and family else list(every)
    behaviour = max(listed, key=lambda name: every[name].evidence, default="")
    if behaviour and every[behaviour].evidence <= 0.0:
        behaviour = ""
    return [LawCheck(name, behaviour, share, float(deficit), holds) for name in names]


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


def _within_runs(offsets: ClassEvidence, residual: Floats, classes: ClassColumns) -> float:
    """What offsets of all runs leave of a residual beyond the noise, over what they explain.

    Parameters
    ----------
    offsets : ClassEvidence
        Of the class of offsets.
    residual : ndarray, shape (fitted,)
        White unit-variance residual.
    classes : ClassColumns
        With the degrees of freedom of the noise.

    Returns
    -------
    float
    """
    left = residual - offsets.twist
    beyond = max(float(left @ left) - classes.freedom, 0.0)
    return float(np.sqrt(beyond / max(offsets.explained, 1e-300)))


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
