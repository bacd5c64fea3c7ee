"""Whether runs that a recording takes to begin afresh go on from each other."""

from collections.abc import Callable

from cyclosweep.diagnosis.friction_in_noise import FAR_ABOVE_STEPS, model_error_noise
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import (
    CONVERGED,
    charges,
    friction_first,
    structure_cost,
)
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import accepted_in_stages, decide
from cyclosweep.diagnosis.identify_effects import identify
from cyclosweep.recording import Recording
from cyclosweep.recording.unbroken_runs import runs_can_go_on
from cyclosweep.simulation.effects.datum_drift import DatumDrift

CLEARLY = 20.0
"""What one history must gain, as `structure_cost` counts: two fifths of the mean square of what
runs leave that begin afresh."""
CLEARLY_LIKELIER = 40.0
"""What it must gain against the noise, as minus twice the log likelihood."""
CREEP = "relaxation"
"""Family of the effects whose delayed twist at the end of a run may go on in the next."""


def identify_over_runs(
    recording: Recording, calibrated: Callable[[bool], Search], say: Callable[[str], None]
) -> Search:
    """Identify what is missing of runs that begin afresh, or that go on from each other.

    Parameters
    ----------
    recording : Recording
    calibrated : callable
        From whether runs go on from each other, though the recording does not say so, to the
        calibrated search of it.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        With all visited structures.
    """
    searched = identify(calibrated(False), say)
    if not may_be_one_history(recording):
        return searched
    found = _best(searched)
    if not _remembers(found):
        return searched
    joined = calibrated(True)
    if not explains_more(searched, found, joined):
        return searched
    say("starting over with runs that go on from each other")
    again = identify(joined, say)
    return again if _remembers(_best(again)) else searched


def may_be_one_history(recording: Recording) -> bool:
    """Whether runs could go on from each other without the recording saying so.

    Parameters
    ----------
    recording : Recording

    Returns
    -------
    bool
        False for a single run, and where `runs_can_go_on` is.
    """
    stated = recording.history == "continuous"
    return not stated and len(recording.runs) > 1 and runs_can_go_on(recording)


def explains_more(searched: Search, found: FittedStructure, joined: Search) -> bool:
    """Whether what was found explains clearly more where runs go on from each other.

    Parameters
    ----------
    searched : Search
        A search that has run, of runs that begin afresh.
    found : FittedStructure
        Its best structure.
    joined : Search
        Calibrated, with nothing visited, of the same runs as one history.

    Returns
    -------
    bool
    """
    terms, noise = _named(found), searched.noise
    afresh = fit(searched.problem, noise, terms, found, rounds=CONVERGED)
    # What creep or friction leaves to the next run, a datum that drifts stands in for.
    still = tuple(term for term in terms if term.name != DatumDrift.name)
    offered = dict.fromkeys((terms, still), joined.baseline.fit)
    friction = friction_of(joined, found.rmse_deg)
    if friction is not None:
        offered[friction.terms] = friction
    going_on = min(
        (
            fit(joined.problem, noise, kept, near, rounds=CONVERGED)
            for kept, near in offered.items()
        ),
        key=structure_cost,
    )
    likelier = afresh.loss + charges(afresh) - going_on.loss - charges(going_on)
    if likelier <= CLEARLY_LIKELIER:
        return False
    # What is left of either may be error of the laws, of which there is less than there are rows.
    within_noise = going_on.rmse_deg < noise.spread_deg
    return within_noise or structure_cost(afresh) - structure_cost(going_on) > CLEARLY


def friction_of(joined: Search, left_deg: float) -> FittedStructure | None:
    """Friction alone of runs that go on, where much is left of those that begin afresh.

    What was found of them may stand in for friction that starts otherwise.

    Parameters
    ----------
    joined : Search
        Calibrated, of the runs as one history.
    left_deg : float
        Error of what was found of runs that begin afresh [deg].

    Returns
    -------
    FittedStructure or None
        None where little is left, or no friction is found.
    """
    assert joined.flexible is not None
    little = model_error_noise(joined.problem, joined.noise, joined.flexible)
    return friction_first(joined, little) if left_deg > FAR_ABOVE_STEPS * little.sigma_deg else None


def _named(fitted: FittedStructure) -> tuple[Term, ...]:
    """Effects of a structure that have a name."""
    return tuple(term for term in fitted.terms if term.effect is not None)


def _remembers(fitted: FittedStructure) -> bool:
    """Whether a named effect of a structure has a memory of the load over runs."""
    return any(term.slips or term.family == CREEP for term in _named(fitted))


def _best(searched: Search) -> FittedStructure:
    """The structure that the verdict on a search rests on."""
    best = accepted_in_stages(searched) or decide(searched).best or searched.baseline
    return best.fit
