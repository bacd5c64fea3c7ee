"""Parts of a recording to fit and parts to predict, always in whole runs or stretches."""

from dataclasses import replace

import numpy as np

from cyclosweep.diagnosis.prepare.noise import Noise
from cyclosweep.diagnosis.prepare.problem import Problem, gaps
from cyclosweep.simulation.effects.history import Flags

FOLDS = 4
"""Blocks that are left out in turn."""
STRETCHES, STRETCHES_OF_LOOPS = 2, 4
"""Stretches of a block: of the flank in contact, and of whole loops, crossings of the dead zone
included."""
KEPT_RUNS = "the runs kept for it"
"""Label of runs that were never fitted, because they are kept for the verdict."""


def restrict(problem: Problem, noise: Noise, rows: Flags) -> tuple[Problem, Noise]:
    """Leave rows of a problem out of the fit.

    Parameters
    ----------
    problem : Problem
    noise : Noise
        Noise of its fitted rows.
    rows : ndarray of bool, shape (n,)
        Rows that may still be fitted; all other fitted rows are held out.

    Returns
    -------
    Problem, Noise
    """
    kept = problem.fitted & rows
    gap = gaps(kept, problem.history.run, None if noise.by_rows else problem.history.time_s)
    part = replace(problem, fitted=kept, held_out=problem.fitted & ~rows, gap=gap)
    return part, replace(noise, gap=gap[kept])


def folds(problem: Problem) -> list[tuple[str, Flags]]:
    """Blocks to leave out in turn: whole runs, dealt so that each block has large and small ones.

    With fewer than four runs: consecutive stretches of the recording.
    """
    history = problem.history
    use = problem.fitted
    runs = np.unique(history.run[use])
    if len(runs) >= FOLDS:
        largest = [float(np.abs(history.applied_nm[use & (history.run == r)]).max()) for r in runs]
        order = runs[np.argsort(largest, kind="stable")]
        labels = recorded_runs(problem)
        out = []
        for k in range(FOLDS):
            chosen = np.sort(order[k::FOLDS])
            names = ", ".join(str(labels[r]) for r in chosen)
            out.append((f"runs {names}", np.isin(history.run, chosen)))
        return out
    return stretches(use, STRETCHES)


def stretches(rows: Flags, each: int) -> list[tuple[str, Flags]]:
    """Blocks to leave out in turn, each of some stretches of the rows.

    Parameters
    ----------
    rows : ndarray of bool, shape (n,)
        Rows that are shared out.
    each : int
        Stretches in a block.

    Returns
    -------
    list of (str, ndarray of bool)
        Label and rows of each block; none without rows.
    """
    index = np.flatnonzero(rows)
    count = each * FOLDS
    block = np.full(len(rows), -1)
    block[index] = np.arange(len(index)) * count // max(len(index), 1)
    blocks = [(block >= 0) & (block % FOLDS == k) for k in range(FOLDS)]
    return [
        (f"every {FOLDS}th of {count} stretches from number {k + 1}", block)
        for k, block in enumerate(blocks)
        if block.any()
    ]


def recorded_runs(problem: Problem) -> list[int]:
    """Numbers of the runs as recorded, by their index."""
    run = problem.recording.run
    return [int(v) for v in run[np.r_[True, np.diff(run) != 0]]]
