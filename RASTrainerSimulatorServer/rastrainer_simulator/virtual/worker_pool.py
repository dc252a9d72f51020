"""Worker processes with one job at a time, so that the job of a process that dies is known.

`concurrent.futures` gives up all jobs when one process is killed (out of memory, or by a crash in a
library). Here only its job is repeated by a new process.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import signal
import traceback
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
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

    `function` can be pickled; its exceptions are raised here.
    """
    pool = _Pool(function, workers, name_of)
    try:
        yield from pool.results(jobs)
    finally:
        for worker in pool.workers:
            worker.end()


@dataclass
class _Task:
    place: int
    job: Any
    attempts: int = 0


class _Worker:
    """One process, the pipe to it, and its task."""

    def __init__(self, function: Callable[[Any], Any]) -> None:
        # Not forked: collision meshes and threads of numpy do not survive that.
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        self.process = context.Process(target=_work, args=(theirs, function), daemon=True)
        self.task: _Task | None = None
        with _interrupts_blocked():
            self.process.start()
        theirs.close()

    def send(self, task: _Task) -> None:
        task.attempts += 1
        self.task = task
        # A dead process is noticed below, at the pipe's end.
        with contextlib.suppress(OSError):
            self.connection.send(task.job)

    def end(self) -> int | None:
        """End the process if it still runs, and return its exit code."""
        self.connection.close()
        self.process.terminate()
        self.process.join()
        return self.process.exitcode


class _Pool:
    def __init__(
        self, function: Callable[[Any], Any], workers: int, name_of: Callable[[Any], str]
    ) -> None:
        self._function, self._most, self._name_of = function, workers, name_of
        self.workers: list[_Worker] = []
        self._again: deque[_Task] = deque()
        self._done: dict[int, tuple[Any, Exception | None]] = {}

    def results(self, jobs: Iterable[Any]) -> Iterator[Any]:
        tasks = (_Task(place, job) for place, job in enumerate(jobs))
        turn = given = 0
        while True:
            count = sum(worker.task is not None for worker in self.workers)
            while count < self._most and (self._again or given < turn + AHEAD * self._most):
                task = self._again.popleft() if self._again else next(tasks, None)
                if task is None:
                    break
                given = max(given, task.place + 1)
                idle = next((worker for worker in self.workers if worker.task is None), None)
                if idle is None:
                    idle = _Worker(self._function)
                    self.workers.append(idle)
                idle.send(task)
                count += 1
            busy = [(worker, task) for worker in self.workers if (task := worker.task) is not None]
            if not busy:
                return
            ready = wait([worker.connection for worker, _ in busy])
            for worker, task in busy:
                if worker.connection in ready:
                    self._receive(worker, task)
            while turn in self._done:
                # An error waits for its turn, too: earlier results are not lost.
                result, error = self._done.pop(turn)
                if error is not None:
                    raise error
                yield result
                turn += 1

    def _receive(self, worker: _Worker, task: _Task) -> None:
        """Take the result; if the process died, have another process repeat its job."""
        with contextlib.suppress(EOFError, OSError):
            self._done[task.place] = worker.connection.recv()
            worker.task = None
            return
        self.workers.remove(worker)
        # It closed its end: it is dead or about to die.
        worker.process.join()
        exit_code = worker.end()
        if task.attempts < ATTEMPTS:
            self._again.append(task)
            return
        cause = f" (the last with exit status {exit_code})"
        if exit_code is not None and exit_code < 0:
            with contextlib.suppress(ValueError):
                cause = f" (the last by {signal.Signals(-exit_code).name})"
        sentence = died_message(self._name_of(task.job), cause)
        self._done[task.place] = None, WorkerDiedError(sentence)


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


@contextlib.contextmanager
def _interrupts_blocked() -> Iterator[None]:
    """Block Ctrl-C for a process that is being started, which inherits this."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
