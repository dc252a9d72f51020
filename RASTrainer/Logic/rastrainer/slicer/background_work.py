"""Long work runs in a worker thread, as a function of plain data.

It touches no node, no widget and no connection to the study but its own. Its result is
delivered on the main thread, which then shows it.

Slicer starts PythonQt without support of threads: its main thread keeps Python's lock while Qt
waits for events, and a worker cannot run. `yieldTime` lets it run for moments too short to notice;
a timer calls it often while there is work. Only Python's own code and numpy's release the lock in
between: VTK's filters keep it to their end and belong in another process.
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
from rastrainer.slicer.signal import Signal
from rastrainer.work_progress import Progress

T = TypeVar("T")

CallLater = Callable[[Callable[[], object]], None]
"""Takes functions, each to be called in a later turn; see `BackgroundWork.later`."""


def callNow(function: Callable[[], object]) -> None:
    """Call a function at once, where there are no turns."""
    function()


TIME_S = 0.02
"""How long the main thread waits for a worker at a time."""
PERIOD_MS = 40
"""Period of the timer that does so: about half of the time is the worker's."""
SWITCH_INTERVAL_S = 0.0002
"""How soon a worker returns Python's lock to a main thread that wants it."""
CLOSING_S = 1.0
"""How long closing waits for running work."""
LEAVING_S = 0.2
"""How long it then waits for the work to end what it had started."""


class _Workers:
    """Makes Python give the main thread priority while any worker runs.

    It looks for no cycles of garbage: that would happen in a worker's thread, where wrappers of
    VTK's and Qt's objects must not die, and among all that Slicer holds it takes tenths of a
    second, which nothing interrupts. So the main thread lets Python collect again.

    And a worker gives Python's lock back soon: numpy gives it away in each call of LAPACK, so that
    the main thread would wait Python's usual 5 ms hundreds of times in one registration.
    """

    def __init__(self) -> None:
        self._count = 0
        self._wasEnabled = False
        self._interval_s = sys.getswitchinterval()

    def begin(self) -> None:
        """Note that a worker starts; called by the main thread only, as `end`."""
        if self._count == 0:
            self._wasEnabled = gc.isenabled()
            gc.disable()
            self._interval_s = sys.getswitchinterval()
            sys.setswitchinterval(SWITCH_INTERVAL_S)
        self._count += 1

    def end(self) -> None:
        """Note that a worker has ended, or that its result is no longer needed."""
        self._count -= 1
        if self._count:
            return
        sys.setswitchinterval(self._interval_s)
        if self._wasEnabled:
            gc.enable()


_WORKERS = _Workers()


class Job(Generic[T]):
    """One job in a thread, started at once and supervised by the main thread."""

    def __init__(self, work: Callable[[], T]) -> None:
        self._work = work
        self._outcome: Future[T] = Future()
        self._isSupervised = True
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

    def yieldTime(self, seconds: float = TIME_S) -> None:
        """Let the thread run, and return when it has ended or the time is over."""
        self._thread.join(seconds)

    def leave(self) -> None:
        """Stop supervising the thread: it has ended, or its result is no longer needed."""
        if self._isSupervised:
            self._isSupervised = False
            _WORKERS.end()

    def result(self) -> T:
        """Return what finished work has returned, or raise what it has raised."""
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
    """Runs one job after the other; `process` delivers the results in this order.

    Attributes:
        began: emits nothing when there is work after there was none.
    """

    def __init__(self) -> None:
        self.began = Signal()
        self._waiting: deque[_Waiting] = deque()
        self._slices: deque[Callable[[], object]] = deque()
        self._underWay: tuple[Job[Any], _Waiting] | None = None
        self._isClosed = False
        self._clearedCount = 0
        self._isLeft = threading.Event()

    @property
    def isBusy(self) -> bool:
        """Whether there is anything that `process` has not delivered yet."""
        return self._underWay is not None or bool(self._waiting or self._slices)

    def do(
        self,
        work: Callable[[], T],
        take: Callable[[T], None],
        refuse: Callable[[Exception], None] = lambda _error: None,
    ) -> None:
        """Run `work`, unless closed; it starts when earlier results have been delivered.

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
        self._startNext()
        if not wasBusy:
            self.began.emit()

    def later(self, slice_: Callable[[], object]) -> None:
        """Have a later `process` call a function on the main thread, one each time."""
        if self._isClosed:
            return
        wasBusy = self.isBusy
        self._slices.append(slice_)
        if not wasBusy:
            self.began.emit()

    def changeScene(self, change: Callable[[], object]) -> None:
        """Have a change made as by `later`, unless the scene is cleared before."""
        count = self._clearedCount
        self.later(lambda: change() if count == self._clearedCount else None)

    def forgetScene(self) -> None:
        """Drop the postponed changes: the scene was cleared."""
        self._clearedCount += 1

    def yieldTime(self) -> None:
        """Let running work continue for a moment, unless functions are postponed."""
        if self._underWay is not None and not self._slices:
            self._underWay[0].yieldTime()

    def process(self) -> None:
        """Call one postponed function, or deliver a finished result."""
        if self._slices:
            try:
                self._slices.popleft()()
            finally:
                self._startNext()
            return
        if self._underWay is None or not self._underWay[0].isDone:
            return
        job, ended = self._underWay
        self._underWay = None
        try:
            self._deliver(job, ended)
        finally:
            self._startNext()

    def checkWanted(self, _step: str = "", _share: float = 0.0) -> None:
        """End running work, which calls this in its thread, once its result is no longer needed."""
        if self._isLeft.is_set():
            raise AbandonedWorkError

    def close(self) -> None:
        """Wait briefly for running work, deliver it, and do nothing more."""
        self._isClosed = True
        self._waiting.clear()
        self._slices.clear()
        if self._underWay is None:
            return
        job = self._underWay[0]
        job.yieldTime(CLOSING_S)
        self.process()
        if self._underWay is not None:
            self._isLeft.set()
            job.yieldTime(LEAVING_S)
            job.leave()
            self._underWay = None

    def _startNext(self) -> None:
        """Start waiting work after postponed functions: both at once would share Python's lock."""
        if self._waiting and self._underWay is None and not self._slices:
            waiting = self._waiting.popleft()
            self._underWay = Job(waiting.work), waiting

    def _deliver(self, job: Job[Any], ended: _Waiting) -> None:
        try:
            result = job.result()
        except Exception as error:
            ended.refuse(error)
            if not isinstance(error, InputError):
                raise
        else:
            ended.take(result)


def inBackground(work: Callable[[Progress], T], progress: Progress) -> T:
    """Return what `work` returns, calling `progress` many times a second meanwhile.

    Args:
        work: called with a function to report its progress to, which raises once `progress` has.
        progress: may let the application draw, and may raise to cancel.
    """
    reported: list[tuple[str, float]] = [("", 0.0)]
    isCanceled = threading.Event()

    def report(step: str, share: float) -> None:
        reported.append((step, share))
        if isCanceled.is_set():
            raise AbandonedWorkError

    job = Job(lambda: work(report))
    try:
        while not job.isDone:
            progress(*reported[-1])
            job.yieldTime()
    except BaseException:
        isCanceled.set()
        job.leave()
        raise
    return job.result()


class CancelableUntilBegun:
    """Lets the user cancel until the work begins to change something."""

    def __init__(self, progress: Progress) -> None:
        """`progress` raises to cancel, as that of `inBackground`."""
        self._progress = progress
        self._decision = threading.Lock()

    def begin(self) -> None:
        """Note, in the worker, that canceling is over; raise if the work was canceled."""
        if not self._decision.acquire(blocking=False):
            raise AbandonedWorkError

    def progress(self, step: str, share: float) -> None:
        """Report to `progress`; what it raises is passed on only before `begin`."""
        try:
            self._progress(step, share)
        except Exception:
            if self._decision.acquire(blocking=False):
                raise


class AbandonedWorkError(Exception):
    """The result of the work is no longer needed."""
