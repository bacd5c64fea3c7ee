"""A study as a folder of parts: the whole of it at once, or one task of a batch array."""

from __future__ import annotations

import contextlib
import logging
import time
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path

from filelock import FileLock, Timeout

from cyclosweep.design.numbers import whole_number
from cyclosweep.design.parts import Engine as Solver
from cyclosweep.errors import SweepError, instance_of
from cyclosweep.sweep.attempts import run_shards
from cyclosweep.sweep.dataset import Dataset, dataset_of
from cyclosweep.sweep.executors import Engine, executor_of, lend
from cyclosweep.sweep.objective import Objective
from cyclosweep.sweep.own_columns import Own
from cyclosweep.sweep.progress import Progress, ShowProgress
from cyclosweep.sweep.space import Space
from cyclosweep.sweep.study import Limits, Study, StudyModel
from cyclosweep.sweep.summary import PartSummary, Summary, summarise

__all__ = ["Engine", "run_shards", "shard", "sink"]

_LOG = logging.getLogger(__name__)

# Variants of one task on Dask, each of which costs a message.
_VARIANTS_PER_DASK_TASK = 2**20


def sink(
    space: Space | Study,
    folder: str | Path,
    *,
    resume: bool = True,
    fresh: bool = False,
    loads_tn: Sequence[float] | None = None,
    limits: Limits | None = None,
    objective: Objective | Sequence[Objective] | None = None,
    model: StudyModel | None = None,
    solver: Solver | None = None,
    constraints: Mapping[str, Own] | None = None,
    columns: Mapping[str, Own] | None = None,
    rows_per_part: int | None = None,
    engine: Engine = "threads",
    workers: int | None = None,
    scheduler: str | None = None,
    executor: Executor | None = None,
    progress: ShowProgress = None,
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
    loads_tn, limits, model, solver, constraints, columns : optional
        As for :func:`cyclosweep.sweep.scan`.
    objective : Objective or sequence of them, optional
        What the summary's ten best variants are best in.
    rows_per_part : int, optional
        Variants a part, by default what a thread computes in seconds: 2^18, or 2^14 with the
        component model.
    engine : {"threads", "processes", "dask"}
        Where parts are computed.
    workers : int, optional
        How many at a time; by default two threads, as many processes as there are cores.
    scheduler : str, optional
        Address of a running Dask scheduler; a local cluster is started without one.
    executor : concurrent.futures.Executor, optional
        Computes the parts instead of an engine of our own.
    progress : bool or callable, optional
        Show a progress bar; by default when standard error is a terminal or in a notebook. A
        callable is called with the variants done and all that there are.

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
    study = Study.of(
        space,
        loads_tn=loads_tn,
        limits=limits,
        objective=objective,
        model=model,
        solver=solver,
        constraints=constraints,
        columns=columns,
    )
    dataset = dataset_of(study, folder, rows_per_part)
    if executor is not None:
        instance_of("executor", executor, Executor)
    if executor is None:
        make = executor_of(engine, workers=workers, scheduler=scheduler)
    else:
        make = lend(executor)
    parts_per_task = 1
    if engine == "dask":
        # A worker has its own working directory, so the path must be absolute.
        dataset = replace(dataset, folder=dataset.folder.absolute())
        parts_per_task = max(
            1, min(_VARIANTS_PER_DASK_TASK // dataset.rows_per_part, dataset.part_count // 8)
        )
    with _exclusive(dataset, resume=resume, fresh=fresh):
        summaries = dataset.summaries()
        whole = {summary.start for summary in summaries}
        missing = (part for part in dataset.parts() if part.start not in whole)
        done = sum(summary.stop - summary.start for summary in summaries)
        began = time.monotonic()
        _LOG.info("sweep of %s to %s: %s variants, %s of them there", study, dataset.folder,
                  f"{len(study):,}", f"{done:,}")  # fmt: skip
        with Progress("sweep", len(study), done=done, show=progress) as bar:

            def advance(summary: PartSummary) -> None:
                bar.advance(summary.stop - summary.start)
                _LOG.debug("variants %d to %d written", summary.start, summary.stop - 1)

            try:
                summaries += run_shards(
                    dataset,
                    missing,
                    make,
                    advance,
                    parts_per_task=parts_per_task,
                    count=dataset.part_count - len(whole),
                )
            except BaseException:
                with contextlib.suppress(OSError):
                    dataset.finish(dataset.summaries())
                raise
            _finish(dataset, summaries)
    found = summarise(summaries, study)
    _LOG.info("sweep to %s ended after %.1f s: %s", dataset.folder, time.monotonic() - began, found)
    return found


def shard(
    space: Space | Study,
    folder: str | Path,
    *,
    index: int,
    of: int,
    rows_per_part: int | None = None,
    progress: ShowProgress = None,
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
    rows_per_part : int, optional
        Variants a part, the same for every task.
    progress : bool or callable, optional
        Show a progress bar; by default when standard error is a terminal or in a notebook. A
        callable is called with the variants done and all that there are.

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
    of = whole_number("shard: of", of, least=1)
    index = whole_number("shard: index", index, most=of - 1)
    study = Study.of(space)
    dataset = dataset_of(study, folder, rows_per_part)
    dataset.prepare(resume=True, fresh=False)
    numbers = range(index, dataset.part_count, of)
    parts = (dataset.part(number) for number in numbers)
    total = len(numbers) * dataset.rows_per_part
    if numbers and numbers[-1] == dataset.part_count - 1:
        total -= dataset.part_count * dataset.rows_per_part - len(study)
    with Progress(f"shard {index} of {of}", total, show=progress) as bar:

        def advance(summary: PartSummary) -> None:
            bar.advance(summary.stop - summary.start)

        summaries = run_shards(dataset, parts, executor_of("threads"), advance, count=len(numbers))
    # Whichever task ends last finds every part there.
    with FileLock(dataset.folder / ".manifest.lock"):
        dataset.write_manifest(dataset.summaries())
    (dataset.folder / ".manifest.lock").unlink(missing_ok=True)
    return summarise(summaries, study)


def _finish(dataset: Dataset, summaries: list[PartSummary]) -> None:
    """Write the manifest; SweepError on a full disk, which leaves the parts as they are."""
    try:
        dataset.finish(summaries)
    except OSError as error:
        raise SweepError(f"{dataset.folder}: manifest: {error.strerror}") from None


@contextlib.contextmanager
def _exclusive(dataset: Dataset, *, resume: bool, fresh: bool) -> Iterator[None]:
    """Keep a second full sweep from the folder while this process lives."""
    folder = dataset.folder
    dataset.check(resume=resume, fresh=fresh)  # before a folder is made or a lock laid into it
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
