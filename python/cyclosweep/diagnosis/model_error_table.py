"""The table of what the laws of a repaired model miss at the same state of load, and its worth."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Self

import numpy as np

from cyclosweep.diagnosis.conclude import NAMING, Conclusion
from cyclosweep.diagnosis.identify.fitting.repetition import FEWEST_CELLS, LEAST_REPEAT
from cyclosweep.diagnosis.identify.structures.verdict import Decision
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.repair import RepairedModel
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.diagnosis.whole_loop.forecast import predicted_path
from cyclosweep.result import Between, LearnedError
from cyclosweep.result.part import finite
from cyclosweep.simulation.effects.history import Floats, History, Ints
from cyclosweep.simulation.effects.mesh_range import short_way_deg
from cyclosweep.simulation.model_error import (
    SAME_POSITION_DEG,
    SAME_START,
    ErrorBranch,
    LoadBranch,
    ModelError,
    load_branches,
)
from cyclosweep.simulation.simulate import SIMULATED_ROUNDS

CELLS = 50
"""Cells of torque from zero to the largest."""
BY_CHANCE = 1.6
"""Standard errors of the correlation of errors that have nothing in common, from which they are
taken to have: nineteen of twenty stay below."""
ABOVE_NOISE = 2.0
"""Size of what is learned from a single pass over the noise, from which it is model error: noise
that drifts along a pass looks the same as an error of the laws."""
SOMETHING_MISSING = (*NAMING, "UNKNOWN_PHYSICS")
"""Verdicts that say that something is missing."""
BETWEEN: dict[Between, str] = {
    "runs": "between {count} runs",
    "passes": "between {count} passes of the same loads in one run",
    "loads": "between neighbouring loads; whether it repeats, one pass cannot show",
}
"""Between what an error repeats, in words."""


@dataclass(frozen=True, eq=False, slots=True)
class _Pass:
    """Error along one branch, at multiples of a cell of torque.

    Attributes
    ----------
    branch : LoadBranch
    run : int
        Its run.
    error_deg : ndarray, shape (2 CELLS + 1,)
        Measured less simulated twist [deg]; NaN farther than a cell from a reading.
    """

    branch: LoadBranch
    run: int
    error_deg: Floats

    def is_like(self, other: LoadBranch, near_nm: float) -> bool:
        """Whether another branch goes the same way and begins within a range above this one.

        Parameters
        ----------
        other : LoadBranch
        near_nm : float
            The range [N m].

        Returns
        -------
        bool
        """
        mine = self.branch
        alike = (mine.direction, mine.fresh) == (other.direction, other.fresh)
        return alike and other.from_nm <= mine.from_nm + near_nm


@dataclass(frozen=True, eq=False, slots=True)
class _Group:
    """Passes of one direction that begin at about the same torque.

    Attributes
    ----------
    branch : LoadBranch
        One of them.
    from_nm : float
        Their mean start [N m].
    passes, runs : ndarray, shape (k, 2 CELLS + 1)
        Error of every pass, and the mean of each run [deg].
    """

    branch: LoadBranch
    from_nm: float
    passes: Floats
    runs: Floats

    @classmethod
    def of(cls, passes: Sequence[_Pass]) -> Self:
        """Group of some passes, at least one."""
        errors = np.array([one.error_deg for one in passes])
        run = np.array([one.run for one in passes])
        means = [_mean(errors[run == number]) for number in np.unique(run)]
        start = float(np.mean([one.branch.from_nm for one in passes]))
        return cls(passes[0].branch, start, errors, np.array(means))


def with_error_table(
    concluded: Conclusion, repaired: RepairedModel, verified: Verification
) -> RepairedModel:
    """Add to a repaired model what it misses, where that is error of its laws and repeats.

    Parameters
    ----------
    concluded : Conclusion
        Verdict and accepted structure.
    repaired : RepairedModel
        The model before and after the repair.
    verified : Verification
        Whether the drive changed between the runs.

    Returns
    -------
    RepairedModel
        The same where the recording is limited by noise, where the drive changed, and where what
        the model misses does not repeat.
    """
    changed = verified.drift is not None or verified.change is not None
    if changed or not _limited_by_laws(concluded, verified.decision):
        return repaired
    problem, noise = concluded.search.problem, concluded.search.noise
    # From the torques of the history its zero is taken off already.
    zero_nm = repaired.model.torque_zero_nm - problem.zero_nm
    simulated = replace(repaired.model, torque_zero_nm=zero_nm)
    path = predicted_path(problem, simulated, SIMULATED_ROUNDS)
    used = np.isin(problem.history.run, problem.history.run[problem.fitted])
    largest = float(np.abs(path.applied_nm[used]).max())
    groups = _groups(_passes(problem, path, largest), SAME_START * largest)
    repeats, between = _repeats(groups)
    if repeats < LEAST_REPEAT:
        return repaired
    branches = tuple(_branches(groups, repeats, between, largest))
    table = ModelError(branches, largest, _only_position(problem))
    missed = table.twist(path)
    held = problem.whole_held_out
    size = problem.rms_error(problem.angle_deg - missed, problem.fitted)
    if between == "loads" and not noise.structured and size < ABOVE_NOISE * noise.spread_deg:
        return repaired
    learned = LearnedError(
        rms_deg=size,
        repeats=repeats,
        between=between,
        compared=max(len(group.passes if between == "passes" else group.runs) for group in groups),
        holdout_rmse_deg=finite(problem.rms_error(path.angle_deg + missed, held)),
        holdout_without_deg=finite(problem.rms_error(path.angle_deg, held)),
    )
    return replace(repaired, model=replace(repaired.model, model_error=table), learned=learned)


def learned_in_words(learned: LearnedError) -> str:
    """Say how large the table is, how well it repeats, and what a forecast gains.

    Parameters
    ----------
    learned : LearnedError

    Returns
    -------
    str
    """
    among = BETWEEN[learned.between].format(count=learned.compared)
    gain = ""
    if learned.holdout_rmse_deg is not None and learned.holdout_without_deg is not None:
        gain = (
            f" Runs that were held out are forecast within {learned.holdout_rmse_deg:.3g} deg with "
            f"it and {learned.holdout_without_deg:.3g} deg without."
        )
    return (
        f"What the effects miss at the same torque and direction is {learned.rms_deg:.3g} deg rms, "
        f"as far as it repeats (correlation {learned.repeats:.2f} {among}). It has no name; "
        f"model.json holds it as a table, which fades on loops that turn elsewhere.{gain}"
    )


def _limited_by_laws(concluded: Conclusion, decision: Decision) -> bool:
    """Whether something is missing, and more than noise is left beside what was accepted."""
    if decision.verdict not in SOMETHING_MISSING:
        return False
    counted = concluded.accepted.fit.noise.model_error_factor > 1.0
    return counted or concluded.search.noise.structured or decision.unexplained


def _only_position(problem: Problem) -> float | None:
    """Position of the mesh where all fitted rows have the same one; else None [deg]."""
    crank = problem.history.crank_deg
    if crank is None:
        return None
    turns = np.exp(1j * np.radians(crank[problem.fitted]))
    middle = float(np.degrees(np.angle(turns.mean())))
    away = short_way_deg(crank[problem.fitted] - middle)
    return middle if np.all(np.abs(away) <= SAME_POSITION_DEG) else None


def _passes(problem: Problem, path: History, largest_nm: float) -> Iterator[_Pass]:
    """Errors along every branch.

    Readings count that are fitted, in contact, and for which the simulation finds the same flank:
    elsewhere the difference is a play, not an error of the laws. The median over a cell does not
    follow single readings that are far off.

    Parameters
    ----------
    problem : Problem
    path : History
        Simulated path along all rows.
    largest_nm : float
        Largest torque of the fitted runs [N m].

    Yields
    ------
    _Pass
    """
    rows = problem.fitted & (path.side == problem.history.side)
    error = problem.angle_deg - path.angle_deg
    place = path.applied_nm / largest_nm * CELLS
    grid = np.arange(-CELLS, CELLS + 1)
    for branch in load_branches(path, largest_nm):
        here = branch.samples.start + np.flatnonzero(rows[branch.samples])
        if not len(here):
            continue
        parts = _by_cell(here, place)
        at = np.array([place[part].mean() for part in parts])
        missed = np.array([np.median(error[part]) for part in parts])
        near = np.min(np.abs(grid[:, None] - at), axis=1) <= 1.0
        along = np.where(near, np.interp(grid, at, missed), np.nan)
        yield _Pass(branch, int(path.run[here[0]]), along)


def _by_cell(rows: Ints, place: Floats) -> list[Ints]:
    """Rows in the order of their torque, split by cells."""
    ordered = rows[np.argsort(place[rows], kind="stable")]
    edges = np.flatnonzero(np.diff(np.round(place[ordered])) > 0) + 1
    return np.split(ordered, edges)


def _groups(passes: Iterable[_Pass], near_nm: float) -> list[_Group]:
    """Passes by direction and the torque at which they begin.

    Parameters
    ----------
    passes : iterable of _Pass
    near_nm : float
        Range of the starts of one group [N m].

    Returns
    -------
    list of _Group
    """
    found: list[list[_Pass]] = []
    key = attrgetter("branch.direction", "branch.fresh", "branch.from_nm")
    for each in sorted(passes, key=key):
        if found and found[-1][0].is_like(each.branch, near_nm):
            found[-1].append(each)
        else:
            found.append([each])
    return [_Group.of(group) for group in found]


def _mean(errors: Floats) -> Floats:
    """Mean of rows over those that have a number there; NaN where none has."""
    count = np.sum(np.isfinite(errors), axis=0)
    return np.asarray(np.where(count > 0, np.nansum(errors, axis=0) / np.maximum(count, 1), np.nan))


def _repeats(groups: list[_Group]) -> tuple[float, Between]:
    """Share of the variance that repeats, between runs if they can be compared.

    What passes of one run have in common need not be there in the next, and what neighbouring loads
    have in common need not be there in the next pass.
    """
    of_runs = repeatability([group.runs for group in groups])
    if of_runs is not None:
        return of_runs, "runs"
    passes = [group.passes for group in groups]
    of_passes = repeatability(passes)
    if of_passes is not None:
        return of_passes, "passes"
    return _of_neighbours(passes), "loads"


def repeatability(groups: Iterable[Floats]) -> float | None:
    """Share of the variance of curves that they have in common (intraclass correlation).

    Parameters
    ----------
    groups : iterable of ndarray, shape (k, m)
        Curves that should be alike; NaN where one has no value.

    Returns
    -------
    float or None
        None with too few places at which curves can be compared. Zero where curves that have
        nothing in common could be as alike.
    """
    common, size, places, more = 0.0, 0.0, 0, 0
    alike = np.zeros(CELLS)
    for curves in groups:
        known = np.isfinite(curves)
        count = known.sum(axis=0)
        at = count >= 2
        value = np.where(known & at, curves, 0.0)
        count = np.maximum(count, 2)
        square = np.sum(value**2, axis=0)
        common += float(np.sum((value.sum(axis=0) ** 2 - square) / (count * (count - 1))))
        size += float(np.sum(square / count))
        for lag in range(1, CELLS):
            alike[lag] += float(np.sum(value[:, lag:] * value[:, :-lag] / count[lag:]))
        places += int(at.sum())
        more += int(np.sum(count[at] - 1))
    if places < FEWEST_CELLS or size <= 0.0:
        return None
    share = common / size
    # Places along a curve are alike, so that they tell less than as many that are not (Bartlett's
    # formula for the correlation of two series).
    repeated = 1.0 + 2.0 * float(np.sum((alike / size) ** 2))
    return share if share > BY_CHANCE * np.sqrt(repeated / more) else 0.0


def _of_neighbours(groups: Iterable[Floats]) -> float:
    """Correlation of neighbouring places of the same curve, by which it is told from white noise.

    Parameters
    ----------
    groups : iterable of ndarray, shape (k, m)
        Curves; NaN where one has no value.

    Returns
    -------
    float
        Zero with too few places.
    """
    pairs = [np.stack([curves[:, 1:].ravel(), curves[:, :-1].ravel()]) for curves in groups]
    if not pairs:
        return 0.0
    first, second = np.concatenate(pairs, axis=1)
    both = np.isfinite(first * second)
    if np.count_nonzero(both) < FEWEST_CELLS:
        return 0.0
    size = 0.5 * float(np.mean(first[both] ** 2 + second[both] ** 2))
    return float(np.mean(first[both] * second[both])) / size if size > 0.0 else 0.0


def _branches(
    groups: Iterable[_Group], repeats: float, between: Between, largest_nm: float
) -> Iterator[ErrorBranch]:
    """Expected error along each kind of branch.

    Parameters
    ----------
    groups : iterable of _Group
    repeats : float
        Share of the variance that is the same in another run, pass or load.
    between : {"runs", "passes", "loads"}
        Between what it was found.
    largest_nm : float
        Largest torque of the fitted runs [N m].

    Yields
    ------
    ErrorBranch
        The mean, smaller by as much as it does not repeat: of a mean of n the share
        n r / (1 + (n - 1) r) is expected again (Spearman and Brown).
    """
    torque = np.arange(-CELLS, CELLS + 1) * (largest_nm / CELLS)
    for group in groups:
        curves = group.passes if between == "passes" else group.runs
        known = np.isfinite(curves).any(axis=0)
        count = np.isfinite(curves[:, known]).sum(axis=0)
        share = count * repeats / (1.0 + (count - 1) * repeats)
        error = share * _mean(curves)[known]
        yield ErrorBranch(
            group.branch.direction,
            group.from_nm,
            tuple(float(f"{value:.9g}") for value in torque[known]),
            tuple(float(f"{value:.6g}") for value in error),
            group.branch.fresh,
        )
