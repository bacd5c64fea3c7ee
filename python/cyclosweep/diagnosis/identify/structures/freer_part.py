"""A part of a structure with the freedom that its friction has in the whole.

Friction that was given more freedom beside a further effect may owe the gain to that freedom and
not to the effect. The part without the effect is therefore fitted with that freedom, too.
"""

from collections.abc import Callable

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.structures.candidate import FURTHER, Candidate, prior_penalty
from cyclosweep.diagnosis.identify.structures.scan import evidence
from cyclosweep.diagnosis.prepare.noise import Noise


def freer_part(
    whole: Candidate,
    left_out: str,
    known: Candidate,
    noise: Noise,
    gain: Callable[[FittedStructure, FittedStructure], float],
) -> tuple[FittedStructure, float, float] | None:
    """Fit a structure without one of its terms, its friction as free as it is in it.

    Parameters
    ----------
    whole : Candidate
        The structure.
    left_out : str
        Name of the term that is left out.
    known : Candidate
        The part as it was visited before.
    noise : Noise
    gain : callable
        Twice the log likelihood gained from one fit to the next.

    Returns
    -------
    (FittedStructure, float, float) or None
        The part, its log evidence over the baseline and its log prior odds [nat]; None where its
        friction is as free already, or where it is no better.
    """
    free = {term.name: term for term in whole.fit.terms if term.slips}
    terms = tuple(free.get(term.name, term) for term in known.fit.terms)
    if all(set(a.shape) <= set(b.shape) for a, b in zip(terms, known.fit.terms, strict=True)):
        return None
    found = with_right_signs(fit(whole.fit.problem, noise, terms, whole.fit))
    if found is None or {term.name for term in found.terms} != known.names:
        return None
    (term,) = (each for each in whole.fit.terms if each.name == left_out)
    amplitudes = 1 if term.effect is None else len(term.effect.amplitudes(term.shape))
    evidence_of_part = whole.gain - float(evidence(gain(found, whole.fit), amplitudes))
    prior = whole.prior + FURTHER + prior_penalty(term.name, term.effect, term.shape)
    if evidence_of_part + prior <= known.score:
        return None
    return found, evidence_of_part, prior
