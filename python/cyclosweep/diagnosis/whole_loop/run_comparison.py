"""Whether runs of one recording agree: residuals that repeat, and loops that drift."""

from dataclasses import dataclass, replace

import numpy as np

from cyclosweep.diagnosis.identify.fitting.fitted_structure import FittedStructure
from cyclosweep.diagnosis.identify.fitting.repetition import FEWEST_CELLS, LEAST_REPEAT, Repetition
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.whole_loop.forecast import Forecast, refit
from cyclosweep.diagnosis.whole_loop.step_order import step_order
from cyclosweep.simulation.effects.history import Flags, Floats, History
from cyclosweep.simulation.effects.mesh_range import mesh_positions, short_way_deg

DRIFT_RATIO = 1.8
"""Error on another run over that on its own beyond which the two are not the same drive."""
DRIFT_OF_SPAN = 0.05
"""The same as a share of the whole range of the angle."""
SAME_RANGE = 0.2
"""Share of the range of torque within which the ends of two replicates agree."""
SAME_PLACE = 2.0
"""Distance of two positions of the mesh that count as one [deg]."""
BANDS = 19.99
"""Bands of the load within which two runs are compared: twenty, of which the last one holds the
largest load as well."""
FEWEST_ROWS = 40
"""Least rows of a run that is compared with another."""
MOST_RUNS = 6
"""Runs that are fitted alone to see whether they differ."""


@dataclass(frozen=True)
class Steadiness:
    """Errors of a model of one run on that run, and on the replicate that it fits worst.

    Attributes
    ----------
    own_deg, other_deg : float
        Errors on the run it was fitted to, and on the other [deg].
    """

    own_deg: float
    other_deg: float

    def is_drift(self, span_deg: float) -> bool:
        """Whether the model fails on the other run by far more than on its own."""
        return (
            self.other_deg > DRIFT_RATIO * self.own_deg
            and self.other_deg > DRIFT_OF_SPAN * span_deg
        )


def steadiness(known: Forecast) -> list[Steadiness]:
    """Fit runs alone and see how far each model errs on itself and on the run's replicates.

    Runs over another range of torque are left out: a model of small loops does not hold for large
    ones, nor the reverse, on the steadiest drive. So are runs at other positions of the mesh: a
    run tells nothing of a position where it was not.
    """
    problem = known.problem
    parts = _by_run(problem, problem.whole_fitted)
    found = []
    for rows in parts[:MOST_RUNS]:
        replicates = [
            p for p in parts if p is not rows and are_replicates(problem.history, p, rows)
        ]
        if not replicates:
            continue
        alone = refit(known, rows=rows, most=4)
        own = problem.rms_error(alone.angle_deg, rows)
        found.append(
            Steadiness(own, max(problem.rms_error(alone.angle_deg, p) for p in replicates))
        )
    return found


def _by_run(problem: Problem, rows: Flags) -> list[Flags]:
    """Rows of each run that has enough of them to be compared.

    Parameters
    ----------
    problem : Problem
    rows : ndarray of bool, shape (n,)
        Rows that count.

    Returns
    -------
    list of ndarray of bool, shape (n,)
    """
    run = problem.history.run
    parts = [rows & (run == r) for r in np.unique(run[rows])]
    return [part for part in parts if np.count_nonzero(part) > FEWEST_ROWS]


def are_replicates(history: History, first: Flags, second: Flags) -> bool:
    """Whether two runs are of the same positions of the mesh, and of about the same torques.

    Parameters
    ----------
    history : History
    first, second : ndarray of bool, shape (n,)
        Rows of either run.

    Returns
    -------
    bool
    """
    one, two = history.applied_nm[first], history.applied_nm[second]
    room = SAME_RANGE * max(float(np.ptp(one)), float(np.ptp(two)))
    if max(abs(one.min() - two.min()), abs(one.max() - two.max())) > room:
        return False
    if history.crank_deg is None:
        return True
    places = [mesh_positions(history.crank_deg[rows]) for rows in (first, second)]
    away = np.abs(short_way_deg(np.subtract.outer(*map(np.unique, places))))
    return bool(np.all(away.min(axis=0) <= SAME_PLACE) and np.all(away.min(axis=1) <= SAME_PLACE))


def repetition(problem: Problem, fitted: FittedStructure) -> Repetition:
    """Compare the residuals of runs over the same torque, flank and direction.

    Parameters
    ----------
    problem : Problem
    fitted : FittedStructure
        The structure that leaves the residual.

    Returns
    -------
    Repetition
        The median over all pairs of runs.
    """
    history = fitted.history
    rows = problem.fitted | problem.held_out
    residual = problem.angle_deg - fitted.mean_deg
    band = np.floor(np.abs(history.applied_nm) / history.largest_torque_nm * BANDS)
    cell = band * 4 + (history.side > 0) * 2 + (history.sense > 0)
    runs = _by_run(problem, rows)
    best = Repetition(0.0, 0)
    found: list[Repetition] = []
    for i, first in enumerate(runs):
        for second in runs[i + 1 :]:
            a, b = _means(residual, cell, first, second)
            if len(a) >= FEWEST_CELLS and np.std(a) > 0 and np.std(b) > 0:
                found.append(Repetition(float(np.corrcoef(a, b)[0, 1]), len(a)))
    if found:
        middle = sorted(found, key=lambda r: r.correlation)
        best = middle[len(middle) // 2]
    if best.correlation > LEAST_REPEAT:
        order = step_order(history.applied_nm, problem.angle_deg, history.run)
        best = replace(best, order=order)
    return best


def _means(residual: Floats, cell: Floats, first: Flags, second: Flags) -> tuple[Floats, Floats]:
    """Mean residuals of two runs in every cell that both have visited.

    Parameters
    ----------
    residual : ndarray, shape (n,)
        Measured less modelled twist [deg].
    cell : ndarray, shape (n,)
        Number of the cell of each row.
    first : ndarray of bool, shape (n,)
        Rows of one run.
    second : ndarray of bool, shape (n,)
        Rows of the other.

    Returns
    -------
    ndarray, ndarray, shape (cells,)
        In deg.
    """
    a, b = [], []
    for value in np.unique(cell[first]):
        one, two = first & (cell == value), second & (cell == value)
        if np.any(one) and np.any(two):
            a.append(float(residual[one].mean()))
            b.append(float(residual[two].mean()))
    return np.array(a), np.array(b)
