"""Worker processes with one job at a time, so that the job of a process that dies is known.

`concurrent.futures` gives up all jobs when one process is killed (out of memory, or by a crash in a
library). Here only its job is repeated by a new process.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import threading
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from itertools import islice
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

from rastrainer.errors import InputError, RASTrainerError

ATTEMPTS = 3
"""Number of processes that may die at one job."""
AHEAD = 8
"""Jobs per worker that may be done ahead of their turn: results wait in memory."""


class WorkerDiedError(InputError):
    """Every process that tried a job died."""


def run_on_workers(
    function: Callable[[Any], Any], jobs: Iterable[Any], workers: int, name_of: Callable[[Any], str]
) -> Iterator[Any]:
    """Yield the result of each job, in their order; the processes end with the iterator.

    `function` can be pickled; its exceptions are raised here, in the turn of their job.
    """
    jobs, pool, threads = iter(jobs), _Pool(function, name_of), ThreadPoolExecutor(workers)
    try:
        coming = deque(threads.submit(pool.do, job) for job in islice(jobs, AHEAD * workers))
        while coming:
            result = coming.popleft().result()
            coming.extend(threads.submit(pool.do, job) for job in islice(jobs, 1))
            yield result
    finally:
        pool.close()
        threads.shutdown(cancel_futures=True)


class _Pool:
    """The processes, each with the pipe to it; a thread waits for the job of each busy one."""

    def __init__(self, function: Callable[[Any], Any], name_of: Callable[[Any], str]) -> None:
        self._function, self._name_of = function, name_of
        self._workers: dict[Connection, SpawnProcess] = {}
        self._idle: list[Connection] = []
        self._is_closed = False
        # Processes are started and ended one after the other: each looks after all of them.
        self._lock = threading.Lock()

    def do(self, job: Any) -> Any:
        """Return the result of a job; if its process dies, another one repeats it."""
        exit_code: int | None = None
        for _attempt in range(ATTEMPTS):
            connection = self._idle_or_new()
            try:
                connection.send(job)
                result, error = connection.recv()
            except (EOFError, OSError):
                # It closed its end: it is dead or about to die.
                with self._lock:
                    process = self._workers.pop(connection)
                    process.join()
                    exit_code = process.exitcode
                    connection.close()
                continue
            self._idle.append(connection)
            if error is not None:
                raise error
            return result
        cause = f" (the last with exit status {exit_code})"
        if exit_code is not None and exit_code < 0:
            with contextlib.suppress(ValueError):
                cause = f" (the last by {signal.Signals(-exit_code).name})"
        raise WorkerDiedError(died_message(self._name_of(job), cause))

    def _idle_or_new(self) -> Connection:
        with self._lock:
            if self._is_closed:
                raise CancelledError
            if self._idle:
                return self._idle.pop()
            # Not forked: collision meshes and threads of numpy do not survive that.
            context = multiprocessing.get_context("spawn")
            ours, theirs = context.Pipe()
            process = context.Process(target=_work, args=(theirs, self._function), daemon=True)
            if hasattr(signal, "pthread_sigmask"):
                # Ctrl-C is not for this thread, nor for a process that is starting, which inherits.
                signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            process.start()
            theirs.close()
            self._workers[ours] = process
            return ours

    def close(self) -> None:
        """End all processes; the threads that wait for one notice it at the pipe's end."""
        with self._lock:
            self._is_closed = True
            for process in self._workers.values():
                process.terminate()
            for process in self._workers.values():
                process.join()
            for connection in self._idle:
                connection.close()


def died_message(job: str, cause: str) -> str:
    """Return the error message of a job at which all processes died."""
    return (
        f"{job} cannot be played: {ATTEMPTS} worker processes were ended while they played "
        f"it{cause}. The computer may be short of memory: try fewer workers, or --workers 1 to see "
        "the error itself. The trials played so far are stored, and the same command resumes."
    )


def _work(connection: Connection, function: Callable[[Any], Any]) -> None:
    """Do jobs until the other end is closed, also by the death of its process."""
    # Ctrl-C reaches all processes of a terminal; the main process ends the others.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    outcome: tuple[Any, Exception | None]
    with contextlib.suppress(EOFError, OSError):
        while True:
            job = connection.recv()
            try:
                outcome = function(job), None
            except RASTrainerError as error:
                outcome = None, error
            except Exception:
                # Not every exception can be pickled, but its traceback can.
                text = f"A worker process failed:\n{traceback.format_exc()}"
                outcome = None, RuntimeError(text)
            connection.send(outcome)
