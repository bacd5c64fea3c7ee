"""Drag and friction of one structure, fitted once more from a start of their own.

Found one after the other, the first makes the loop of both: a drag then thins until it hardly goes
with the rate, or friction slips as far as the drag lags, and the fit of both ends there.
"""

from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.simulation.effects.history import History
from cyclosweep.simulation.effects.viscous_drag import placed_otherwise

USUAL_SLIP = {"slip_deg": 0.02, "scatter": 1.0, "skew": 0.0}
"""Presliding from which friction is begun; its distance is over the largest elastic twist."""
NOISE_ALONE = 1.02
"""Error over the noise up to which a fit needs no other start."""


def begun_together(joint: FittedStructure, parent: FittedStructure) -> FittedStructure:
    """The better one of a fit of drag and friction and of one with both begun as they usually are.

    Parameters
    ----------
    joint : FittedStructure
        Fit that began from what was found of the one without the other.
    parent : FittedStructure
        The structure to which the last of its terms was added.

    Returns
    -------
    FittedStructure
        The given one where it has no drag, or no friction, leaves noise alone, or is no worse.
    """
    drags = [term.effect is not None and term.effect.is_drag for term in joint.terms]
    if not any(drags) or not any(term.slips for term in joint.terms):
        return joint
    if joint.rmse_deg <= NOISE_ALONE * joint.noise.spread_deg:
        return joint
    history = joint.problem.history
    usual = tuple(_usual(term, history) for term in joint.terms)
    best = _better(joint, usual, parent)
    elsewhere = tuple(
        replace(term, shape=placed_otherwise(term.shape)) if is_drag else term
        for term, is_drag in zip(usual, drags, strict=True)
    )
    return _better(best, elsewhere, parent)


def _better(
    best: FittedStructure, terms: tuple[Term, ...], before: FittedStructure
) -> FittedStructure:
    """The better one of a fit and of a fit of the same effects in other forms.

    Parameters
    ----------
    best : FittedStructure
    terms : tuple of Term
        The same effects.
    before : FittedStructure
        Where the fit of these begins.

    Returns
    -------
    FittedStructure
    """
    other = with_right_signs(fit(best.problem, best.noise, terms, before, rival=best))
    if other is None or other.names != best.names or other.loss >= best.loss:
        return best
    return other


def _usual(term: Term, history: History) -> Term:
    """A drag or a friction with its usual shape; another term as it is.

    Parameters
    ----------
    term : Term
    history : History
        Of the recording.

    Returns
    -------
    Term
    """
    if term.effect is None:
        return term
    if term.effect.is_drag:
        return replace(term, shape=term.effect.shapes(history)[0])
    if not term.slips:
        return term
    usual = {**USUAL_SLIP, "slip_deg": USUAL_SLIP["slip_deg"] * history.largest_twist_deg}
    own = {name: value for name, value in usual.items() if name in term.shape}
    return replace(term, shape={**term.shape, **own})
