"""Whether runs that a recording takes to begin afresh go on from each other."""

from collections.abc import Callable
from functools import cache

import numpy as np

from cyclosweep.diagnosis.friction_in_noise import model_error_noise
from cyclosweep.diagnosis.identify.fitting.fit import fit
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.terms import Term
from cyclosweep.diagnosis.identify.stages.friction_first import (
    CONVERGED,
    charges,
    friction_first,
    structure_cost,
)
from cyclosweep.diagnosis.identify.stages.other_laws import DELAYED
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.identify.structures.verdict import (
    WITHIN_NOISE,
    accepted_in_stages,
    decide,
)
from cyclosweep.diagnosis.identify_effects import identify
from cyclosweep.diagnosis.prepare.noise_estimate import as_model_error
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.recording import Recording
from cyclosweep.recording.unbroken_runs import runs_can_go_on
from cyclosweep.result.part import NORMAL_95
from cyclosweep.simulation.effects.datum_drift import DatumDrift
from cyclosweep.simulation.effects.load_dependent_friction import LoadDependentFriction

CLEARLY = 20.0
"""What one history must gain, as `structure_cost` counts: two fifths of the mean square of what
runs leave that begin afresh."""
CLEARLY_LIKELIER = 40.0
"""What it must gain against the noise, as minus twice the log likelihood."""
AS_WELL = NORMAL_95**2
"""Minus twice the log likelihood that fewer effects may lack where runs go on."""


def identify_over_runs(
    recording: Recording,
    prepared: Callable[[bool], Problem],
    calibrated: Callable[[Problem], Search],
    say: Callable[[str], None],
) -> Search:
    """Identify what is missing of runs that begin afresh, or that go on from each other.

    Parameters
    ----------
    recording : Recording
    prepared : callable
        From whether runs go on from each other, though the recording does not say so, to the
        prepared recording.
    calibrated : callable
        From that to a calibrated search.
    say : callable
        Called with a few words before each long step.

    Returns
    -------
    Search
        With all visited structures.
    """
    searched = identify(calibrated(prepared(False)), say)
    if not may_be_one_history(recording):
        return searched
    found = best_structure(searched)
    if not _may_remember(found):
        return searched
    problem = prepared(True)

    @cache
    def joined() -> Search:
        return calibrated(problem)

    if not explains_more(searched, found, problem, joined):
        return searched
    say("starting over with runs that go on from each other")
    again = identify(joined(), say)
    return again if _remembers(best_structure(again)) else searched


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


def explains_more(
    searched: Search, found: FittedStructure, problem: Problem, joined: Callable[[], Search]
) -> bool:
    """Whether what was found explains clearly more where runs go on from each other.

    Parameters
    ----------
    searched : Search
        A search that has run, of runs that begin afresh.
    found : FittedStructure
        Its best structure.
    problem : Problem
        The same runs as one history.
    joined : callable
        Returns a calibrated search of them, with nothing visited.

    Returns
    -------
    bool
    """
    terms, noise = _named(found), searched.noise
    afresh = fit(searched.problem, noise, terms, found, rounds=CONVERGED)
    # What creep or friction leaves to the next run, a datum that drifts stands in for.
    still = tuple(term for term in terms if term.name != DatumDrift.name)
    alone = tuple(term for term in terms if term.slips)
    line: FittedStructure = fit(problem, noise, ())
    offered = dict.fromkeys((terms, still, alone), line)
    friction = friction_of(joined, found)
    if friction is not None:
        offered[friction.terms] = friction
    going_on = min(
        (fit(problem, noise, kept, near, rounds=CONVERGED) for kept, near in offered.items()),
        key=structure_cost,
    )
    likelier = afresh.loss + charges(afresh) - going_on.loss - charges(going_on)
    if going_on.loss < afresh.loss + AS_WELL and set(going_on.names) < set(afresh.names):
        return True
    if afresh.line_compliance_deg_per_nm <= 0.0 < going_on.line_compliance_deg_per_nm:
        # No drive has the first one.
        return going_on.rmse_deg < WITHIN_NOISE * noise.spread_deg
    if likelier <= CLEARLY_LIKELIER:
        return False
    # What is left of either may be error of the laws, of which there is less than there are rows.
    within_noise = going_on.rmse_deg < noise.spread_deg
    return within_noise or structure_cost(afresh) - structure_cost(going_on) > CLEARLY


def friction_of(joined: Callable[[], Search], found: FittedStructure) -> FittedStructure | None:
    """Friction alone of runs that go on, where what was found may stand in for it.

    Parameters
    ----------
    joined : callable
        Returns a calibrated search of the runs as one history.
    found : FittedStructure
        What was found of runs that begin afresh.

    Returns
    -------
    FittedStructure or None
        None where nothing found may stand in for it and little is left, or no friction is found.
    """
    doubtful = any(map(_may_be_friction_that_goes_on, found.terms))
    if not doubtful and found.rmse_deg <= WITHIN_NOISE * _from_row_to_row(found):
        return None
    search = joined()
    assert search.flexible is not None
    return friction_first(search, model_error_noise(search.problem, search.noise, search.flexible))


def _from_row_to_row(found: FittedStructure) -> float:
    """Standard deviation of what differs from row to row, by what a structure leaves [deg]."""
    problem = found.problem
    travel_deg = float(np.ptp(problem.angle_deg[problem.fitted]))
    step_deg = problem.resolution_deg
    return as_model_error(found.noise, found.residual_deg, step_deg, travel_deg).sigma_deg


def _may_be_friction_that_goes_on(term: Term) -> bool:
    """Creep, drag, friction that grows with the load, or any shape without a name."""
    if term.slips:
        return term.name == LoadDependentFriction.name
    return term.effect is None or term.family in DELAYED


def _named(fitted: FittedStructure) -> tuple[Term, ...]:
    """Effects of a structure that have a name."""
    return tuple(term for term in fitted.terms if term.effect is not None)


def _remembers(fitted: FittedStructure) -> bool:
    """Whether a named effect of a structure has a memory of the load over runs."""
    return any(term.slips or term.family in DELAYED for term in _named(fitted))


def _may_remember(fitted: FittedStructure) -> bool:
    """Whether a structure has such a memory, or a shape without a name that may stand for it."""
    return _remembers(fitted) or len(_named(fitted)) < len(fitted.terms)


def best_structure(searched: Search) -> FittedStructure:
    """Return the structure that the verdict on a search rests on."""
    best = accepted_in_stages(searched) or decide(searched).best or searched.baseline
    return best.fit
