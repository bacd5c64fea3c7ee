"""The table of what the laws of a repaired model miss at the same state of load, and its worth."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from cyclosweep.diagnosis.decide import Conclusion
from cyclosweep.diagnosis.identify.repetition import FEWEST_CELLS, LEAST_REPEAT
from cyclosweep.diagnosis.identify.verdict import Decision
from cyclosweep.diagnosis.prepare.problem import Problem
from cyclosweep.diagnosis.repair import RepairedModel
from cyclosweep.diagnosis.verification import Verification
from cyclosweep.diagnosis.whole_loop.forecast import predicted_path
from cyclosweep.result import LearnedError
from cyclosweep.result.part import finite
from cyclosweep.simulation.effects.history import Floats, History, Ints
from cyclosweep.simulation.model_error import (
    DIRECTIONS,
    SAME_START,
    ErrorBranch,
    LoadPath,
    ModelError,
)

CELL = 0.02
"""Width of a cell of torque over the largest torque."""
ABOVE_NOISE = 2.0
"""Size of what is learned from a single pass over the noise, from which it is model error: noise
that drifts along a pass looks the same as an error of the laws."""
ROUNDS = 12
"""Most rounds in which the simulation settles, as in a forecast."""
WITH_EFFECTS = ("IDENTIFIED", "MOSTLY_EXPLAINED", "AMBIGUOUS", "UNKNOWN_PHYSICS")
"""Verdicts that say that something is missing."""


@dataclass(frozen=True, eq=False, slots=True)
class _Pass:
    """Mean error in each cell of torque along one branch.

    Attributes
    ----------
    from_nm : float
        Torque at which the branch began [N m].
    cell : ndarray of int, shape (k,)
        Numbers of the cells, rising.
    torque_nm, error_deg, weight : ndarray, shape (k,)
        Mean torque [N m], mean error [deg] and readings of each.
    """

    from_nm: float
    cell: Ints
    torque_nm: Floats
    error_deg: Floats
    weight: Floats


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
    path = predicted_path(problem, repaired.model, ROUNDS)
    error = problem.angle_deg - path.angle_deg
    passes = _passes(problem, path, error)
    repeats, single = _repeatability(passes)
    if repeats is None or repeats < LEAST_REPEAT:
        return repaired
    table = ModelError(tuple(_branches(passes, repeats)))
    missed = table.twist(path)
    size, held = (
        problem.rms_error(problem.angle_deg - missed, problem.fitted),
        problem.whole_held_out,
    )
    if single and not noise.structured and size < ABOVE_NOISE * noise.spread_deg:
        return repaired
    learned = LearnedError(
        rms_deg=size,
        repeats=repeats,
        passes=max(map(len, passes.values())),
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
    alike = f"(correlation {learned.repeats:.2f})"
    among = (
        f"in {learned.passes} passes of the same loads {alike}"
        if learned.passes > 1
        else f"at neighbouring loads {alike}; whether it repeats, one pass of them cannot show"
    )
    gain = ""
    if learned.holdout_rmse_deg is not None and learned.holdout_without_deg is not None:
        gain = (
            f" Runs that were held out are forecast within {learned.holdout_rmse_deg:.3g} deg with "
            f"it and {learned.holdout_without_deg:.3g} deg without."
        )
    return (
        f"The named effects miss {learned.rms_deg:.3g} deg rms at the same torque and direction, "
        f"alike {among}. model.json holds it as a table beside the effects: it has no name, and it "
        f"fades on loops that turn elsewhere.{gain}"
    )


def _limited_by_laws(concluded: Conclusion, decision: Decision) -> bool:
    """Whether something is missing, and more than noise is left beside what was accepted."""
    if decision.verdict not in WITH_EFFECTS:
        return False
    counted = concluded.accepted.fit.noise.model_error_factor > 1.0
    return counted or concluded.search.noise.structured or decision.unexplained


def _passes(problem: Problem, path: History, error: Floats) -> dict[tuple[bool, int], list[_Pass]]:
    """Errors of all branches by direction and the place at which the branch began.

    Readings count that are fitted, in contact, and for which the simulation finds the same flank:
    elsewhere the difference is a play, not an error of the laws.

    Parameters
    ----------
    problem : Problem
    path : History
        Simulated path along all rows.
    error : ndarray, shape (n,)
        Measured less simulated twist [deg].

    Returns
    -------
    dict
        From whether the torque rises and a number of the start to the passes.
    """
    load = LoadPath.of(path)
    top = path.largest_torque_nm
    rows = problem.fitted & (path.side == problem.history.side)
    cell: Ints = np.floor(path.applied_nm / (CELL * top)).astype(np.int64)
    found: dict[tuple[bool, int], list[_Pass]] = {}
    starts = _numbered(load.from_nm, SAME_START * top)
    for branch in np.unique(load.branch[rows]):
        here = np.flatnonzero(rows & (load.branch == branch))
        cells, which = np.unique(cell[here], return_inverse=True)
        weight = np.asarray(np.bincount(which, problem.weight[here]), dtype=np.float64)
        torque, missed = (
            np.bincount(which, problem.weight[here] * values[here]) / weight
            for values in (path.applied_nm, error)
        )
        first = here[0]
        key = bool(load.rising[first]), int(starts[first])
        one = _Pass(float(load.from_nm[first]), cells, torque, missed, weight)
        found.setdefault(key, []).append(one)
    return found


def _numbered(values: Floats, near: float) -> Ints:
    """Number of the group of each value; groups are farther apart than ``near``."""
    order = np.sort(np.unique(values))
    edges = order[1:][np.diff(order) > near]
    return np.asarray(np.searchsorted(edges, values, side="right"), dtype=np.int64)


def _repeatability(
    passes: dict[tuple[bool, int], list[_Pass]],
) -> tuple[float | None, bool]:
    """Share of the variance of the error that is the same at the same state of load.

    Between passes of the same state where there are enough; else between neighbouring cells of a
    pass, by which an error of the laws is told from white noise.

    Parameters
    ----------
    passes : dict
        See `_passes`.

    Returns
    -------
    share : float or None
        None with too few cells to say.
    single : bool
        Whether it is that of neighbouring cells.
    """
    alike = [
        pair for group in passes.values() for one, other in combinations(group, 2)
        for pair in _common(one, other)
    ]  # fmt: skip
    single = len(alike) < FEWEST_CELLS
    if single:
        alike = [
            (float(a), float(b))
            for group in passes.values()
            for each in group
            for a, b in zip(each.error_deg[:-1], each.error_deg[1:], strict=True)
        ]
    if len(alike) < FEWEST_CELLS:
        return None, single
    first, second = np.array(alike).T
    size = 0.5 * float(np.mean(first**2 + second**2))
    return (float(np.mean(first * second)) / size if size > 0.0 else 0.0), single


def _common(one: _Pass, other: _Pass) -> Iterator[tuple[float, float]]:
    """Errors of two passes in the cells of both."""
    _, here, there = np.intersect1d(one.cell, other.cell, return_indices=True)
    yield from zip(one.error_deg[here].tolist(), other.error_deg[there].tolist(), strict=True)


def _branches(passes: dict[tuple[bool, int], list[_Pass]], repeats: float) -> Iterator[ErrorBranch]:
    """Expected error along each kind of branch.

    Parameters
    ----------
    passes : dict
        See `_passes`.
    repeats : float
        Share of the variance of a pass that is the same in another.

    Yields
    ------
    ErrorBranch
        The mean over the passes, smaller by as much as they do not repeat: of a mean of n passes
        the share n r / (1 + (n - 1) r) is expected again (Spearman and Brown).
    """
    for (rising, _), group in sorted(passes.items()):
        which = np.unique(_joined(group, "cell"), return_inverse=True)[1]
        count = np.asarray(np.bincount(which), dtype=np.float64)
        weight = _joined(group, "weight")
        moment = np.bincount(which, weight * _joined(group, "torque_nm"))
        torque = np.asarray(moment / np.bincount(which, weight))
        share = count * repeats / (1.0 + (count - 1) * repeats)
        mean = np.asarray(np.bincount(which, _joined(group, "error_deg"))) / count
        start = float(np.mean([each.from_nm for each in group]))
        yield ErrorBranch(
            DIRECTIONS[0] if rising else DIRECTIONS[1],
            start,
            tuple(float(f"{value:.6g}") for value in torque),
            tuple(float(f"{value:.6g}") for value in share * mean),
        )


def _joined(group: Sequence[_Pass], name: str) -> Floats:
    """One column of all passes of a group."""
    return np.concatenate([getattr(each, name) for each in group])
