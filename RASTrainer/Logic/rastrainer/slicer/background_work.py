"""Work that takes long leaves the main thread: a function of plain data runs in a worker thread.

It touches no node, no widget and no connection to the study but its own. What it returns is handed
over on the main thread, which then shows it.

Slicer starts PythonQt without support of threads: its main thread keeps Python's lock while Qt
waits for events, and a worker stands still. `giveTime` lets it run, for moments too short to be
felt; whoever has a timer calls it often while there is work. Only Python's own code and numpy's
give way in between: filters of VTK keep the lock to their end, and belong into another process.
"""

from __future__ import annotations

import gc
import sys
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from rastrainer.errors import InputError
from rastrainer.progress import Progress
from rastrainer.slicer.main_turn import workersTurn
from rastrainer.slicer.signal import Signal

T = TypeVar("T")

TIME_S = 0.02
"""So long the main thread waits for a worker at a time."""
PERIOD_MS = 40
"""So often a timer does it: about half of the time is the worker's."""
SWITCH_INTERVAL_S = 0.0002
"""So soon a worker gives Python's lock back to the main thread that wants it."""
CLOSING_S = 1.0
"""So long closing waits for what is under way."""


class _Workers:
    """Has Python treat the main thread well while any worker runs.

    It looks for no cycles of garbage: that would happen in a worker's thread, where wrappers of
    VTK's and Qt's objects must not die, and among all that Slicer holds it takes tenths of a
    second, which nothing interrupts. So it is the main thread that lets Python look again: what is
    overdue is done by whoever allows it.

    And a worker gives Python's lock back soon: numpy gives it away in each call of LAPACK, so that
    the main thread would wait Python's usual 5 ms hundreds of times in one registration.
    """

    def __init__(self) -> None:
        self._count = 0
        self._wasEnabled = False
        self._interval_s = sys.getswitchinterval()

    def begin(self) -> None:
        """A worker begins; only the main thread calls this, as the next."""
        if self._count == 0:
            self._wasEnabled = gc.isenabled()
            gc.disable()
            self._interval_s = sys.getswitchinterval()
            sys.setswitchinterval(SWITCH_INTERVAL_S)
        self._count += 1

    def end(self) -> None:
        """A worker has ended, or nobody waits for it any more."""
        self._count -= 1
        if self._count:
            return
        sys.setswitchinterval(self._interval_s)
        if self._wasEnabled:
            gc.enable()


_WORKERS = _Workers()


class Job(Generic[T]):
    """One piece of work in a thread of its own, begun at once; the main thread looks after it."""

    def __init__(self, work: Callable[[], T]) -> None:
        self._work = work
        self._outcome: Future[T] = Future()
        self._isLookedAfter = True
        self._thread = threading.Thread(target=self._run, daemon=True)
        _WORKERS.begin()
        self._thread.start()

    @property
    def isDone(self) -> bool:
        """Whether the thread has ended."""
        isDone = not self._thread.is_alive()
        if isDone:
            self.leave()
        return isDone

    def giveTime(self, seconds: float = TIME_S) -> None:
        """Let the thread run, and return as soon as it has ended."""
        with workersTurn():
            self._thread.join(seconds)

    def leave(self) -> None:
        """Look after the thread no more: it has ended, or nobody waits for it."""
        if self._isLookedAfter:
            self._isLookedAfter = False
            _WORKERS.end()

    def result(self) -> T:
        """Return what the work has returned, or raise what it has raised, once it is done."""
        return self._outcome.result(timeout=0)

    def _run(self) -> None:
        try:
            self._outcome.set_result(self._work())
        except BaseException as error:
            self._outcome.set_exception(error)


@dataclass(frozen=True)
class _Waiting:
    work: Callable[[], Any]
    take: Callable[[Any], None]
    refuse: Callable[[Exception], None]


class BackgroundWork:
    """Does one piece of work after the other; results come by `process`, in the same order.

    Attributes:
        began: emits nothing, when there is work after there was none.
    """

    def __init__(self) -> None:
        self.began = Signal()
        self._waiting: deque[_Waiting] = deque()
        self._slices: deque[Callable[[], None]] = deque()
        self._underWay: tuple[Job[Any], _Waiting] | None = None
        self._isClosed = False

    @property
    def isBusy(self) -> bool:
        """Whether there is anything that `process` has not yet handed over."""
        return self._underWay is not None or bool(self._waiting or self._slices)

    def do(
        self,
        work: Callable[[], T],
        take: Callable[[T], None],
        refuse: Callable[[Exception], None] = lambda _error: None,
    ) -> None:
        """Have something done, unless closed; it is begun when what came before is handed over.

        Args:
            work: runs in a thread; see the module for what it may touch.
            take: called by a later `process` with what `work` has returned.
            refuse: called in its place with what `work` has raised. What is no `InputError` is
                then raised by `process`, too: it is a mistake of ours.
        """
        if self._isClosed:
            return
        wasBusy = self.isBusy
        self._waiting.append(_Waiting(work, take, refuse))
        self._beginNext()
        if not wasBusy:
            self.began.emit()

    def later(self, slice_: Callable[[], None]) -> None:
        """Have a function called on the main thread by a later `process`, one in each."""
        if self._isClosed:
            return
        wasBusy = self.isBusy
        self._slices.append(slice_)
        if not wasBusy:
            self.began.emit()

    def giveTime(self) -> None:
        """Let what is under way run for a moment, unless the main thread has what was put off."""
        if self._underWay is not None and not self._slices:
            self._underWay[0].giveTime()

    def process(self) -> None:
        """Call what was put off till later, one function at a time; hand over what is done."""
        if self._slices:
            try:
                self._slices.popleft()()
            finally:
                self._beginNext()
            return
        if self._underWay is None or not self._underWay[0].isDone:
            return
        job, ended = self._underWay
        self._underWay = None
        try:
            self._handOver(job, ended)
        finally:
            self._beginNext()

    def close(self) -> None:
        """Wait a moment for what is under way, hand it over, and do nothing more."""
        self._isClosed = True
        self._waiting.clear()
        self._slices.clear()
        if self._underWay is None:
            return
        job = self._underWay[0]
        job.giveTime(CLOSING_S)
        self.process()
        job.leave()
        self._underWay = None

    def _beginNext(self) -> None:
        """Begin what waits, after what is put off: both at once would share Python's lock."""
        if self._waiting and self._underWay is None and not self._slices:
            waiting = self._waiting.popleft()
            self._underWay = Job(waiting.work), waiting

    def _handOver(self, job: Job[Any], ended: _Waiting) -> None:
        try:
            result = job.result()
        except Exception as error:
            ended.refuse(error)
            if not isinstance(error, InputError):
                raise
        else:
            ended.take(result)


def inBackground(work: Callable[[Progress], T], progress: Progress) -> T:
    """Return what `work` returns; meanwhile `progress` is told of it many times a second.

    Args:
        work: is given what it tells its progress; is broken off there once `progress` has raised.
        progress: may let the application draw, and may raise to cancel.
    """
    told: list[tuple[str, float]] = [("", 0.0)]
    isCanceled = threading.Event()

    def tell(step: str, share: float) -> None:
        told.append((step, share))
        if isCanceled.is_set():
            raise _BrokenOffError

    job = Job(lambda: work(tell))
    try:
        while not job.isDone:
            progress(*told[-1])
            job.giveTime()
    except BaseException:
        isCanceled.set()
        job.leave()
        raise
    return job.result()


class _BrokenOffError(Exception):
    """Nobody waits for the work any more."""
