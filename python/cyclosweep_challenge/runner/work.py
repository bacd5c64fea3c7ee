"""Run jobs on processes or threads, with progress and a time limit."""

from __future__ import annotations

import math
import multiprocessing
import os
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from typing import Any, TypeVar

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

from cyclosweep_challenge.runner.diagnosing import command

T = TypeVar("T")


@dataclass(frozen=True)
class Options:
    """How a challenge is run, apart from what it is made of.

    Attributes
    ----------
    workers : int
        Processes at a time.
    batch : int
        Most recordings shown to one process of the diagnosis; fewer where that keeps every
        worker busy to the end.
    limit_s : float
        Time allowed for one recording [s].
    diagnose_flags : tuple of str
        Further flags of ``cyclosweep diagnose``.
    removal_flag : str
        Flag that takes an effect out of the library, followed by its name.
    program : tuple of str
        Command that starts ``cyclosweep``; with this interpreter where empty.
    opponents : str
        ``all``, ``cheap`` or ``none``.
    costly_limit : int
        Recordings of each stratum that the costly opponents see.
    passphrase : str
        Deprecated and without effect: answers are committed to by a hash and not encrypted.
    until : float
        Clock of ``time.monotonic`` after which no further work is begun [s].
    """

    workers: int = 1
    batch: int = 50
    limit_s: float = 60.0
    diagnose_flags: tuple[str, ...] = ()
    removal_flag: str = "--without"
    program: tuple[str, ...] = ()
    opponents: str = "all"
    costly_limit: int = 300
    passphrase: str = ""
    until: float = math.inf

    def __post_init__(self) -> None:
        """Say that a passphrase does nothing any more."""
        if self.passphrase:
            warnings.warn(
                "passphrase: deprecated and without effect, answers are no longer encrypted",
                DeprecationWarning,
                stacklevel=3,
            )

    def batches(self, items: Sequence[T]) -> Iterator[Sequence[T]]:
        """Share work out in batches, about two for every worker if there are several."""
        even = len(items) if self.workers == 1 else -(-len(items) // (2 * self.workers))
        size = max(1, min(self.batch, even))
        return (items[k : k + size] for k in range(0, len(items), size))


class OutOfTimeError(Exception):
    """The time limit has passed; finished work stays."""


def program_of(options: Options) -> tuple[str, ...]:
    """Command that starts ``cyclosweep``."""
    return options.program or tuple(command())


def _pool(workers: int, processes: bool) -> Executor:
    """Return threads, or processes that do not fork with one linear-algebra thread each."""
    if not processes:
        return ThreadPoolExecutor(workers)
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    return ProcessPoolExecutor(workers, mp_context=multiprocessing.get_context("spawn"))


def _results(
    workers: int,
    processes: bool,
    jobs: Sequence[tuple[Callable[..., T], tuple[Any, ...]]],
    until: float,
) -> Iterator[T]:
    """Results of jobs as they come; a single worker is this process itself.

    Raises
    ------
    OutOfTimeError
        If work is left when the time is over; what had begun by then is finished.
    """
    if workers == 1:
        for function, arguments in jobs:
            if time.monotonic() > until:
                raise OutOfTimeError
            yield function(*arguments)
        return
    if not jobs:
        return
    if time.monotonic() > until:
        raise OutOfTimeError
    pool = _pool(workers, processes)
    try:
        futures = [pool.submit(function, *arguments) for function, arguments in jobs]
        late = False
        for future in as_completed(futures):
            if not late and time.monotonic() > until:
                late = sum(other.cancel() for other in futures) > 0
            if not future.cancelled():
                yield future.result()
        if late:
            raise OutOfTimeError
    finally:
        pool.shutdown(cancel_futures=True)


def work(
    title: str,
    workers: int,
    jobs: Sequence[tuple[Callable[..., T], tuple[Any, ...]]],
    console: Console,
    done: Callable[[T], None] = lambda _: None,
    *,
    until: float = math.inf,
    processes: bool = True,
) -> None:
    """Run jobs, showing progress; ``done`` takes each result as it comes."""
    columns = (TextColumn(title), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, disable=not console.is_terminal) as progress:
        task = progress.add_task(title, total=len(jobs))
        for result in _results(workers, processes, jobs, until):
            done(result)
            progress.advance(task)
