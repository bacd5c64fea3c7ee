"""Parts of a study on Dask: a local cluster by default, any other by its address."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from concurrent.futures import Executor

from cyclosweep.errors import InputError, SweepError

__all__ = ["dask_executor"]

# Dask's nanny sets MALLOC_TRIM_THRESHOLD_, which slows small parts 2.5 times.
_ENVIRONMENT = {"RAYON_NUM_THREADS": "1", "POLARS_MAX_THREADS": "1", "OMP_NUM_THREADS": "1"}


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
        When ``distributed`` is not installed.
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
                client = stack.enter_context(Client(scheduler, timeout=10))
            except OSError as error:
                raise SweepError(f"scheduler {scheduler}: {error}") from None
        # Not pure: a part that is tried again is a new task, not the failed one's result.
        executor = client.get_executor(retries=1, pure=False)
        executor._max_workers = max(sum(client.nthreads().values()), workers or 1)
        yield stack.enter_context(_closing(executor))


@contextlib.contextmanager
def _closing(executor: Executor) -> Iterator[Executor]:
    """Wait for what runs after a good end, and for nothing after a bad one."""
    try:
        yield executor
    except BaseException:
        with contextlib.suppress(Exception):
            executor.shutdown(wait=False)
        raise
    executor.shutdown(wait=True)
