"""Where the jobs run: in this process, on all cores of this machine, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

from rastrainer.errors import InputError

Job = TypeVar("Job")
Result = TypeVar("Result")

PROCESSES, DASK = ENGINES = ("processes", "dask")


def run_jobs(
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    engine: str = PROCESSES,
    workers: int | None = None,
    address: str | None = None,
) -> Iterator[Result]:
    """Yield the result of each job, in their order.

    Args:
        function: Can be pickled; depends on nothing but the job.
        jobs: Can be pickled.
        engine: `processes`, or `dask` (package `distributed`).
        workers: Processes on this machine; one a core by default.
        address: Of a Dask scheduler, for more than one machine; a local cluster by default.

    Raises:
        InputError: Dask is not installed, or there is no scheduler at the address.
    """
    workers = workers or os.cpu_count() or 1
    if engine == DASK:
        yield from _on_dask(function, jobs, workers, address)
    elif workers == 1:
        yield from map(function, jobs)
    else:
        # Not forked: collision meshes and threads of numpy do not survive that.
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(workers, mp_context=context) as pool:
            yield from pool.map(function, jobs, chunksize=1)


def _on_dask(
    function: Callable[[Job], Result], jobs: Iterable[Job], workers: int, address: str | None
) -> Iterator[Result]:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            "The engine dask needs the package distributed: pip install distributed."
        ) from None
    try:
        if address is None:
            client = Client(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        else:
            client = Client(address, timeout="3s")
    except OSError as error:
        raise InputError(f"There is no Dask scheduler at {address}: {error}.") from None
    with client:
        futures = client.map(function, list(jobs), pure=False)
        for future in futures:
            yield future.result()
