"""Parts of a study computed through an executor, each attempted up to three times."""

from __future__ import annotations

import logging
import os
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Sequence, Sized
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from contextlib import AbstractContextManager
from dataclasses import replace
from itertools import islice

import polars as pl

from cyclosweep.errors import SweepError
from cyclosweep.sweep.dataset import Dataset, Part
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.study import Study
from cyclosweep.sweep.summary import PartSummary

__all__ = ["run_shards", "write_parts"]

_LOG = logging.getLogger(__name__)

_ATTEMPTS = 3
# The study of the latest task in this process, which most often is that of the next one.
_STUDIES: dict[tuple[str, tuple[Objective, ...]], Study] = {}


def write_part(dataset: Dataset, part: Part) -> PartSummary:
    """Write one part on a worker, unless it is whole already.

    A lock, which ends with its process, keeps two workers from the same part.

    Parameters
    ----------
    dataset : Dataset
        Where it belongs.
    part : Part
        Which one.

    Returns
    -------
    PartSummary
    """
    with dataset.lock(part.stem):
        return dataset.summary(part) or dataset.write(part)


def write_parts(dataset: Dataset, parts: Sequence[Part]) -> list[PartSummary | Exception]:
    """Write several parts on a worker.

    The tables of a study are made once in a process, however many tasks carry it.

    Parameters
    ----------
    dataset : Dataset
        Where they belong.
    parts : sequence of Part
        Which ones.

    Returns
    -------
    list of PartSummary or Exception
        For each part its summary, or why it could not be written.
    """
    dataset = replace(dataset, study=_study_of_this_process(dataset.study))
    outcomes: list[PartSummary | Exception] = []
    for part in parts:
        try:
            outcomes.append(write_part(dataset, part))
        except Exception as error:
            outcomes.append(error)
    return outcomes


def _study_of_this_process(study: Study) -> Study:
    key = (study.hash, study.objectives)
    found = _STUDIES.get(key)
    if found is None:
        _STUDIES.clear()
        found = _STUDIES.setdefault(key, study)
    return found


def run_shards(
    dataset: Dataset,
    parts: Iterable[Part],
    make_executor: Callable[[], AbstractContextManager[Executor]],
    on_done: Callable[[PartSummary], None] = lambda summary: None,
    *,
    parts_per_task: int = 1,
    count: int | None = None,
) -> list[PartSummary]:
    """Write parts through any executor, each attempted up to three times.

    Parameters
    ----------
    dataset : Dataset
        Where they belong.
    parts : iterable of Part
        Which ones; taken one by one as there is room for them.
    make_executor : callable
        Gives a context manager of an executor; called again when a worker's death broke it.
    on_done : callable
        Called with each part's summary.
    parts_per_task : int
        Parts that travel to a worker together.
    count : int, optional
        How many parts there are, for messages; needed where `parts` does not know.

    Returns
    -------
    list of PartSummary

    Raises
    ------
    SweepError
        When parts failed for good, naming the first; the others are written before. When the
        scheduler of the executor is gone.
    """
    run = _Run(dataset, on_done, iter(parts), parts_per_task)
    while run.has_waiting() or run.suspects:
        # Parts that ran while a worker died are tried one at a time, to find the one at fault.
        alone = not run.waiting
        if alone:
            run.waiting.append([run.suspects.popleft()])
        with make_executor() as executor:
            run.drain(executor, window=1 if alone else None)
    if run.failed:
        first = min(run.failed)
        total = len(parts) if isinstance(parts, Sized) else count or run.begun
        raise SweepError(
            f"{dataset.folder}: part {first} failed: {_reason(run.failed[first])}; "
            f"{len(run.summaries)} of {total} parts written, the same command goes on from there"
        )
    return run.summaries


class _Run:
    """The state of one `run_shards`: tasks that wait, attempts, failures and summaries."""

    def __init__(
        self,
        dataset: Dataset,
        on_done: Callable[[PartSummary], None],
        parts: Iterator[Part],
        parts_per_task: int,
    ) -> None:
        self.dataset = dataset
        self.on_done = on_done
        self.parts = parts
        self.parts_per_task = parts_per_task
        self.begun = 0
        self.waiting: deque[list[Part]] = deque()
        self.suspects: deque[Part] = deque()
        self.attempts: Counter[int] = Counter()
        self.failed: dict[int, BaseException] = {}
        self.summaries: list[PartSummary] = []

    def has_waiting(self) -> bool:
        """Whether a task waits; takes the next parts of the study where none does."""
        if not self.waiting and (task := list(islice(self.parts, self.parts_per_task))):
            self.begun += len(task)
            self.waiting.append(task)
        return bool(self.waiting)

    def drain(self, executor: Executor, window: int | None) -> None:
        """Run what waits, at most ``window`` tasks at a time, until the executor breaks."""
        if window is None:
            window = 2 * (getattr(executor, "_max_workers", None) or os.cpu_count() or 1)
        running: dict[Future[list[PartSummary | Exception]], list[Part]] = {}
        broken = False
        try:
            while running or (not broken and self.has_waiting()):
                while not broken and len(running) < window and self.has_waiting():
                    task = self.waiting.popleft()
                    self.attempts.update(part.index for part in task)
                    try:
                        running[executor.submit(write_parts, self.dataset, task)] = task
                    except BrokenExecutor as gone:
                        broken = True
                        self.again(task, gone, crashed=True)
                done, _ = wait(running, return_when=FIRST_COMPLETED)
                for future in done:
                    task = running.pop(future)
                    broken = self.take_outcome(task, future) or broken
        except BaseException:
            for future in running:
                future.cancel()
            raise

    def take_outcome(self, task: list[Part], future: Future[list[PartSummary | Exception]]) -> bool:
        """Keep the results of a task that ended; true when its end broke the executor."""
        if future.cancelled():
            raise SweepError(
                f"{self.dataset.folder}: the scheduler is gone; {len(self.summaries)} parts "
                "written, the same command goes on from there"
            )
        error = future.exception()
        if error is not None:
            self.again(task, error, crashed=True)
            return isinstance(error, BrokenExecutor)
        for part, outcome in zip(task, future.result(), strict=True):
            if isinstance(outcome, PartSummary):
                self.summaries.append(outcome)
                self.on_done(outcome)
            else:
                self.again([part], outcome, crashed=False)
        return False

    def again(self, task: list[Part], error: BaseException, *, crashed: bool) -> None:
        """Put parts in line for another attempt, or give them up."""
        for part in task:
            _LOG.warning(
                "part %d: attempt %d of %d failed: %s",
                part.index, self.attempts[part.index], _ATTEMPTS, _reason(error),
            )  # fmt: skip
            if _is_hopeless(error):
                self.failed[part.index] = error
                self.waiting.clear()
                self.suspects.clear()
                self.parts = iter(())
            elif self.attempts[part.index] >= _ATTEMPTS:
                self.failed[part.index] = error
            elif crashed:
                self.suspects.append(part)
            else:
                self.waiting.append([part])


def _is_hopeless(error: BaseException) -> bool:
    """Whether every other part would fail as well, as on a full or read-only disk."""
    if isinstance(error, OSError):
        return True
    return isinstance(error, pl.exceptions.PolarsError) and "os error" in str(error)


def _reason(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__
