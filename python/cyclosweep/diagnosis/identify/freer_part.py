"""A part of a structure with the freedom that its friction has in the whole.

Friction that was given more freedom beside a further effect may owe the gain to that freedom and
not to the effect. The part without the effect is therefore fitted with that freedom, too.
"""

from typing import TYPE_CHECKING

from cyclosweep.diagnosis.identify.candidate import EXTRA_TERM_PENALTY, Candidate, prior_penalty
from cyclosweep.diagnosis.identify.fit import fit
from cyclosweep.diagnosis.identify.scan import evidence
from cyclosweep.diagnosis.identify.signs import with_right_signs

if TYPE_CHECKING:
    from cyclosweep.diagnosis.identify.search import Search


def freer_part(
    search: "Search", whole: Candidate, left_out: str, known: Candidate
) -> Candidate | None:
    """Fit a structure without one of its terms, its friction as free as it is in it.

    Parameters
    ----------
    search : Search
    whole : Candidate
        The structure.
    left_out : str
        Name of the term that is left out.
    known : Candidate
        The part as it was visited before.

    Returns
    -------
    Candidate or None
        None where the friction of the part is as free already, or where the part is no better.
    """
    free = {term.name: term for term in whole.fit.terms if term.slips}
    terms = tuple(free.get(term.name, term) for term in known.fit.terms)
    if all(set(a.shape) <= set(b.shape) for a, b in zip(terms, known.fit.terms, strict=True)):
        return None
    found = with_right_signs(fit(search.problem, search.noise, terms, whole.fit))
    if found is None or {term.name for term in found.terms} != known.names:
        return None
    (term,) = (each for each in whole.fit.terms if each.name == left_out)
    amplitudes = 1 if term.effect is None else len(term.effect.amplitudes(term.shape))
    worth = float(evidence(search.gain(found, whole.fit), amplitudes))
    prior = whole.prior + EXTRA_TERM_PENALTY + prior_penalty(term.name, term.effect, term.shape)
    part = search.judged(found, whole.gain - worth, prior)
    return part if part.score > known.score else None
