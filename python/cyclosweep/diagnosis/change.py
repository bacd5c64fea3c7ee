"""Change of the drive while it was tested: the same part of the load history, earlier and later."""

from dataclasses import dataclass

import numpy as np

from cyclosweep.diagnosis.conclude import Conclusion
from cyclosweep.diagnosis.growth import GROWTH_LEVEL, LEAST_GROWTH, growth
from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.sweeps import FEWEST_ROWS, Sweep, equal_sweeps
from cyclosweep.result import DriveChange
from cyclosweep.result.part import NORMAL_95
from cyclosweep.simulation.effects.history import Floats, History

BY_RUN = "compliance by run"
"""Name of the shape with a compliance for each run."""
WINDOW = (0.25, 0.95)
"""Part of the load of a sweep over which its slope is taken: away from the dead zone, and from the
reversal itself."""
FEWEST_SWEEPS = 6
"""Equal sweeps beyond one a group from which a trend is told from scatter."""
DRAWS = 1999
"""Orders of the sweeps that are tried at random."""
CLEANED_LEVEL = 0.02
"""Probability by chance that growth may have once the named effects are removed: the measured one
has been tested already, this asks only whether an effect explains it."""
LEAST_RATIO = 4.0
"""Trend over its standard error from the scatter of equal sweeps, as a second guard: neighbouring
sweeps share slow noise, which the random orders do not."""


@dataclass(frozen=True)
class Trend:
    """Trend of the logarithm of the compliance over the recording.

    Attributes
    ----------
    slope, std_error : float
        Change from the first row to the last, and its standard error.
    p_value : float
        Share of random orders of equal sweeps with as large a trend.
    middle : float
        Weighted mean of the place of the sweeps, 0 at the first row and 1 at the last.
    first, last : float
        Places of the first and last sweep.
    sweeps : int
        Number of sweeps compared.
    """

    slope: float
    std_error: float
    p_value: float
    middle: float
    first: float
    last: float
    sweeps: int

    @property
    def is_change(self) -> bool:
        """Whether the drive changed, beyond scatter and by as much as matters."""
        change = abs(self.slope) * (self.last - self.first)
        beyond = abs(self.slope) >= LEAST_RATIO * self.std_error
        return self.p_value <= GROWTH_LEVEL and beyond and change >= LEAST_GROWTH


def find_change(concluded: Conclusion) -> DriveChange | None:
    """Compare equal parts of the load history, as measured and with the named effects removed.

    Slopes of equal sweeps (same direction, reversals, mesh position and rate), and growth of the
    loops at equal torque where the range grows; where too little is passed twice, compliances of
    the runs, if the best structure has one for each. Neither a law that is not quite
    right nor another load can differ between them. What the accepted effects explain, as creep
    that settles, is no change; what they alone would bring in is none either.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.

    Returns
    -------
    DriveChange or None
        None where the compliance holds, or no state was passed often enough to see it.
    """
    problem, fit = concluded.search.problem, concluded.accepted.fit
    compliance = fit.history.compliance_deg_per_nm
    if compliance <= 0:
        return None
    line = fit.history.datum_deg + fit.history.side * fit.history.free_play_deg
    effects = fit.mean_deg - line - compliance * problem.history.applied_nm
    cleaned = problem.angle_deg - effects if fit.terms else problem.angle_deg
    return _by_sweeps(concluded, cleaned) or _by_growth(concluded, cleaned) or _by_runs(concluded)


def _by_sweeps(concluded: Conclusion, cleaned_deg: Floats) -> DriveChange | None:
    """Change of the slope of equal sweeps.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    cleaned_deg : ndarray, shape (n,)
        Measured twist less the accepted effects [deg].

    Returns
    -------
    DriveChange or None
    """
    problem = concluded.search.problem
    groups = equal_sweeps(problem.history)
    measured = trend(problem.history, problem.angle_deg, groups, concluded.search.seed)
    if measured is None or not measured.is_change:
        return None
    left = trend(problem.history, cleaned_deg, groups, concluded.search.seed)
    if left is None or not left.is_change or left.slope * measured.slope < 0:
        return None
    return _change_by(left, concluded.accepted.fit.history.compliance_deg_per_nm)


def _by_growth(concluded: Conclusion, cleaned_deg: Floats) -> DriveChange | None:
    """Growth of the loops at equal torque, the calibrated compliance being the middle one.

    Parameters
    ----------
    concluded : Conclusion
        With the accepted structure.
    cleaned_deg : ndarray, shape (n,)
        Measured twist less the accepted effects [deg].

    Returns
    -------
    DriveChange or None
    """
    problem = concluded.search.problem
    measured = growth(problem.history, problem.angle_deg)
    if measured is None or not measured.is_change:
        return None
    left = growth(problem.history, cleaned_deg)
    if left is None or left.p_value > CLEANED_LEVEL or left.logarithm < LEAST_GROWTH:
        return None
    compliance = concluded.accepted.fit.history.compliance_deg_per_nm
    return _drive_change(
        compliance,
        (-measured.logarithm / 2.0, measured.logarithm / 2.0),
        measured.std_error,
        max(measured.p_value, left.p_value),
        2 * (measured.cycles + 1),
    )


def _by_runs(concluded: Conclusion) -> DriveChange | None:
    """Trend of the compliances of the runs, in the structure that explains the recording best.

    Parameters
    ----------
    concluded : Conclusion
        With the structures that were visited.

    Returns
    -------
    DriveChange or None
        None where that structure has no compliance for each run, or they show no trend.
    """
    best = concluded.search.best()
    if best is None or BY_RUN not in best.names:
        return None
    runs = _run_compliances(best.fit, best.fit.names.index(BY_RUN))
    found = trend_of([runs], concluded.search.seed)
    if found is None or not found.is_change:
        return None
    return _change_by(found, concluded.accepted.fit.history.compliance_deg_per_nm)


def _run_compliances(fitted: FittedStructure, index: int) -> Floats:
    """Place, logarithm of the compliance and weight of every fitted run.

    Parameters
    ----------
    fitted : FittedStructure
        A structure with a compliance for each run.
    index : int
        Which of its terms that is.

    Returns
    -------
    ndarray, shape (3, runs)
    """
    history, use = fitted.history, fitted.problem.fitted
    own = fitted.beta[fitted.amplitude_places(index)] + history.compliance_deg_per_nm
    found = []
    for run, compliance in enumerate(own):
        rows = np.flatnonzero(use & (history.run == run))
        if len(rows) >= FEWEST_ROWS and compliance > 0:
            found.append((float(rows.mean()) / len(history), np.log(compliance), 1.0))
    return np.array(found).reshape(-1, 3).T


def _change_by(trend: Trend, compliance: float) -> DriveChange:
    """Change of the compliance along a trend, the calibrated one being that at its middle.

    Parameters
    ----------
    trend : Trend
    compliance : float
        Calibrated compliance [deg/(N m)].

    Returns
    -------
    DriveChange
    """
    return _drive_change(
        compliance,
        (trend.slope * (trend.first - trend.middle), trend.slope * (trend.last - trend.middle)),
        trend.std_error * (trend.last - trend.first),
        trend.p_value,
        trend.sweeps,
    )


def _drive_change(
    compliance: float,
    logarithms: tuple[float, float],
    std_error: float,
    p_value: float,
    sweeps: int,
) -> DriveChange:
    """Change of the compliance from the logarithms of what it was early and late.

    Parameters
    ----------
    compliance : float
        Calibrated compliance [deg/(N m)].
    logarithms : tuple of float
        Of the compliance early and late, over the calibrated one.
    std_error : float
        Standard error of their difference.
    p_value : float
        Probability of such a change on a steady drive.
    sweeps : int
        Number of compared sweeps.

    Returns
    -------
    DriveChange
    """
    early, late = logarithms
    half = NORMAL_95 * std_error
    return DriveChange(
        compliance_early_deg_per_nm=compliance * float(np.exp(early)),
        compliance_late_deg_per_nm=compliance * float(np.exp(late)),
        share=float(np.expm1(late - early)),
        ci95=(float(np.expm1(late - early - half)), float(np.expm1(late - early + half))),
        p_value=p_value,
        sweeps=sweeps,
    )


def trend(
    history: History, angle_deg: Floats, groups: list[list[Sweep]], seed: int
) -> Trend | None:
    """Trend of the slope of equal sweeps; None where too few can be compared.

    Parameters
    ----------
    history : History
        Load history of the prepared rows.
    angle_deg : ndarray, shape (n,)
        Twist of which the slope is taken [deg].
    groups : list of list of Sweep
        Equal sweeps.
    seed : int
        Seed of the random orders.

    Returns
    -------
    Trend or None
    """
    return trend_of([_slopes(history, angle_deg, group) for group in groups], seed)


def trend_of(parts: list[Floats], seed: int) -> Trend | None:
    """Trend of logarithms of compliances; None where too few can be compared.

    Parameters
    ----------
    parts : list of ndarray, shape (3, k)
        Place, logarithm and weight, a group of comparable ones each.
    seed : int
        Seed of the random orders.

    Returns
    -------
    Trend or None
    """
    parts = [part for part in parts if part.shape[1] > 1]
    count = sum(part.shape[1] for part in parts)
    if count - len(parts) < FEWEST_SWEEPS:
        return None
    centred = []
    for place, slope, weight in parts:
        place_left = place - np.average(place, weights=weight)
        centred.append((place_left, slope - np.average(slope, weights=weight), weight))
    lever = sum(float(weight @ place**2) for place, _, weight in centred)
    if lever <= 0:
        return None
    found = sum(float((weight * place) @ slope) for place, slope, weight in centred) / lever
    left = sum(float(weight @ (slope - found * place) ** 2) for place, slope, weight in centred)
    freedom = count - len(parts) - 1
    rng = np.random.default_rng(seed)
    drawn = np.zeros(DRAWS)
    for place, slope, weight in centred:
        order = rng.permuted(np.tile(np.arange(len(slope)), (DRAWS, 1)), axis=1)
        drawn += slope[order] @ (weight * place)
    as_large = int(np.count_nonzero(np.abs(drawn) >= abs(found) * lever * (1.0 - 1e-9)))
    place, weight = (np.concatenate([part[k] for part in parts]) for k in (0, 2))
    return Trend(
        slope=found,
        std_error=float(np.sqrt(left / freedom / lever)),
        p_value=(1 + as_large) / (1 + DRAWS),
        middle=float(np.average(place, weights=weight)),
        first=float(place.min()),
        last=float(place.max()),
        sweeps=count,
    )


def _slopes(history: History, angle_deg: Floats, group: list[Sweep]) -> Floats:
    """Place, logarithm of the slope and its weight for the sweeps of a group that have one.

    Parameters
    ----------
    history : History
        Load history of the prepared rows.
    angle_deg : ndarray, shape (n,)
        Twist of which the slope is taken [deg].
    group : list of Sweep
        Equal sweeps; the slope is taken over the range of torque that all of them pass.

    Returns
    -------
    ndarray, shape (3, sweeps)
    """
    side = group[0].state[0]
    load = side * history.applied_nm
    middle = _middles_of_runs(history)
    lower, upper = (share * min(sweep.limit_nm for sweep in group) for share in WINDOW)
    found = []
    for sweep in group:
        rows = sweep.rows[(load[sweep.rows] >= lower) & (load[sweep.rows] <= upper)]
        if len(rows) < FEWEST_ROWS:
            continue
        torque = history.applied_nm[rows] - history.applied_nm[rows].mean()
        lever = float(torque @ torque)
        slope = float(torque @ angle_deg[rows]) / lever if lever > 0 else 0.0
        if slope > 0:
            place = float(rows.mean()) if middle is None else middle[int(history.run[rows[0]])]
            found.append((place / len(history), np.log(slope), lever * slope**2))
    return np.array(found).reshape(-1, 3).T


def _middles_of_runs(history: History) -> dict[int, float] | None:
    """Row in the middle of each run, by its number; None of a single run.

    A drive that changes between runs is told by them: along the rows within them it would seem to
    have changed before the first and after the last sweep, too.

    Parameters
    ----------
    history : History

    Returns
    -------
    dict of int to float, or None
    """
    runs = np.unique(history.run)
    if len(runs) == 1:
        return None
    return {int(run): float(np.flatnonzero(history.run == run).mean()) for run in runs}
