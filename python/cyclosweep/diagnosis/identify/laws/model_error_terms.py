"""Terms that may be model error of larger ones, and those that stand out from it."""

from collections.abc import Sequence

import numpy as np

from cyclosweep.diagnosis.hypotheses.behaviour_classes import (
    CLASSES_OF_EFFECT,
    LOOPS,
    POSITION,
    POSITION_COMPLIANCE,
    RUN,
    TEMPERATURE,
    WAYS_APART,
)
from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.law_in_class import (
    LEAST_OF_CLASS,
    cancels,
    makes_others_grow,
    own_classes,
    size_of_class,
)
from cyclosweep.diagnosis.identify.laws.run_offsets_check import may_be_chance
from cyclosweep.diagnosis.identify.laws.small_laws_check import errors_of_larger
from cyclosweep.diagnosis.identify.structures.testability import recalibrated_twist
from cyclosweep.simulation.effects.order_names import from_recorded_position, travels

LEAST_OF_MISMATCH = 0.04
"""Size from which an effect is told from the model error of the others, as a share of the mismatch
of the calibrated model."""
LEAST_OF_RECORDED = 0.02
"""The same of an effect that follows what was recorded beside the torque: the run, the position or
the temperature. What a law of the torque misses does not."""
RECORDED = frozenset({RUN, POSITION, POSITION_COMPLIANCE, TEMPERATURE})
"""Classes of such effects."""
LEAST_OF_FAMILY = 0.25
"""Size from which an effect is told from the model error of an effect of the same family that was
accepted before, as a share of the other's size."""
TIMES_WHAT_IS_LEFT = 3.0
"""Size of an effect over what the whole structure leaves beyond the noise, from which it is no
model error in any case: laws that err by as much as the effect would leave more."""


def without_model_error(
    fitted: FittedStructure, accepted: FittedStructure, mismatch_deg: float
) -> tuple[Term, ...]:
    """Terms of a structure but those that may be model error of a term accepted before.

    Parameters
    ----------
    fitted : FittedStructure
        The structure.
    accepted : FittedStructure
        Structure of the terms accepted before.
    mismatch_deg : float
        Root mean square error of the calibrated model without effects [deg].

    Returns
    -------
    tuple of Term
    """
    before = {
        t.name: float(np.std(recalibrated_twist(accepted, k))) for k, t in enumerate(accepted.terms)
    }
    size = [float(np.std(recalibrated_twist(fitted, k))) for k in range(len(fitted.terms))]
    left = beyond_noise_deg(fitted)
    errors = errors_of_larger(fitted)
    kept = []
    for k, term in enumerate(fitted.terms):
        others = [(size[j], each) for j, each in enumerate(fitted.terms) if each.name in before]
        family = max((s for s, each in others if each.family == term.family), default=0.0)
        alike = size_of_class(term, others)
        if term.name in CLASSES_OF_EFFECT and may_be_chance(fitted, k, size[k], left):
            offsets = (s for s, each in others if each.name in CLASSES_OF_EFFECT)
            alike = max(alike, *offsets, 0.0)
        mates = [(size[j], each) for j, each in enumerate(fitted.terms) if j != k]
        beside = [other for j, other in enumerate(fitted.terms) if j != k]
        least_alone = _least_share(term, beside) * mismatch_deg
        least = max(least_alone, LEAST_OF_FAMILY * family)
        stands_out = size[k] >= min(least, TIMES_WHAT_IS_LEFT * left)
        stands_out &= size[k] >= LEAST_OF_CLASS * alike and term.name not in errors
        largest = size_of_class(term, mates)
        small = size[k] < least_alone
        shrunk = size[k] < LEAST_OF_CLASS * before.get(term.name, 0.0)
        replaced = (small or shrunk) and size[k] < LEAST_OF_CLASS * largest
        replaced |= small and term.name in errors
        if (term.name in before and not replaced) or (
            stands_out and not cancels(fitted, k) and not makes_others_grow(fitted, k, accepted)
        ):
            kept.append(term)
    return tuple(kept)


def _least_share(term: Term, beside: Sequence[Term]) -> float:
    """Size from which a term is told from the model error of others, over the whole mismatch.

    Parameters
    ----------
    term : Term
    beside : sequence of Term
        The others.

    Returns
    -------
    float
    """
    own = _classes(term)
    if own and own <= LOOPS:
        # What a law misses that does not part the ways, does not part them either.
        remembers = any(other.effect is None or _classes(other) & WAYS_APART for other in beside)
        return LEAST_OF_MISMATCH if remembers else LEAST_OF_RECORDED
    if not own or not own <= RECORDED:
        return LEAST_OF_MISMATCH
    # The travel of the mesh is the twist itself, and so a function of the torque.
    of_travel = travels(term.shape) and not from_recorded_position(term.shape)
    return LEAST_OF_MISMATCH if of_travel else LEAST_OF_RECORDED


def _classes(term: Term) -> frozenset[str]:
    """Classes of behaviour of a term; none of one without a name."""
    return frozenset() if term.effect is None else frozenset(own_classes(term))
