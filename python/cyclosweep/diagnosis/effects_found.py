"""The accepted effects with size, interval, parameters and evidence."""

from collections.abc import Callable, Collection, Mapping
from dataclasses import replace

import numpy as np
from scipy import stats

from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.effect_chance import chance_of_effect
from cyclosweep.diagnosis.elasticity import (
    added_twist,
    compliance_with_curve,
)
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.friction_reached import friction_reached_nm
from cyclosweep.diagnosis.identify.laws.class_check import candidates_of
from cyclosweep.diagnosis.identify.structures.alarm import probability
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.testability import (
    Testability,
    recalibration,
    spread_of_size,
    strength_of,
)
from cyclosweep.result import (
    BehaviourClass,
    EffectParameter,
    Explanation,
    FoundEffect,
    Hypothesis,
    Size,
)
from cyclosweep.result.effects import Outcome
from cyclosweep.result.part import NORMAL_95, finite


def found_effects(concluded: Conclusion, e_value: float) -> tuple[FoundEffect, ...]:
    """Describe the effects of the accepted structure that may be named.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    e_value : float
        Evidence for that structure from data that were not fitted.

    Returns
    -------
    tuple of FoundEffect
    """
    names = concluded.naming.names
    return tuple(
        _effect(concluded.search, concluded.accepted, index, names, e_value)
        for index, term in enumerate(concluded.accepted.fit.terms)
        if term.name in names
    )


def _effect(
    search: Search, accepted: Candidate, index: int, names: Collection[str], e_value: float
) -> FoundEffect:
    """Describe one term of the accepted structure.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure that was accepted.
    index : int
        Which of the structure's terms.
    names : collection of str
        Names of the terms that may be named.
    e_value : float
        Evidence for the structure on held-out data.

    Returns
    -------
    FoundEffect
    """
    fitted = accepted.fit
    effect = fitted.terms[index].effect
    assert effect is not None
    twist = recalibration(fitted)(added_twist(fitted, index)[fitted.problem.fitted])
    size = float(np.max(np.abs(twist), initial=0.0))
    strength = strength_of(search, fitted, index)
    stand_ins = [k for k, term in enumerate(fitted.terms) if term.name not in names]
    if strength < NORMAL_95 and effect.slips and stand_ins:
        # Together with the line they could take its place.
        strength = strength_of(search, fitted, index, stand_ins)
    if fitted.follows_path(index):
        spread = size / max(strength, 1e-9)
    else:
        spread = spread_of_size(fitted, index, fitted.covariance_within_bounds)
    p_value = chance_of_effect(search, accepted, index)
    if NORMAL_95 * spread >= size:  # it may be nothing at all: the same spread judges the chance
        p_value = max(p_value, 2.0 * float(stats.norm.sf(size / max(spread, 1e-300))))
    parameters = _parameters(fitted, index)
    if effect.slips:
        # Two frictions may be certain together, and neither of them by itself.
        limit = parameters[effect.amplitudes(fitted.terms[index].shape)[0].name]
        unknown = 1.0 if limit.std_error is None else limit.std_error / max(limit.estimate, 1e-300)
        spread = max(spread, size * unknown)
    half = NORMAL_95 * spread
    return FoundEffect(
        name=effect.name,
        physics=f"{effect.physics} {_found_law(fitted, index)}".rstrip(),
        source=effect.source,
        parameters=parameters,
        size_deg=Size(estimate=size, ci95=(max(size - half, 0.0), size + half)),
        size_arcmin=60.0 * size,
        size_nm=finite(size / compliance_with_curve(fitted)[0]),
        reached_nm=_reached(fitted, effect.name) if effect.slips else None,
        rms_deg=float(np.sqrt(np.mean(twist**2))),
        p_value=p_value,
        e_value=finite(e_value),
        detectability=strength,
    )


def _reached(fitted: FittedStructure, name: str) -> float:
    """Largest torque that the friction of a name takes on the rows that count [N m].

    Parameters
    ----------
    fitted : FittedStructure
    name : str

    Returns
    -------
    float
    """
    problem, path = fitted.problem, fitted.prediction_path
    rows = problem.whole_fitted | problem.whole_held_out
    return friction_reached_nm(fitted.terms, path, name, rows)


def _found_law(fitted: FittedStructure, index: int) -> str:
    """Which of an effect's laws was found, in a sentence; empty where it has one.

    Parameters
    ----------
    fitted : FittedStructure
        Structure fitted jointly with the calibration.
    index : int
        Which of the structure's terms.

    Returns
    -------
    str
    """
    term = fitted.terms[index]
    if term.effect is None or term.slips:
        return ""
    found = fitted.beta[fitted.column_range(index)]
    return term.effect.found_law(fitted.history, term.shape, found)


def _parameters(fitted: FittedStructure, index: int) -> Mapping[str, EffectParameter]:
    """Amplitudes and shape parameters of a term with standard errors.

    Parameters
    ----------
    fitted : FittedStructure
        Structure fitted jointly with the calibration.
    index : int
        Which of the structure's terms.

    Returns
    -------
    mapping of str to EffectParameter
        By name, each in its own unit.
    """
    term = fitted.terms[index]
    assert term.effect is not None
    errors = np.sqrt(np.maximum(np.diag(fitted.covariance_within_bounds), 0.0))
    amplitudes = term.effect.amplitudes(term.shape)
    found: dict[str, EffectParameter] = {}
    if not term.slips:
        for quantity, place in zip(amplitudes, fitted.amplitude_places(index), strict=False):
            found[quantity.name] = EffectParameter(
                estimate=float(fitted.beta[place]),
                std_error=finite(errors[place]),
                unit=quantity.unit,
                meaning=quantity.meaning,
            )
    for k, nonlinear in enumerate(fitted.fit_parameters):
        if nonlinear.term != index:
            continue
        name, value = nonlinear.name, term.amplitude
        if name == "amplitude":
            name = amplitudes[0].name
        else:
            value = float(term.shape[name])
        error = float(errors[len(fitted.beta) + k])
        found[name] = EffectParameter(
            estimate=value,
            std_error=finite(error * value if nonlinear.quantity.logarithmic else error),
            unit=nonlinear.quantity.unit,
            meaning=nonlinear.quantity.meaning,
        )
    return found


def classes_shown(concluded: Conclusion) -> tuple[BehaviourClass, ...]:
    """Classes of behaviour of the named effects, then those that no law stands for.

    Parameters
    ----------
    concluded : Conclusion
        With the effects that may be named.

    Returns
    -------
    tuple of BehaviourClass
    """
    naming, library = concluded.naming, concluded.search.library
    named = naming.names if concluded.decision.verdict != "INSUFFICIENT_DATA" else frozenset()
    listed = []
    for behaviour in dict.fromkeys(check.behaviour for check in naming.checks if check.behaviour):
        alike = [c for c in naming.checks if c.behaviour == behaviour and c.name in named]
        if alike:
            laws = tuple(check.name for check in alike)
            missed = finite(max(check.missed_share for check in alike))
            listed.append(BehaviourClass(behaviour=behaviour, laws=laws, missed_share=missed))
        elif concluded.decision.verdict == "INSUFFICIENT_DATA":
            known = candidates_of(behaviour, library)
            listed.append(BehaviourClass(behaviour=behaviour, candidates=known))
    if not concluded.decision.unexplained:
        return tuple(listed)
    of_model = {term.name for term in concluded.accepted.fit.terms}
    gone = [check for check in naming.withdrawn if check.name in of_model]
    for each in naming.shown:
        known = candidates_of(each.behaviour, library)
        listed.append(
            BehaviourClass(
                behaviour=each.behaviour,
                visibility=finite(each.visibility),
                stand_ins=tuple(c.name for c in gone if c.behaviour == each.behaviour),
                candidates=tuple(name for name in known if name not in named),
            )
        )
    return tuple(listed)


def explanations(concluded: Conclusion) -> tuple[Explanation, ...]:
    """Return the explanations with their probabilities, the most probable first.

    The calibrated model alone explains nothing where something is left. Stages may have found one
    structure more than once, beside others: it is one explanation.
    """
    decision = concluded.decision
    found: dict[tuple[frozenset[str], frozenset[str]], Explanation] = {}
    for each, share in decision.explanations:
        if not each.fit.terms and decision.unexplained:
            continue
        one = _explanation(each, share)
        key = frozenset(one.effects), frozenset(one.without_name)
        known = found.get(key)
        if known is not None:
            one = replace(known, probability=known.probability + share)
        found[key] = one
    return tuple(sorted(found.values(), key=lambda each: -each.probability))


def _explanation(candidate: Candidate, probability: float) -> Explanation:
    """One structure with its probability.

    Parameters
    ----------
    candidate : Candidate
        The structure.
    probability : float
        Its probability.

    Returns
    -------
    Explanation
    """
    terms = list(zip(candidate.fit.terms, candidate.recognised, strict=True))
    return Explanation(
        effects=tuple(term.name for term, named in terms if named),
        without_name=tuple(
            term.name if term.effect is None else term.effect.family
            for term, named in terms
            if not named
        ),
        probability=probability,
    )


def tried_effects(
    concluded: Conclusion, found: tuple[FoundEffect, ...], hidden: tuple[str, ...]
) -> tuple[Hypothesis, ...]:
    """Return every effect of the library, accepted or not, with its size or upper bound.

    Parameters
    ----------
    concluded : Conclusion
        With bounds of what was not found.
    found : tuple of FoundEffect
        The accepted effects.
    hidden : tuple of str
        What the recording cannot show.

    Returns
    -------
    tuple of Hypothesis
        Accepted ones first, then those with a bound, then what cannot be tested.
    """
    at_baseline = {bound.name: bound for bound in concluded.beyond_baseline}
    chance = _chance_beside(concluded)
    return (
        *(_accepted(effect, at_baseline.get(effect.name)) for effect in found),
        *(
            replace(_bounded(bound, bound.name in concluded.excluded), p_value=chance(bound))
            for bound in concluded.beyond_accepted
        ),
        *(Hypothesis(name=name, outcome="not testable") for name in hidden),
    )


def _chance_beside(concluded: Conclusion) -> Callable[[Testability], float | None]:
    """Probability of as much evidence for an effect where the accepted ones are all there is.

    None where the residual is error of the model: it is no noise, so that nothing has a chance.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.

    Returns
    -------
    callable
        From the bound of an effect to its probability.
    """
    search, accepted = concluded.search, concluded.accepted
    if accepted is search.baseline:
        return lambda bound: bound.p_value
    if search.noise.structured:
        return lambda bound: None
    null, excesses = search.null(accepted), accepted.excesses
    return lambda bound: probability(null, excesses.get(bound.name, 0.0))


def _accepted(effect: FoundEffect, bound: Testability | None) -> Hypothesis:
    """Row of an accepted effect.

    Parameters
    ----------
    effect : FoundEffect
        The effect as it was found.
    bound : Testability or None
        How well the recording shows it, where that is known.

    Returns
    -------
    Hypothesis
    """
    return Hypothesis(
        name=effect.name,
        outcome="accepted",
        absorbed_share=None if bound is None else bound.absorbed_share,
        size_deg=effect.size_deg.estimate,
        ci95_deg=effect.size_deg.ci95,
        p_value=effect.p_value,
        e_value=effect.e_value,
        smallest_detectable_deg=None if bound is None else bound.smallest_detectable_deg,
    )


def _bounded(bound: Testability, excluded: bool) -> Hypothesis:
    """Row of an effect that was not found.

    Parameters
    ----------
    bound : Testability
        How well the recording shows the effect.
    excluded : bool
        Whether it is ruled out at the tolerance.

    Returns
    -------
    Hypothesis
    """
    outcome: Outcome = "ruled out" if excluded else "undecided"
    return Hypothesis(
        name=bound.name,
        outcome=outcome,
        absorbed_share=bound.absorbed_share,
        size_deg=bound.estimate_deg,
        ci95_deg=(0.0, bound.upper95_deg),
        p_value=bound.p_value,
        smallest_detectable_deg=bound.smallest_detectable_deg,
    )
