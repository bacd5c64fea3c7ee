"""Variants of an accepted effect, between which a fit with less beside it decided."""

from collections.abc import Collection, Mapping
from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.stages.friction_first import (
    CONVERGED,
    PARAMETER_CHARGE,
    structure_cost,
)
from cyclosweep.simulation.effects import Shape
from cyclosweep.simulation.effects.base import Effect
from cyclosweep.simulation.effects.slip_path import otherwise_read

REFINEMENT_CHARGE = 8.0
"""What each parameter that a shape has more must gain within the noise, as chi-squared."""


def in_better_variant(fitted: FittedStructure) -> FittedStructure:
    """Give effects the variant that fits best, and friction its turning points.

    How friction meets the play has a search of its own, see `friction_first.from_better_start`.

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
        best = _refined(best, k, term.effect)
    slipping = {k: term.shape for k, term in enumerate(best.terms) if term.slips}
    if slipping and len(best.history.corners):
        best = _better(best, {k: otherwise_read(shape) for k, shape in slipping.items()})
    return best


def with_refined_drag(fitted: FittedStructure, accepted: Collection[str]) -> FittedStructure:
    """Refine the shape of a drag that was accepted before, beside what was found since.

    Parameters
    ----------
    fitted : FittedStructure
    accepted : collection of str
        Names of the terms accepted before.

    Returns
    -------
    FittedStructure
        The same where nothing is better.
    """
    best = fitted
    for k, term in enumerate(fitted.terms):
        if term.name in accepted and term.effect is not None and term.effect.is_drag:
            best = _refined(best, k, term.effect)
    return best


def _refined(best: FittedStructure, place: int, effect: Effect) -> FittedStructure:
    """Refine the shape of an effect, in one respect after the other, while that fits better.

    Parameters
    ----------
    best : FittedStructure
    place : int
        Of its term.
    effect : Effect

    Returns
    -------
    FittedStructure
    """
    tried = {frozenset(best.terms[place].shape)}
    while True:
        shape = best.terms[place].shape
        others = effect.refinements(best.history, shape)
        other = next((each for each in others if frozenset(each) not in tried), None)
        if other is None:
            return best
        tried.add(frozenset(other))
        better = _better(best, {place: other})
        if better is not best:
            # What is tried next is to gain by itself, not by what is left of this fit.
            better = fit(better.problem, better.noise, better.terms, better, rounds=CONVERGED)
        best = better


def _better(best: FittedStructure, shapes: Mapping[int, Shape]) -> FittedStructure:
    """The better one of a fit and of another with other shapes of some terms.

    Parameters
    ----------
    best : FittedStructure
    shapes : mapping of int to mapping
        Shapes by the places of their terms.

    Returns
    -------
    FittedStructure
    """
    terms = tuple(
        replace(term, shape=shapes.get(k, term.shape)) for k, term in enumerate(best.terms)
    )
    other = fit(best.problem, best.noise, terms, best, rounds=CONVERGED)
    if best.valid and not other.valid:
        signed = with_right_signs(other)
        if signed is None:
            return best
        other = signed
    ahead = structure_cost(best) - structure_cost(other)
    if abs(ahead) <= PARAMETER_CHARGE:
        # Both are within the noise, or about as far beyond it.
        more = len(other.fit_parameters) - len(best.fit_parameters)
        ahead = best.loss - other.loss - REFINEMENT_CHARGE * more
    return other if ahead > PARAMETER_CHARGE else best
