"""Variants of an accepted effect, between which a fit with less beside it decided."""

from dataclasses import replace

from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.friction_first import CONVERGED, PARAMETER_CHARGE, cost


def in_better_variant(fitted: FittedStructure) -> FittedStructure:
    """Give effects other than friction the variant that fits best.

    Friction has a search of its own, see `friction_first.from_better_start`.

    Parameters
    ----------
    fitted : FittedStructure

    Returns
    -------
    FittedStructure
        That fit, or one with another variant of an effect.
    """
    best = fitted
    for k, term in enumerate(fitted.terms):
        if term.effect is None or term.slips:
            continue
        for shape in term.effect.variants(best.history, best.terms[k].shape):
            own = best.terms[k]
            if shape.keys() == own.shape.keys():
                continue
            terms = (*best.terms[:k], replace(own, shape=shape), *best.terms[k + 1 :])
            other = fit(best.problem, best.noise, terms, best, rounds=CONVERGED)
            if cost(other) < cost(best) - PARAMETER_CHARGE:
                best = other
    return best
