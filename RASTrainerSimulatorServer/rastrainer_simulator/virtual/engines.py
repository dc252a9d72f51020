"""Where the jobs run: in this process, on all cores of this machine, or on a Dask cluster."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator
from typing import TypeVar

from rastrainer.errors import InputError
from rastrainer_simulator.virtual.worker_pool import (
    ATTEMPTS,
    WorkerDiedError,
    died_message,
    run_on_workers,
)

Job = TypeVar("Job")
Result = TypeVar("Result")

PROCESSES, DASK = "processes", "dask"
_AS_MANY_ATTEMPTS = {"distributed.scheduler.allowed-failures": ATTEMPTS - 1}


def run_jobs(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    engine: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
    name_of: Callable[[Job], str] = str,
) -> Iterator[Result]:
    """Yield the result of each job, in their order.

    A job whose process is killed is repeated by another one, unless `workers` is 1 and it is this
    process.

    Args:
        function: Can be pickled; depends on nothing but the job.
        jobs: Can be pickled.
        engine: `processes`, or `dask` (package `distributed`).
        workers: Processes on this machine; one per core by default.
        address: Of a Dask scheduler, for more than one machine; a local cluster by default.
        name_of: Returns the name of a job for error messages.

    Raises:
        InputError: Dask is not installed, or there is no scheduler at the address.
        WorkerDiedError: several processes in turn died at one job.
    """
    workers = workers or os.cpu_count() or 1
    if engine == DASK:
        yield from _on_dask(function, jobs, workers, address, name_of)
    elif workers == 1:
        yield from map(function, jobs)
    else:
        yield from run_on_workers(function, jobs, workers, name_of)


def _on_dask(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    workers: int,
    address: str | None,
    name_of: Callable[[Job], str],
) -> Iterator[Result]:
    try:
        import dask
        from distributed import Client, KilledWorker
    except ImportError:
        raise InputError(
            "The engine dask needs the package distributed: pip install distributed."
        ) from None
    try:
        if address is None:
            with dask.config.set(_AS_MANY_ATTEMPTS):
                client = Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        else:
            client = Client(address, timeout="3s")
    except OSError as error:
        raise InputError(f"There is no Dask scheduler at {address}: {error}.") from None
    jobs = list(jobs)
    with client:
        for job, future in zip(jobs, client.map(function, jobs, pure=False), strict=True):
            try:
                yield future.result()
            except KilledWorker:
                # Dask blames every job of the worker, even one that had just finished.
                cause = " or another trial at the same worker"
                raise WorkerDiedError(died_message(name_of(job), cause)) from None
