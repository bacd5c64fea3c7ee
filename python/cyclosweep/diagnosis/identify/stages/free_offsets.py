"""A datum that moves by no law, in the place of other laws that share its offsets among them.

Offsets of runs are a few numbers. Before a datum is given free offsets, an error of transmission
takes up what the law of the datum misses: a few orders make any offsets of a few positions.
"""

from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.signs import with_right_signs
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.laws.law_in_class import amplitude_count
from cyclosweep.diagnosis.identify.stages.other_laws import FAR_LESS, left_beyond_noise
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.simulation.effects.order_names import travels

SHARED = ("datum_drift", "transmission_error")
"""Effects that give each run an offset by other means than a recorded temperature."""

NO_MORE = 1.05
"""What free offsets leave over what laws of as many amplitudes leave, from which it is more."""


def with_free_offsets(search: Search, accepted: Candidate) -> Candidate:
    """Put free offsets of the runs in the place of laws that leave more than twice as much.

    So they are put where the laws have as many amplitudes as there are offsets, and so say nothing.

    Parameters
    ----------
    search : Search
        Search of the recording.
    accepted : Candidate
        Structure of effects.

    Returns
    -------
    Candidate
        The same where there are no such laws, or where a law or the position explains the offsets.
    """
    shared = [term for term in accepted.fit.terms if term.name in SHARED]
    datum = next((s for s in search.library.signatures if "each_run" in s.shape), None)
    if datum is None or not any(t.name == SHARED[1] and not travels(t.shape) for t in shared):
        return accepted
    others = tuple(term for term in accepted.fit.terms if term not in shared)
    terms = (*others, Term(datum.effect, datum.shape))
    found = with_right_signs(fit(search.problem, search.noise, terms, accepted.fit))
    if found is None:
        return accepted
    places = (k for k, term in enumerate(accepted.fit.terms) if term.name in SHARED)
    amplitudes = sum(amplitude_count(accepted.fit, place) for place in places)
    most = NO_MORE if amplitudes >= accepted.fit.history.run_count - 1 else FAR_LESS
    if left_beyond_noise(found) > most * left_beyond_noise(accepted.fit):
        return accepted
    free = search.judged(found, accepted.gain, accepted.prior)
    return free if free.all_recognised else accepted
