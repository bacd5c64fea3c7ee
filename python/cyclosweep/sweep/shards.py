"""Running the parts of a study: on threads, processes or a cluster, resumable at any point."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import replace
from pathlib import Path
from typing import Literal

import polars as pl
from filelock import FileLock, Timeout

from cyclosweep.errors import InputError, SweepError
from cyclosweep.sweep.dataset import ROWS_PER_PART, Dataset, Part
from cyclosweep.sweep.progress import Progress
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Limits, Objective, Study
from cyclosweep.sweep.summary import Record, Summary, summarise

__all__ = ["Engine", "run_shards", "shard", "sink"]

Engine = Literal["threads", "processes", "dask"]
ENGINES: tuple[Engine, ...] = ("threads", "processes", "dask")
_ATTEMPTS = 3
_VARIANTS_PER_DASK_TASK = 2**20
# The study that tasks bring to this process over and over.
_STUDIES: dict[tuple[str, Objective | None], Study] = {}


def sink(
    space: Space | Study,
    folder: str | Path,
    *,
    resume: bool = True,
    fresh: bool = False,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    objective: Objective | None = None,
    rows_per_part: int = ROWS_PER_PART,
    engine: Engine = "threads",
    workers: int | None = None,
    scheduler: str | None = None,
    executor: Executor | None = None,
    progress: bool | None = None,
) -> Summary:
    """Sweep a space to a folder of Parquet parts; safe to kill and repeat.

    Parameters
    ----------
    space : Space or Study
        What varies.
    folder : str or Path
        Where the dataset goes.
    resume : bool
        Keep the whole parts of an earlier run of the same study.
    fresh : bool
        Delete what an earlier sweep left in the folder.
    loads_tn, limits : optional
        As for :func:`cyclosweep.sweep.scan`.
    objective : Objective, optional
        What the summary's ten best variants are best in.
    rows_per_part : int
        Variants a part.
    engine : {"threads", "processes", "dask"}
        Where parts are computed.
    workers : int, optional
        How many at a time; by default two threads, as many processes as there are cores.
    scheduler : str, optional
        Address of a running Dask scheduler; a local cluster is started without one.
    executor : concurrent.futures.Executor, optional
        Computes the parts instead of an engine of our own.
    progress : bool, optional
        Show a progress bar; by default when standard error is a terminal.

    Returns
    -------
    Summary
        Counts by status, ranges of the results, best variants.

    Raises
    ------
    InputError
        When the folder holds another study.
    SweepError
        When a part cannot be computed or written after three attempts, or another sweep of this
        folder is running. Whole parts stay, and the same call goes on from there.

    Examples
    --------
    >>> import tempfile, cyclosweep as cs
    >>> space = cs.Space.grid(cs.Drive.reference_87(), output_pin_count=[6, 8, 9])
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     cs.sink(space, folder).status
    {'ok': 3}
    """
    study = Study.of(space, loads_tn=loads_tn, limits=limits, objective=objective)
    if rows_per_part < 1:
        raise InputError(f"rows_per_part: found {rows_per_part}, expected at least 1")
    dataset = Dataset(study, Path(folder), rows_per_part)
    make = _engine(engine, workers, scheduler) if executor is None else _lend(executor)
    parts_per_task = 1
    if engine == "dask":
        # A worker elsewhere stands in another folder; its tasks cost a message each.
        dataset = replace(dataset, folder=dataset.folder.absolute())
        parts_per_task = max(
            1, min(_VARIANTS_PER_DASK_TASK // rows_per_part, dataset.part_count // 8)
        )
    with _exclusive(dataset, resume=resume, fresh=fresh):
        records = []
        missing = []
        for part in dataset.parts():
            record = dataset.record(part)
            if record is None:
                missing.append(part)
            else:
                records.append(record)
        done = sum(record.stop - record.start for record in records)
        with Progress("sweep", len(study), done=done, show=progress) as bar:

            def advance(record: Record) -> None:
                bar.advance(record.stop - record.start)

            try:
                records += run_shards(
                    dataset, missing, make, advance, parts_per_task=parts_per_task
                )
            except BaseException:
                with contextlib.suppress(OSError):
                    dataset.finish(dataset.records())
                raise
            _finish(dataset, records)
    return summarise(records, study)


def shard(
    space: Space | Study,
    folder: str | Path,
    *,
    index: int,
    of: int,
    rows_per_part: int = ROWS_PER_PART,
    progress: bool | None = None,
) -> Summary:
    """Compute every ``of``-th part of a study, beginning with part ``index``.

    One task of a batch array: any mix of tasks, in any order and at the same time, gives the
    same dataset, for a part's boundaries belong to the study.

    Parameters
    ----------
    space : Space or Study
        What varies.
    folder : str or Path
        Where the dataset goes, the same for every task.
    index, of : int
        Number of the task from 0, and how many there are.
    rows_per_part : int
        Variants a part, the same for every task.
    progress : bool, optional
        Show a progress bar; by default when standard error is a terminal.

    Returns
    -------
    Summary
        Of this task's parts.

    Raises
    ------
    InputError
        When the folder holds another study or the numbers make no sense.
    SweepError
        When a part cannot be written.
    """
    if of < 1 or not 0 <= index < of:
        raise InputError(f"shard {index} of {of}: expected 0 <= index < of")
    study = Study.of(space)
    dataset = Dataset(study, Path(folder), rows_per_part)
    dataset.prepare(resume=True, fresh=False)
    parts = [dataset.part(k) for k in range(index, dataset.part_count, of)]
    total = sum(part.stop - part.start for part in parts)
    with Progress(f"shard {index} of {of}", total, show=progress) as bar:

        def advance(record: Record) -> None:
            bar.advance(record.stop - record.start)

        records = run_shards(dataset, parts, _engine("threads", None, None), advance)
    # Whichever task ends last finds every part there.
    with FileLock(dataset.folder / ".manifest.lock"):
        dataset.write_manifest(dataset.records())
    (dataset.folder / ".manifest.lock").unlink(missing_ok=True)
    return summarise(records, study)


def _finish(dataset: Dataset, records: list[Record]) -> None:
    """Write the manifest; on a full disk the parts themselves still say what is there."""
    try:
        dataset.finish(records)
    except OSError as error:
        raise SweepError(f"{dataset.folder}: manifest: {error.strerror}") from None


def write_part(dataset: Dataset, part: Part) -> Record:
    """Write one part unless it is whole already; what a worker runs.

    A lock that dies with its process keeps two writers from the same part.
    """
    with dataset.lock(part.stem):
        return dataset.record(part) or dataset.write(part)


def write_parts(dataset: Dataset, parts: Sequence[Part]) -> list[Record | Exception]:
    """Write several parts, what a worker runs: a record or the reason for each.

    A study's tables are made once a process, however many tasks bring it along.
    """
    dataset = replace(dataset, study=_known_here(dataset.study))
    outcomes: list[Record | Exception] = []
    for part in parts:
        try:
            outcomes.append(write_part(dataset, part))
        except Exception as error:
            outcomes.append(error)
    return outcomes


def _known_here(study: Study) -> Study:
    key = (study.hash, study.objective)
    found = _STUDIES.get(key)
    if found is None:
        _STUDIES.clear()
        found = _STUDIES.setdefault(key, study)
    return found


def run_shards(
    dataset: Dataset,
    parts: Sequence[Part],
    make_executor: Callable[[], contextlib.AbstractContextManager[Executor]],
    on_done: Callable[[Record], None] = lambda record: None,
    *,
    parts_per_task: int = 1,
) -> list[Record]:
    """Write parts through any executor, each attempted up to three times.

    Parameters
    ----------
    dataset : Dataset
        Where they belong.
    parts : sequence of Part
        Which ones.
    make_executor : callable
        Gives a context manager of an executor; called again when a worker's death broke it.
    on_done : callable
        Called with each part's record.
    parts_per_task : int
        Parts that travel to a worker together.

    Returns
    -------
    list of Record

    Raises
    ------
    SweepError
        When parts failed for good, naming the first; the others are written before. When the
        scheduler of the executor is gone.
    """
    run = _Run(dataset, on_done)
    tasks = [
        list(parts[first : first + parts_per_task])
        for first in range(0, len(parts), parts_per_task)
    ]
    run.waiting.extend(tasks)
    while run.waiting or run.suspects:
        # What ran while a worker died goes on alone, so that only the culprit dies again.
        alone = not run.waiting
        if alone:
            run.waiting.append([run.suspects.popleft()])
        with make_executor() as executor:
            run.drain(executor, window=1 if alone else None)
    if run.failed:
        first = min(run.failed)
        raise SweepError(
            f"{dataset.folder}: part {first} failed: {_reason(run.failed[first])}; "
            f"{len(run.records)} of {len(parts)} parts written, "
            "the same command goes on from there"
        )
    return run.records


class _Run:
    """The state of one `run_shards`: what waits, what was tried how often, what came of it."""

    def __init__(self, dataset: Dataset, on_done: Callable[[Record], None]) -> None:
        self.dataset = dataset
        self.on_done = on_done
        self.waiting: deque[list[Part]] = deque()
        self.suspects: deque[Part] = deque()
        self.attempts: Counter[int] = Counter()
        self.failed: dict[int, BaseException] = {}
        self.records: list[Record] = []

    def drain(self, executor: Executor, window: int | None) -> None:
        """Run what waits until nothing does or the executor is broken."""
        if window is None:
            window = 2 * (getattr(executor, "_max_workers", None) or os.cpu_count() or 1)
        running: dict[Future[list[Record | Exception]], list[Part]] = {}
        broken = False
        try:
            while (self.waiting and not broken) or running:
                while self.waiting and not broken and len(running) < window:
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
                    broken = self.settle(task, future) or broken
        except BaseException:
            for future in running:
                future.cancel()
            raise

    def settle(self, task: list[Part], future: Future[list[Record | Exception]]) -> bool:
        """Take in what became of a task; true when the executor broke under it."""
        if future.cancelled():
            raise SweepError(
                f"{self.dataset.folder}: the scheduler is gone; {len(self.records)} parts "
                "written, the same command goes on from there"
            )
        error = future.exception()
        if error is not None:
            self.again(task, error, crashed=True)
            return isinstance(error, BrokenExecutor)
        for part, outcome in zip(task, future.result(), strict=True):
            if isinstance(outcome, Record):
                self.records.append(outcome)
                self.on_done(outcome)
            else:
                self.again([part], outcome, crashed=False)
        return False

    def again(self, task: list[Part], error: BaseException, *, crashed: bool) -> None:
        """Have parts tried once more, or give them up."""
        for part in task:
            if _is_hopeless(error):
                self.failed[part.index] = error
                self.waiting.clear()
                self.suspects.clear()
            elif self.attempts[part.index] >= _ATTEMPTS:
                self.failed[part.index] = error
            elif crashed:
                self.suspects.append(part)
            else:
                self.waiting.append([part])


def _is_hopeless(error: BaseException) -> bool:
    """A full or read-only disk fails every part alike."""
    if isinstance(error, OSError):
        return True
    return isinstance(error, pl.exceptions.PolarsError) and "os error" in str(error)


def _reason(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


@contextlib.contextmanager
def _exclusive(dataset: Dataset, *, resume: bool, fresh: bool) -> Iterator[None]:
    """Hold the folder against a second full sweep while this process lives."""
    folder = dataset.folder
    if folder.exists() and not folder.is_dir():
        raise InputError(f"{folder}: is a file, expected a folder")
    existed = folder.exists()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise SweepError(f"{folder}: {error.strerror}") from None
    lock = FileLock(folder / ".sweep.lock", timeout=0)
    try:
        lock.acquire()
    except Timeout:
        raise SweepError(f"{folder}: another sweep is writing there") from None
    except OSError as error:
        raise SweepError(f"{folder}: {error.strerror}") from None
    try:
        try:
            dataset.prepare(resume=resume, fresh=fresh)
        except OSError as error:
            raise SweepError(f"{folder}: {error.strerror}") from None
        yield
    finally:
        lock.release()
        (folder / ".sweep.lock").unlink(missing_ok=True)
        if not existed:
            with contextlib.suppress(OSError):
                folder.rmdir()


def _lend(executor: Executor) -> Callable[[], contextlib.AbstractContextManager[Executor]]:
    """The caller's executor, which stays open."""
    return lambda: contextlib.nullcontext(executor)


def _engine(
    engine: Engine, workers: int | None, scheduler: str | None
) -> Callable[[], contextlib.AbstractContextManager[Executor]]:
    if scheduler is not None and engine != "dask":
        raise InputError(f"scheduler: only for engine dask, found engine {engine}")
    if workers is not None and workers < 1:
        raise InputError(f"workers: found {workers}, expected at least 1")
    if engine == "threads":
        # The kernel and the encoder each use every core; two parts in flight overlap them.
        return lambda: ThreadPoolExecutor(workers or 2)
    if engine == "processes":
        count = workers or os.cpu_count() or 1
        return lambda: _process_pool(count)
    if engine == "dask":
        from cyclosweep.sweep.executors import dask_executor

        return lambda: dask_executor(workers, scheduler)
    raise InputError(f"engine: found {engine!r}, expected one of {', '.join(ENGINES)}")


@contextlib.contextmanager
def _process_pool(workers: int) -> Iterator[Executor]:
    """Spawned workers of one thread each: fork hangs with the threads of polars."""
    threads = {"RAYON_NUM_THREADS": "1", "POLARS_MAX_THREADS": "1"}
    before = {name: os.environ.get(name) for name in threads}
    os.environ.update(threads)
    try:
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(workers, mp_context=context) as pool:
            try:
                yield pool
            except BaseException:
                pool.shutdown(wait=False, cancel_futures=True)
                raise
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
