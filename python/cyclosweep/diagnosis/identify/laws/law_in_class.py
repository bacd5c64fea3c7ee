"""A law beside its class of behaviour: its own classes, its evidence, and how it stands."""

from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_EFFECT,
    CLASSES_OF_FAMILY,
    EVEN_CURVE,
    LOOP,
    ODD_CURVE,
    OPENING_LOOP,
)
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns
from cyclosweep.diagnosis.identify.structures.scan import evidence, likelihood_gain
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.diagnosis.prepare.noise import orthonormal
from cyclosweep.diagnosis.prepare.problem import COMPLIANCE
from cyclosweep.simulation.effects.history import Floats

LEAST_OF_CLASS = 0.25
"""Size of an effect over that of a larger one of its class from which it is its own: a smaller
law takes up what the larger one's law misses, and leaves nothing of it."""
LEAST_SUM = 0.6
"""Size of the sum of laws in one class over that of the largest, below which they cancel each other
and are not named."""
LEAST_LEFT = 3.0
"""Log evidence that has to be left of a law beside a class that explains more [nat]."""
LEFT_BESIDE = 0.1
"""The same as a share of the law's evidence."""
BOTH_CURVES = frozenset({ODD_CURVE, EVEN_CURVE})
"""Classes of an effect whose twist has an odd and an even part, as an eccentric dial's."""
MOST_GROWN = 1.5
"""Size of an accepted effect with a new one in the fit, over its size without, above which the new
one is refused: the two compensate each other in the odd or in the even part."""
LOUD_LAW = 100.0
"""Signal-to-noise ratio of an effect from which the error of its law counts."""
SHAPE_CHARGE = 1.0
"""Log evidence that a parameter of a law's shape is charged, as is usual in the search [nat]."""


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


def withdrawn_where(
    withdraw: Callable[[str], bool], checks: Sequence[LawCheck]
) -> tuple[LawCheck, ...]:
    """Withdraw the laws of some names; those withdrawn before are not asked about.

    Parameters
    ----------
    withdraw : callable
        Whether the law of a name is to be withdrawn.
    checks : sequence of LawCheck
        Of the laws of a structure.

    Returns
    -------
    tuple of LawCheck
    """
    return tuple(replace(c, holds=c.holds and not withdraw(c.name)) for c in checks)


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


def size_of_class(term: Term, others: Iterable[tuple[float, Term]]) -> float:
    """Size of the largest laws among others whose errors may be the whole of a term.

    The error of an odd curve is odd: of a dial, which has an even part as well, it may be one part
    alone. Such a term is held by the smaller of the largest odd and the largest even law.

    Parameters
    ----------
    term : Term
    others : iterable of (float, Term)
        Other terms with their sizes, in any unit.

    Returns
    -------
    float
        In the same unit; zero where no other term is of its classes.
    """
    sizes = dict[str, float]()
    for size, other in others:
        for name in () if other.effect is None else own_classes(other):
            sizes[name] = max(size, sizes.get(name, 0.0))
    own = () if term.effect is None else own_classes(term)
    held = [sizes.get(name, 0.0) for name in own]
    return (min if set(own) >= BOTH_CURVES else max)(held, default=0.0)


def cancels(fitted: FittedStructure, index: int) -> bool:
    """Whether a term and others of its class mostly cancel, as any curve is a difference.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Which of the structure's terms.

    Returns
    -------
    bool
    """
    own = recalibrated_twist(fitted, index)
    others = [
        recalibrated_twist(fitted, k)
        for k, each in enumerate(fitted.terms)
        if k != index and share_class(each, fitted.terms[index])
    ]
    largest = max(float(np.std(each)) for each in [own, *others])
    return float(np.std(own + sum(others))) < LEAST_SUM * largest


def makes_others_grow(fitted: FittedStructure, index: int, accepted: FittedStructure) -> bool:
    """Whether a new effect with an odd and an even part makes an accepted effect grow.

    Such an effect may fit better in one part, while the accepted one takes back what it does
    wrong in the other.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    index : int
        Which of its terms.
    accepted : FittedStructure
        The structure before.

    Returns
    -------
    bool
    """
    term = fitted.terms[index]
    if term.effect is None or not set(own_classes(term)) >= BOTH_CURVES:
        return False
    before = {
        t.name: float(np.std(recalibrated_twist(accepted, k))) for k, t in enumerate(accepted.terms)
    }
    if term.name in before:
        return False
    return any(
        float(np.std(recalibrated_twist(fitted, k))) > MOST_GROWN * before.get(other.name, np.inf)
        for k, other in enumerate(fitted.terms)
        if k != index and share_class(other, term)
    )


def law_places(fitted: FittedStructure, index: int) -> list[int]:
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


def amplitude_count(fitted: FittedStructure, index: int) -> int:
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


def law_evidence(residual: Floats, law: Floats, charged: tuple[int, int], freedom: float) -> float:
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


def basis_of_others(fitted: FittedStructure, places: Collection[int]) -> Floats:
    """Orthonormal basis of everything that is fitted besides these parameters.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    places : collection of int
        Places of the parameters that are left out.

    Returns
    -------
    ndarray, shape (fitted, q)
        Whitened.
    """
    others = [k for k in range(fitted.sensitivity.shape[1]) if k not in places]
    columns = fitted.sensitivity[:, others]
    frictions = [k for k, term in enumerate(fitted.terms) if term.slips]
    left_out = any(set(fitted.nonlinear_places(k)) <= set(places) for k in frictions)
    if left_out and any(term.in_series for term in fitted.terms):
        # A line of the elastic torque and a curve of the applied one together make the friction,
        # unless the line moves with the twist by friction held.
        applied = fitted.history.applied_nm[fitted.problem.fitted]
        columns[:, others.index(COMPLIANCE)] = fitted.whitened(applied, fitted.noise)
    return orthonormal(columns, 1e-6)


@dataclass(frozen=True, eq=False)
class LawBeside:
    """What a law, or several together, explains beside everything else that is fitted.

    Attributes
    ----------
    known : ndarray, shape (fitted, q)
        Orthonormal basis of everything else.
    law : ndarray, shape (fitted,)
        Twist by the law, whitened, orthogonal to it.
    residual : ndarray, shape (fitted,)
        White unit-variance residual without the law, orthogonal to it.
    charged : tuple of int
        Number of the law's amplitudes, and of its other parameters.
    evidence : float
        Log evidence of the law [nat].
    """

    known: Floats
    law: Floats
    residual: Floats
    charged: tuple[int, int]
    evidence: float

    @classmethod
    def of(
        cls,
        fitted: FittedStructure,
        classes: ClassColumns,
        indices: Collection[int],
        taken: Collection[str] = (),
    ) -> "LawBeside":
        """Take laws of a structure together.

        Parameters
        ----------
        fitted : FittedStructure
            The structure.
        classes : ClassColumns
            Columns of every class.
        indices : collection of int
            Which of the structure's terms.
        taken : collection of str
            Classes that are fitted whole beside them.

        Returns
        -------
        LawBeside
        """
        places = [place for index in indices for place in law_places(fitted, index)]
        known = basis_of_others(fitted, places)
        for name in taken:
            known = classes.beside(known, name)
        single = [fitted.whitened_contribution(index, fitted.noise) for index in indices]
        law = classes.scale * np.sum(single, axis=0)
        residual = classes.scale * fitted.residual + law
        law, residual = (each - known @ (known.T @ each) for each in (law, residual))
        amplitudes = sum(amplitude_count(fitted, index) for index in indices)
        charged = (amplitudes, len(places) - amplitudes)
        value = law_evidence(residual, law, charged, classes.freedom)
        return cls(known, law, residual, charged, value)

    def is_replaced(self, classes: ClassColumns, name: str, least: float = LEAST_LEFT) -> bool:
        """Whether little is left of the law beside all columns of a class.

        Parameters
        ----------
        classes : ClassColumns
            Columns of every class.
        name : str
            Name of the class.
        least : float
            Log evidence that has to be left in any case [nat].

        Returns
        -------
        bool
        """
        beside = classes.beside(self.known, name)
        law, left = (each - beside @ (beside.T @ each) for each in (self.law, self.residual))
        remains = law_evidence(left, law, self.charged, classes.freedom)
        return remains < max(least, LEFT_BESIDE * self.evidence)
