"""Where the parts of a study are computed: threads, processes or the workers of Dask."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import AbstractContextManager
from typing import Literal

from cyclosweep.design.numbers import whole_number
from cyclosweep.errors import InputError, SweepError, one_of

__all__ = ["ENGINES", "Engine", "MakeExecutor", "dask_executor", "executor_of", "lend"]

Engine = Literal["threads", "processes", "dask"]
ENGINES: tuple[Engine, ...] = ("threads", "processes", "dask")
MakeExecutor = Callable[[], AbstractContextManager[Executor]]

_CONNECT_S = 10.0
"""Time allowed for reaching a scheduler [s]."""
# Dask's nanny sets MALLOC_TRIM_THRESHOLD_, which slows small parts 2.5 times.
_ENVIRONMENT = {"RAYON_NUM_THREADS": "1", "POLARS_MAX_THREADS": "1", "OMP_NUM_THREADS": "1"}


def lend(executor: Executor) -> MakeExecutor:
    """Return a function that gives the caller's executor and leaves it open."""
    return lambda: contextlib.nullcontext(executor)


def executor_of(
    engine: Engine, *, workers: int | None = None, scheduler: str | None = None
) -> MakeExecutor:
    """Return a function that opens an executor of an engine.

    Parameters
    ----------
    engine : {"threads", "processes", "dask"}
        Where tasks run.
    workers : int, optional
        How many at a time; by default two threads, as many processes as there are cores.
    scheduler : str, optional
        Address of a running Dask scheduler; a local cluster is started without one.

    Returns
    -------
    callable
        Gives a context manager of an executor.

    Raises
    ------
    InputError
        For an unknown engine, workers that are no whole number above zero, or a scheduler of
        another engine than Dask.
    """
    if scheduler is not None and engine != "dask":
        raise InputError(f"scheduler: only for engine dask, found engine {engine}")
    if workers is not None:
        workers = whole_number("workers", workers, least=1)
    one_of("engine", engine, ENGINES)
    if engine == "threads":
        # The kernel and the encoder each use every core; two parts in flight overlap them.
        return lambda: ThreadPoolExecutor(workers or 2)
    if engine == "processes":
        return lambda: _process_pool(workers or os.cpu_count() or 1)
    return lambda: dask_executor(workers, scheduler)


@contextlib.contextmanager
def _process_pool(workers: int) -> Iterator[Executor]:
    """Open spawned processes of one thread each: fork hangs with the threads of polars."""
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


@contextlib.contextmanager
def dask_executor(workers: int | None, scheduler: str | None) -> Iterator[Executor]:
    """An executor on Dask workers of one thread each.

    Parameters
    ----------
    workers : int, optional
        Workers of the local cluster; one a core by default.
    scheduler : str, optional
        Address of a running scheduler, whose workers must see the output folder.

    Raises
    ------
    InputError
        When ``distributed`` is not installed, or the scheduler is no address.
    SweepError
        When the scheduler cannot be reached.
    """
    try:
        import dask
        from distributed import Client, LocalCluster
    except ImportError:
        raise InputError(
            "engine dask: distributed is not installed, expected cyclosweep[dask]"
        ) from None
    with contextlib.ExitStack() as stack:
        stack.enter_context(dask.config.set({"distributed.nanny.pre-spawn-environ": _ENVIRONMENT}))
        if scheduler is None:
            cluster = stack.enter_context(
                LocalCluster(
                    n_workers=workers, threads_per_worker=1, dashboard_address=None, processes=True
                )
            )
            client = stack.enter_context(Client(cluster))
        else:
            try:
                client = stack.enter_context(Client(scheduler, timeout=_CONNECT_S))
            except OSError as error:
                raise SweepError(f"scheduler {scheduler}: {error}") from None
            except ValueError as error:  # what is no address
                raise InputError(f"scheduler {scheduler}: {error}") from None
        # Not pure: a part that is tried again is a new task, not the failed one's result.
        executor = client.get_executor(retries=1, pure=False)
        executor._max_workers = max(sum(client.nthreads().values()), workers or 1)
        yield stack.enter_context(_closing(executor))


@contextlib.contextmanager
def _closing(executor: Executor) -> Iterator[Executor]:
    """Close an executor: wait for its tasks, but not after an error."""
    try:
        yield executor
    except BaseException:
        with contextlib.suppress(Exception):
            executor.shutdown(wait=False)
        raise
    executor.shutdown(wait=True)
