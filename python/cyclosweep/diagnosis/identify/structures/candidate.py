"""A candidate explanation: a fitted structure, its evidence and what its residual still shows."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cyclosweep.diagnosis.hypotheses.unnamed_shapes import FAMILIES_ALIKE, UnnamedShape
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.structures.alarm import Alarm
from cyclosweep.diagnosis.identify.structures.scan import (
    Scan,
    evidence,
    shape_choice_penalty,
    vector_penalty,
)
from cyclosweep.simulation.effects import Effect, Shape

FURTHER = 6.0
"""Log prior odds against every further effect."""
UNNAMED_PENALTY = 4.0
"""Log prior odds against an unnamed shape."""
OTHER_PENALTIES = {"saturation at the end of the range": 0.0} | dict.fromkeys(
    ("relaxation", "loop by rate", "position offsets", "compliance by position"), 6.0
)
"""The same for unnamed shapes as common as the named effects, and for those that can take the whole
of a named effect: creep, drag, transmission error and phase-dependent compliance need not be exact
to be named."""


def prior_penalty(name: str, effect: Effect | None, shape: Shape) -> float:
    """Log prior odds against a shape, of an effect or unnamed [nat].

    Parameters
    ----------
    name : str
        Name of the effect, or family of the unnamed shape.
    effect : Effect or None
        None for an unnamed shape.
    shape : mapping of str to float
        Shape parameters of the effect.

    Returns
    -------
    float
        In nat.
    """
    if effect is None:
        return OTHER_PENALTIES.get(name, UNNAMED_PENALTY)
    return effect.penalty(shape)


def shape_penalty(joint: FittedStructure, before: Scan) -> float:
    """Log of how many of its library's shapes of the last term a recording tells apart.

    Parameters
    ----------
    joint : FittedStructure
        With the term as the last.
    before : Scan
        Of the structure without it.

    Returns
    -------
    float
        In nat.
    """
    last = len(joint.terms) - 1
    places, ranges = [], []
    for k, parameter in enumerate(joint.fit_parameters):
        if parameter.term != last or parameter.name == "amplitude":
            continue
        shapes = [
            before.library.signatures[member].shape
            for member in before.groups.get(joint.terms[last].name, ())
        ]
        each = [
            parameter.to_scale(shape[parameter.name]) for shape in shapes if parameter.name in shape
        ]
        if len(each) and max(each) > min(each):
            places.append(len(joint.beta) + k)
            ranges.append(max(each) - min(each))
    if not places:
        return 0.0
    return shape_choice_penalty(joint.information(places), np.array(ranges))


@dataclass(frozen=True, eq=False)
class Candidate:
    """A structure with its joint fit and its evidence over the baseline.

    Attributes
    ----------
    fit : FittedStructure
        The structure, fitted jointly with the calibration.
    gain : float
        Log evidence over the baseline alone [nat].
    prior : float
        Log prior odds of the structure [nat].
    scan : Scan
        What the library finds in its residual.
    sinusoid : tuple
        Evidence [nat] and columns of the strongest sinusoid in its residual.
    alarm : Alarm
        Calibration of the global test.
    """

    fit: FittedStructure
    gain: float
    prior: float
    scan: Scan
    sinusoid: tuple[float, UnnamedShape | None]
    alarm: Alarm

    @property
    def names(self) -> frozenset[str]:
        """Names of the terms."""
        return frozenset(self.fit.names)

    @property
    def score(self) -> float:
        """Log posterior odds over the baseline [nat]."""
        return self.gain + self.prior

    @cached_property
    def recognised(self) -> tuple[bool, ...]:
        """For each term whether it may be called by its effect's name.

        An unnamed shape in the structure takes the name from all effects that look like it.
        """
        fitted = self.fit
        own: list[int] = []
        doubtful = set[str]()
        for k, term in enumerate(fitted.terms):
            effect = term.effect
            if effect is None:
                doubtful |= FAMILIES_ALIKE.get(term.name, frozenset())
            elif not term.slips and not effect.is_recognised(
                fitted.history, term.shape, fitted.beta[fitted.column_range(k)]
            ):
                doubtful.add(effect.family)
            else:
                own.append(k)
        return tuple(
            k in own and term.effect is not None and term.effect.family not in doubtful
            for k, term in enumerate(fitted.terms)
        )

    @property
    def all_recognised(self) -> bool:
        """Whether every term may be called by its effect's name."""
        return all(self.recognised)

    @property
    def excesses(self) -> dict[str, float]:
        """How far each hypothesis, in its residual, is beyond what it reaches by chance [nat]."""
        found = {name: self.alarm.excess(name, v) for name, v in self.scan.by_hypothesis.items()}
        value, shape = self.sinusoid
        if shape is not None:
            found[shape.family] = self.alarm.excess(shape.family, value)
        return found

    @property
    def largest_excess(self) -> float:
        """Largest excess of anything that remains in the residual [nat]."""
        return max(max(self.excesses.values(), default=0.0), 0.0)

    def hypotheses_to_add(self, most: int, least_named: int) -> list[str]:
        """Hypotheses worth adding, strongest first, with so many named effects.

        Parameters
        ----------
        most : int
            Most hypotheses, whatever they are.
        least_named : int
            Named effects that are taken even beyond that.

        Returns
        -------
        list of str
        """
        excesses, named = self.excesses, self.scan.library.effects
        good = sorted(
            (name for name, value in excesses.items() if value > self.alarm.threshold),
            key=lambda name: -excesses[name],
        )
        good = [name for name in good if name not in self.names]
        first = good[:most]
        others = [name for name in good if name in named and name not in first]
        first += others[: max(0, least_named - sum(name in named for name in first))]
        # Look-alikes are compared by their fits: on the grid of shapes the wrong one may be ahead.
        family = {name: each.effect.family for name, each in named.items() if each.effect}
        families = {family[name] for name in first if name in family}
        return first + [n for n in others if n not in first and family[n] in families]


def added_evidence(
    chi2_gain: float, joint: FittedStructure, before: Scan, rank: float, penalty: float
) -> float:
    """Log evidence that the last term of a joint fit adds to a structure [nat].

    Parameters
    ----------
    chi2_gain : float
        Twice the log likelihood that it gains.
    joint : FittedStructure
        With the new term as the last.
    before : Scan
        Of the structure without it.
    rank : float
        Number of its amplitudes that the recording tells apart.
    penalty : float
        Charge for the choice of its shape [nat].

    Returns
    -------
    float
    """
    effect = joint.terms[-1].effect
    if effect is not None and effect.vector:
        places = joint.amplitude_places(len(joint.terms) - 1)
        return 0.5 * chi2_gain - vector_penalty(joint.beta[places], joint.information(places))
    if effect is None or not effect.dense:
        penalty = max(penalty, shape_penalty(joint, before))
    return float(evidence(chi2_gain, rank)) - penalty
