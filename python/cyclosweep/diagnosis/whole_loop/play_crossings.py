"""How friction meets the play, as the crossings of the dead zone show it.

Friction that slides through the play holds the shaft back until the torque has overcome it;
friction behind the play lets it cross where the torque changes its sign. Of readings whose flank is
known both leave nearly the same, and a simulation of the wrong one is off by the whole play in all
rows between the two places.
"""

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.stages.friction_first import in_other_states
from cyclosweep.diagnosis.identify.structures.candidate import Candidate
from cyclosweep.diagnosis.identify.structures.search import Search
from cyclosweep.diagnosis.whole_loop.forecast import predicted_path

FORECAST_WORSE = 1.3
"""Error of the simulation of all rows over that on the flanks up to which crossings are right; and
over that of the simulation of another state from which the other one is taken."""
FLANKS_WORSE = 1.1
"""Error on the flanks over that of the state before, up to which another state is possible."""


def take_recorded_crossings(search: Search, candidate: Candidate) -> None:
    """Let friction meet the play in the way in which a simulation crosses it as recorded.

    Parameters
    ----------
    search : Search
        After it has run.
    candidate : Candidate
        A structure that was found. It is replaced in the search by the same with friction in
        another state, where that is clearly better.
    """
    found = candidate.fit
    if search.problem.one_sided or search.problem.history.free_play_deg <= 0.0:
        return
    if any(t.effect is None for t in found.terms) or not any(t.slips for t in found.terms):
        return
    best, error = found, _forecast_error(found)
    if error <= FORECAST_WORSE * found.rmse_deg:
        return
    for other in in_other_states(search.noise, found):
        # Physics may have left out an effect on the way.
        if set(other.names) != set(found.names):
            continue
        if other.rmse_deg > FLANKS_WORSE * found.rmse_deg:
            continue
        crossed = _forecast_error(other)
        if crossed < (error / FORECAST_WORSE if best is found else error):
            best, error = other, crossed
    if best is not found:
        # What it is off by on the crossings counts for the state, not against the structure.
        gained = max(0.5 * search.chi2_gain(found, best), 0.0)
        turned = search.judged(best, candidate.gain + gained, candidate.prior)
        if search.suffices(candidate) and not search.suffices(turned):
            return
        search.visited[turned.names] = turned
        if search.start is candidate:
            search.start = turned


def _forecast_error(fitted: FittedStructure) -> float:
    """Root mean square of what a structure, simulated, leaves of all rows [deg]."""
    problem = fitted.problem
    simulated = predicted_path(problem, fitted.model("")).angle_deg
    return problem.rms_error(simulated, problem.whole_fitted)
