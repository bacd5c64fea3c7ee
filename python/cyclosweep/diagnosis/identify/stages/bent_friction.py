"""Friction whose limit is no line of the load, in the place of further effects."""

from dataclasses import replace

from cyclosweep.diagnosis.identify.fitting.explained import beyond_noise_deg
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import CONVERGED, LEAST_REMOVED
from cyclosweep.diagnosis.identify.structures.candidate import FURTHER, Candidate
from cyclosweep.diagnosis.identify.structures.scan import evidence
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.worth import INDISPENSABLE


def bent_instead_of_others(search: Search, acceptable: Candidate) -> Candidate | None:
    """Friction of a limit that is bent over the load, where further effects explain less.

    What a limit in proportion to the load misses looks like a softening, a take-up or friction
    without load. These are tried first in each stage, as a bent limit could hold a part of them.

    Parameters
    ----------
    search : Search
        Search of a stage, run.
    acceptable : Candidate
        What the stage would accept else, perhaps nothing beyond its start.

    Returns
    -------
    Candidate or None
        None where no friction grows with the load, where a bent limit leaves more than half of the
        mean square beyond the noise, or where what is acceptable is likelier.
    """
    start, left = search.start, beyond_noise_deg(search.start.fit)
    if left == 0.0:
        return None
    found: Candidate | None = None
    for terms in _bent(search):
        fitted = fit(search.problem, search.noise, terms, start.fit, rounds=CONVERGED)
        joint = with_right_signs(fitted)
        if joint is None or len(joint.terms) < len(terms):
            continue
        if beyond_noise_deg(joint) ** 2 > (1.0 - LEAST_REMOVED) * left**2:
            continue
        fewer = len(start.fit.terms) - len(terms)
        added = float(evidence(search.chi2_gain(start.fit, joint), 1.0))
        other = search.judged(joint, start.gain + added, start.prior + FURTHER * fewer)
        if found is None or other.score > found.score:
            found = other
    least = max(acceptable.score, start.score + INDISPENSABLE)
    return found if found is not None and found.score > least else None


def _bent(search: Search) -> list[tuple[Term, ...]]:
    """Structures with bent friction, and the same without the friction that knows no load.

    Parameters
    ----------
    search : Search
        Search of a stage, whose start it is about.

    Returns
    -------
    list of tuple of Term
    """
    history, terms = search.problem.history, search.start.fit.terms
    found = []
    for grows in [term for term in terms if term.slips]:
        assert grows.effect is not None
        for shape in grows.effect.refinements(history, grows.shape):
            bent = tuple(replace(each, shape=shape) if each.slips else each for each in terms)
            alone = tuple(each for each in bent if not each.slips or each.name == grows.name)
            found += [bent] if len(alone) == len(bent) else [bent, alone]
    return found
