"""Friction, and what else loops usually show, fitted jointly from several starts.

A large friction is taken out as physics first: one effect at a time, it takes the place of creep
and stiffening or leaves them its own, and what it leaves of a wrong start hides all the rest.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.loop_check import is_curve_of_torque
from cyclosweep.diagnosis.identify.structures.enrichment import freer_friction
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.prepare.noise import INDEPENDENT_PIECES, Noise
from cyclosweep.simulation.effects.conditioning import conditioned
from cyclosweep.simulation.effects.creep import Creep
from cyclosweep.simulation.effects.slip import SLIP_PARAMETERS, FrictionEffect
from cyclosweep.simulation.effects.slip_start import STATES, in_other_state, state_of

STARTS = ((0.05, 0.02), (0.1, 0.02), (0.05, 0.08))
"""Friction limits and presliding distances to start from, as shares of torque and twist."""
PARAMETER_CHARGE = 2.0
"""What a parameter must gain: twice the log likelihood of independent pieces."""
EFFECT_CHARGE = 8.0
"""What an effect must gain beside its parameters, in the same unit: the odds against one more."""
LEAST_REMOVED = 0.5
"""Share of the mean square mismatch that these effects must take away together, and the friction
that is kept of them."""
LEAST_FORGETTING = 0.05
"""Share of a friction that forgets its turning points from which it is fitted further."""
FEW_RUNS = 4
"""Fitted runs up to which the flanks alone may not tell effects apart."""
SAME_OPTIMUM = 0.01
"""Difference of the logarithms of two errors up to which two starts have led to the same fit."""
CONVERGED = 20
"""Most iterations of the fit of what a stage accepted, so that what it leaves is not for want of
them."""
HOPELESS = 2.0
"""Error of a fit over that of the best one from which it is no rival, whatever it is charged."""


def friction_first(search: Search, noise: Noise) -> FittedStructure | None:
    """Find friction, and what else loops usually show, where it explains most of a loop.

    Parameters
    ----------
    search : Search
        Calibrated, with nothing visited.
    noise : Noise
        Noise and model error together.

    Returns
    -------
    FittedStructure or None
        None where they take away too little, or do as well without friction, or where friction
        stands in for a curve of the torque.
    """
    baseline = search.baseline.fit
    best: FittedStructure | None = None
    for limit, slip in STARTS:
        before = best
        joint = _fitted(noise, _freer_terms(search, limit, slip), baseline)
        if joint is not None and (best is None or joint.rmse_deg < best.rmse_deg):
            best = joint
        if before is not None and joint is not None and _ends_alike(joint, before):
            break
    # One friction has few optima, two and their presliding many: where a joint fit ended in a bad
    # one, either friction alone is better.
    if best is None:
        return None
    offered = [_prune(noise, best)]
    for term in _freer_terms(search, *STARTS[0]):
        alone = _fitted(noise, [term], baseline, best) if term.slips else None
        offered += [] if alone is None else [alone]
    best = from_better_start(noise, min(offered, key=structure_cost), EFFECT_CHARGE)
    if not any(term.slips for term in best.terms) or not _explains_most(best, baseline):
        return None
    others = [term for term in best.terms if not term.slips]
    instead = ([*loop, *others] for loop in ([], *_other_loops(search)))
    if any(_does_as_well(noise, terms, baseline, best) for terms in instead):
        return None
    # What was fitted beside friction kept it in its place. What it really is the search decides: a
    # stiffening and a difference of the directions together make the curve of any dial. A few runs
    # alone do not tell them from friction.
    few = search.problem.run_count <= FEW_RUNS
    kept = [term for term in best.terms if term.slips or few]
    for own in (search.noise, noise):
        found = fit(search.problem, own, _settled(kept), best, rounds=CONVERGED)
        if _explains_most(found, baseline):
            return None if is_curve_of_torque(found) else found
        # Where friction was taken for slow noise, a fit against that noise forgets the loop.
    return None


def _does_as_well(
    noise: Noise, terms: Sequence[Term], before: FittedStructure, best: FittedStructure
) -> bool:
    """Whether other terms explain a recording as well as the best fit does.

    Parameters
    ----------
    noise : Noise
        Noise and model error together.
    terms : sequence of Term
    before : FittedStructure
        The fit from which theirs goes on.
    best : FittedStructure
        The best fit so far.

    Returns
    -------
    bool
    """
    other = _fitted(noise, terms, before, best)
    return other is not None and structure_cost(other) <= structure_cost(best)


def _other_loops(search: Search) -> list[list[Term]]:
    """Loops that are no friction, by the rate or by delay, each as the one term of a structure.

    Parameters
    ----------
    search : Search

    Returns
    -------
    list of list of Term
        Drags as they are first looked for, and of each law of creep the shape that explains most.
    """
    drags = [
        Term(signature.effect, signature.shape)
        for signature in search.library.effects.values()
        if signature.effect is not None
        and signature.effect.family == FrictionEffect.family
        and not signature.effect.slips
    ]
    return [[term] for term in [*_creeps(search), *drags]]


def _creeps(search: Search) -> list[Term]:
    """Each law of creep, of the shape that explains most alone."""
    scan, best = search.baseline.scan, dict[tuple[str, ...], int]()
    for k in scan.groups.get(Creep.name, np.zeros(0, dtype=np.int64)).tolist():
        law = tuple(sorted(search.library.signatures[k].shape))
        if scan.observed[k] > scan.observed[best.setdefault(law, k)]:
            best[law] = k
    found = [search.library.signatures[k] for k in best.values()]
    return [Term(each.effect, each.shape) for each in found if each.effect is not None]


def _explains_most(fitted: FittedStructure, baseline: FittedStructure) -> bool:
    """Whether a fit takes most of the mean square mismatch away.

    Parameters
    ----------
    fitted : FittedStructure
        The fit.
    baseline : FittedStructure
        The calibrated model without effects.

    Returns
    -------
    bool
    """
    return bool(1.0 - (fitted.rmse_deg / baseline.rmse_deg) ** 2 > LEAST_REMOVED)


def _ends_alike(one: FittedStructure, other: FittedStructure) -> bool:
    """Whether two starts have led to fits of the same error.

    Parameters
    ----------
    one : FittedStructure
        Fit from one start.
    other : FittedStructure
        Fit from another.

    Returns
    -------
    bool
    """
    return bool(abs(np.log(one.rmse_deg / other.rmse_deg)) < SAME_OPTIMUM)


def _settled(terms: Sequence[Term]) -> tuple[Term, ...]:
    """Terms less the freedom to forget where friction hardly does."""
    return tuple(
        replace(term, shape={k: v for k, v in term.shape.items() if k != "forgetting"})
        if term.shape.get("forgetting", 1.0) < LEAST_FORGETTING
        else term
        for term in terms
    )


def _freer_terms(search: Search, limit_share: float, slip_share: float) -> list[Term]:
    """Terms of the usual effects, friction with all freedom of shape that it can have.

    Whole loops of a few runs are forecast better without it: there friction is given none.

    Parameters
    ----------
    search : Search
    limit_share, slip_share : float
        See `usual_effects`.

    Returns
    -------
    list of Term
    """
    usual = usual_effects(search, limit_share, slip_share)
    return [freer_friction(term) or term for term, _ in usual]


def usual_effects(
    search: Search, limit_share: float, slip_share: float
) -> list[tuple[Term, float]]:
    """Terms of the effects that loops usually show, each with its starting amplitude.

    Parameters
    ----------
    search : Search
    limit_share, slip_share : float
        Friction limit and presliding distance, as shares of torque and twist.

    Returns
    -------
    list of (Term, float)
        None where the library has none of them.
    """
    history = search.problem.history
    terms = []
    for signature in search.library.effects.values():
        effect = signature.effect
        assert effect is not None
        begun = effect.usual_start(history, limit_share, slip_share)
        if begun is not None:
            shape, amplitude = begun
            term = Term(effect, shape, None, amplitude if effect.slips else 0.0)
            terms.append((term, amplitude))
    return terms


def _fitted(
    noise: Noise,
    terms: Sequence[Term],
    before: FittedStructure,
    rival: FittedStructure | None = None,
) -> FittedStructure | None:
    """Fit terms jointly, less those whose amplitude has the wrong sign.

    Parameters
    ----------
    noise : Noise
        Noise and model error together.
    terms : sequence of Term
    before : FittedStructure
        The fit from which it goes on.
    rival : FittedStructure, optional
        The best fit so far.

    Returns
    -------
    FittedStructure or None
        None where no term is left, or far more than by the rival.
    """
    if not terms:
        return None
    found = fit(before.problem, noise, tuple(terms), before, rounds=CONVERGED, rival=rival)
    if rival is not None and found.rmse_deg > HOPELESS * rival.rmse_deg:
        return None
    return with_right_signs(found, whole_effects=True)


def from_better_start(noise: Noise, best: FittedStructure, charge: float) -> FittedStructure:
    """Let friction begin or meet the play in another way, where that explains clearly more.

    Runs begin with fresh friction on the first flank, or with friction that has slipped, or
    friction lies behind the play and does not notice it; or the drive was worked before.

    Parameters
    ----------
    noise : Noise
        Noise and model error together.
    best : FittedStructure
        The best fit, with friction in any of these states.
    charge : float
        What another state must gain, see `PARAMETER_CHARGE`.

    Returns
    -------
    FittedStructure
    """
    turned = best
    for other in in_other_states(noise, best):
        least = structure_cost(best) - charge if turned is best else structure_cost(turned)
        if structure_cost(other) < least:
            turned = other
    return turned


def in_other_states(noise: Noise, before: FittedStructure) -> Iterator[FittedStructure]:
    """Fit the same structure with friction that meets the play in each other way, or was worked.

    Parameters
    ----------
    noise : Noise
        Noise and model error together.
    before : FittedStructure
        With friction in any of `STATES`.

    Yields
    ------
    FittedStructure
        None where it explains far less.
    """
    slipping = [k for k, term in enumerate(before.terms) if term.slips]
    own = state_of(before.terms[slipping[0]].shape) if slipping else None
    if own is None:
        return
    history = before.problem.history
    others = [state for state in STATES if state != own and history.free_play_deg > 0.0]
    shapes = {k: before.terms[k].shape for k in slipping if state_of(before.terms[k].shape)}
    begun = [{k: in_other_state(shape, state) for k, shape in shapes.items()} for state in others]
    first = before.terms[slipping[0]]
    worked = []
    # Of several runs that begin afresh, what a conditioning seems to leave may be the run before.
    own_elements = first.effect is None or first.effect.shape_parameters is not SLIP_PARAMETERS
    if not own_elements and not np.any(history.restart[1:]):
        worked = conditioned(first.shape, history.largest_torque_nm)
    for other_shapes in (*begun, *({slipping[0]: shape} for shape in worked)):
        terms = [
            replace(term, shape=other_shapes.get(k, term.shape))
            for k, term in enumerate(before.terms)
        ]
        other = _fitted(noise, terms, before, before)
        if other is not None:
            yield other


def _prune(noise: Noise, best: FittedStructure) -> FittedStructure:
    """Leave out one of two frictions, where it gains less than its parameters are charged.

    Parameters
    ----------
    noise : Noise
        Noise and model error together.
    best : FittedStructure
        The best fit so far.

    Returns
    -------
    FittedStructure
    """
    slipping = [term for term in best.terms if term.slips]
    if len(slipping) < 2:
        return best
    fits = [best]
    for left_out in slipping:
        rest = [term for term in best.terms if term is not left_out]
        without = _fitted(noise, rest, best, best)
        fits += [] if without is None else [without]
    return min(fits, key=structure_cost)


def structure_cost(fitted: FittedStructure) -> float:
    """Minus twice the log likelihood of a residual's pieces, and the charges.

    Parameters
    ----------
    fitted : FittedStructure

    Returns
    -------
    float
    """
    beyond = max(fitted.rmse_deg**2 - fitted.noise.spread_deg**2, 1e-3 * fitted.noise.spread_deg**2)
    return INDEPENDENT_PIECES * float(np.log(beyond)) + charges(fitted)


def charges(fitted: FittedStructure) -> float:
    """What the parameters and effects of a fit are charged, as minus twice a log likelihood.

    Parameters
    ----------
    fitted : FittedStructure

    Returns
    -------
    float
    """
    parameters = len(fitted.beta) + len(fitted.fit_parameters)
    return PARAMETER_CHARGE * parameters + EFFECT_CHARGE * len(fitted.terms)
