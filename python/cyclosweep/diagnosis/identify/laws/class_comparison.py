"""Laws of one class of behaviour beside the flexible groups of all classes: whether they hold."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    EVEN_CURVE,
    LOOPS,
    ODD_CURVE,
    ONE_CAUSE,
    RATE_LOOP,
    RUN,
    WAYS_APART,
)
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.line_basis import line_basis
from cyclosweep.diagnosis.identify.laws.class_evidence import ClassColumns, ClassEvidence
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    BOTH_CURVES,
    LEAST_SUM,
    LawBeside,
    LawCheck,
    amplitude_count,
)
from cyclosweep.diagnosis.identify.laws.loop_check import is_without_loop
from cyclosweep.diagnosis.identify.structures.candidate import FURTHER
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
literature leave 0 to 0.1 of each other where they are curves, to 0.25 where they are loops, follow
a position or a temperature, or are even in the torque."""
ONE_EFFECT = frozenset({EVEN_CURVE, RATE_LOOP})
"""Classes with a single effect on the list: its law can stand for no other."""
ERROR_OF_OTHERS = 0.01
"""What another law misses, as a share of its own size, that may lie in the class of a smaller one:
no law is exact to a hundredth."""
WITHIN = 0.25
"""What offsets of all runs may leave, over what they explain, as root mean squares, for any law of
the datum to stand: what changes within the runs is no zero that moves from run to run."""
CLEAR = 6.0
"""Log evidence from which a residual shows a class [nat]."""


@dataclass(frozen=True, eq=False)
class ClassComparison:
    """Laws of one class, taken together, beside the flexible groups of all classes.

    Attributes
    ----------
    fitted : FittedStructure
        The structure.
    classes : ClassColumns
        Columns of every class.
    indices : sequence of int
        Which of the structure's terms are compared.
    own : collection of str
        Their classes.
    size_of_others : float
        Size of the largest other law over theirs, as root mean squares.
    beside : LawBeside
        The laws, what they and the residual of the structure make together, and what is known.
    every : mapping of str to ClassEvidence
        Evidence of the classes that may take their place.
    left : sequence of ClassEvidence
        What they miss inside each of their own classes.
    """

    fitted: FittedStructure
    classes: ClassColumns
    indices: Sequence[int]
    own: Collection[str]
    size_of_others: float
    beside: LawBeside
    every: Mapping[str, ClassEvidence]
    left: Sequence[ClassEvidence]

    @classmethod
    def of(
        cls,
        fitted: FittedStructure,
        classes: ClassColumns,
        indices: Sequence[int],
        own: Collection[str],
        taken: Collection[str],
        size_of_others: float,
    ) -> "ClassComparison":
        """Compare laws of a structure.

        Parameters
        ----------
        fitted, classes, indices, own, size_of_others
            See the attributes.
        taken : collection of str
            Classes that are fitted whole beside the laws.

        Returns
        -------
        ClassComparison
        """
        whole = sorted(set(taken) & set(classes.columns))
        beside = LawBeside.of(fitted, classes, indices, whole)
        beside = replace(beside, evidence=beside.evidence - FURTHER * (len(indices) - 1))
        tangent, left_by_all = fitted.tangent, classes.scale * fitted.residual
        for name in whole:
            tangent = classes.beside(tangent, name)
            left_by_all = left_by_all - tangent @ (tangent.T @ left_by_all)
        every = {
            name: classes.evidence(name, beside.known, beside.residual)
            for name in classes.columns
            if name not in taken
        }
        left = [classes.evidence(name, tangent, left_by_all) for name in every if name in own]
        return cls(fitted, classes, indices, own, size_of_others, beside, every, left)

    @property
    def by_law(self) -> float:
        """Log evidence of the laws [nat]."""
        return self.beside.evidence

    @property
    def family(self) -> list[str]:
        """Classes of the laws that may take their place."""
        return [name for name in self.every if name in self.own]

    @property
    def rivals(self) -> list[str]:
        """Other classes that may."""
        return [name for name in self.every if name not in self.own]

    @cached_property
    def deficit(self) -> float:
        """Log evidence by which their class is ahead of the laws [nat]."""
        by_class = max((self.every[name].evidence for name in self.family), default=-np.inf)
        if len(self.indices) == 1 and set(self.family) >= BOTH_CURVES:
            both = {name: self.every[name] for name in sorted(BOTH_CURVES)}
            together = self.classes.evidence_together(both, self.beside.known, self.beside.residual)
            by_class = max(by_class, together)
        return float(by_class - self.by_law)

    @property
    def missed_share(self) -> float:
        """What the laws miss inside their class, over both together, as root mean squares."""
        law = self.beside.law
        missed = max((each.explained for each in self.left), default=0.0)
        return float(np.sqrt(missed / max(missed + float(law @ law), 1e-300)))

    @property
    def follows_one_cause(self) -> bool:
        """Whether the class itself says what the twist follows."""
        return bool(self.own) and set(self.own) <= set(ONE_CAUSE)

    @property
    def is_of_offsets(self) -> bool:
        """Whether the class is that of offsets of the runs, and nothing changes within a run."""
        if set(self.own) != {RUN} or RUN not in self.every:
            return False
        return _within_runs(self.every[RUN], self.beside.residual, self.classes) <= WITHIN

    @property
    def close(self) -> float:
        """Log evidence by which another class may be ahead of the laws [nat]."""
        close = CLOSE_BESIDE * (len(self.indices) < len(self.fitted.terms))
        return close + (CLOSE if {ODD_CURVE, EVEN_CURVE} & set(self.own) else CLOSE_OTHER)

    @property
    def beyond(self) -> float:
        """Log evidence of the laws beyond that from which their own error counts [nat]."""
        curves = set(self.own) <= BOTH_CURVES
        counts = [amplitude_count(self.fitted, index) for index in self.indices]
        many = curves and any(count >= MANY_AMPLITUDES for count in counts)
        return 0.0 if many else max(self.by_law - CLEARLY, 0.0)

    def is_replaced(self) -> bool:
        """Whether another class explains what the laws do, and better."""
        fitted = self.fitted
        if any(fitted.terms[k].slips and is_without_loop(fitted, k) for k in self.indices):
            return True
        return self._is_behind_a_class() or self._is_another_loop()

    def _is_behind_a_class(self) -> bool:
        """Whether another class is ahead, and leaves little of the laws."""
        rival = max(self.rivals, key=lambda name: self.every[name].evidence, default=None)
        if rival is None:
            return False
        own = [self.every[name].evidence for name in self.family]
        # Where the class itself says what the twist follows, it is the class that has to be beaten.
        beaten = max([self.by_law, *(own if self.follows_one_cause else [])])
        # A class that the recording does not show replaces no law.
        ahead = self.every[rival].evidence > max(beaten + self.close, CLEAR)
        return ahead and self.beside.is_replaced(self.classes, rival)

    def _is_another_loop(self) -> bool:
        """Whether laws of a loop make that of another class, which explains as much as they do.

        A law with enough parameters may make a loop of another kind; its class does not. So it is
        not named where another class explains more than its own, and the law no more.
        """
        loops = [self.every[name].evidence for name in self.rivals if name in WAYS_APART]
        if not loops or not self.family or not set(self.family) <= WAYS_APART:
            return False
        ahead = max(loops) - max(self.every[name].evidence for name in self.family)
        clear = max(CLEAR, CLOSE_LOOP_SHARE * self.beyond)
        return ahead > clear and self.by_law <= max(loops) + self.close

    @property
    def error_of_others(self) -> float:
        """Error that other laws may leave in their class, over the laws' own size."""
        return ERROR_OF_OTHERS * self.size_of_others

    def _with_error_of_others(self, share: float) -> float:
        """Share that may be missed, no less than the error that much larger laws leave."""
        return min(float(np.hypot(share, self.error_of_others)), MOST_MISSED_LOOP)

    def stands(self) -> bool:
        """Whether the laws explain as much as their class, but for the error of laws."""
        share = CLOSE_LOOP_SHARE if _is_loose(self.own) else CLOSE_SHARE
        if self.deficit <= self.close + share * self.beyond:
            return True
        if self.follows_one_cause or self.is_of_offsets:
            return True
        if set(self.own) <= ONE_EFFECT:
            return self.missed_share <= MOST_MISSED_LOOP
        counts = self.beyond > 0.0 or self.error_of_others > LITTLE_MISSED
        return counts and self.missed_share <= self._with_error_of_others(LITTLE_MISSED)

    def is_whole(self) -> bool:
        """Whether the laws miss nothing inside their class that it shows."""
        loose = _is_loose(self.own) or self.is_of_offsets
        most = MOST_MISSED_LOOP if loose else self._with_error_of_others(MOST_MISSED)
        if self.missed_share <= most or self.deficit < 0.0:
            return True
        return max((each.evidence for each in self.left), default=0.0) < CLEAR

    def _cancel(self) -> bool:
        """Whether the laws mostly cancel each other, as any curve is a difference of two."""
        fitted = self.fitted
        line = line_basis(fitted)
        laws = [fitted.whitened_contribution(index, fitted.noise) for index in self.indices]
        seen = [law - line @ (line.T @ law) for law in laws]
        largest = max(float(np.linalg.norm(each)) for each in seen)
        return float(np.linalg.norm(np.sum(seen, axis=0))) < LEAST_SUM * largest

    def checks(self) -> list[LawCheck]:
        """Whether each of the laws holds.

        Returns
        -------
        list of LawCheck
            One for each term.
        """
        # The terms of a whole loop were chosen by what they predict.
        seen = self.by_law >= LEAST_EVIDENCE or self.fitted.independent_share < 1.0
        stand = self.stands() and self.is_whole()
        holds = seen and stand and not (self._cancel() or self.is_replaced())
        listed = self.family if holds and self.family else list(self.every)
        behaviour = max(listed, key=lambda name: self.every[name].evidence, default="")
        if behaviour and self.every[behaviour].evidence <= 0.0:
            behaviour = ""
        names = [self.fitted.terms[index].name for index in self.indices]
        share = self.missed_share
        return [LawCheck(name, behaviour, share, self.deficit, holds) for name in names]


def most_missed(classes: Collection[str]) -> float:
    """Largest share that a named law of some classes may miss inside them."""
    return MOST_MISSED_LOOP if _is_loose(classes) else MOST_MISSED


def _is_loose(classes: Collection[str]) -> bool:
    """Whether laws of some classes may differ as loops do, or what follows one known cause.

    So may those of a class of one effect.
    """
    return bool(LOOPS.union(ONE_CAUSE) & set(classes)) or set(classes) <= ONE_EFFECT


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
