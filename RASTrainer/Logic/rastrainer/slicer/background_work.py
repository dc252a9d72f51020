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
from typing import Any, Generic, TypeVar

from rastrainer.errors import InputError
from rastrainer.slicer.signal import Signal
from rastrainer.work_progress import Progress

T = TypeVar("T")

CallLater = Callable[[Callable[[], object]], None]
"""Takes functions, each to be called in a later turn; see `BackgroundWork.later`."""


def callNow(function: Callable[[], object]) -> None:
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
"""How long it then waits for the work to end."""


class Job(Generic[T]):
    """One job in a thread, started at once and supervised by the main thread.

    While any job runs, Python gives the main thread priority. It looks for no cycles of garbage:
    that would happen in a job's thread, where wrappers of VTK's and Qt's objects must not die, and
    among all that Slicer holds it takes tenths of a second, which nothing interrupts. And a job
    gives Python's lock back soon: numpy gives it away in each call of LAPACK, so that the main
    thread would wait Python's usual 5 ms hundreds of times in one registration.
    """

    _supervised = 0
    _former = True, 0.0
    """Whether Python collected garbage, and its interval of switching, before the first job."""

    def __init__(self, work: Callable[[], T]) -> None:
        self._work = work
        self.outcome: Future[T] = Future()
        self._isSupervised = True
        self.thread = threading.Thread(target=self._run, daemon=True)
        if not Job._supervised:
            Job._former = gc.isenabled(), sys.getswitchinterval()
            gc.disable()
            sys.setswitchinterval(SWITCH_INTERVAL_S)
        Job._supervised += 1
        self.thread.start()

    @property
    def isDone(self) -> bool:
        isDone = not self.thread.is_alive()
        if isDone:
            self.leave()
        return isDone

    def leave(self) -> None:
        """Stop supervising the thread: it has ended, or its result is no longer needed."""
        if not self._isSupervised:
            return
        self._isSupervised = False
        Job._supervised -= 1
        if not Job._supervised:
            wasCollecting, interval_s = Job._former
            sys.setswitchinterval(interval_s)
            if wasCollecting:
                gc.enable()

    def _run(self) -> None:
        try:
            self.outcome.set_result(self._work())
        except BaseException as error:
            self.outcome.set_exception(error)


_Take = Callable[[Any], None]
_Refuse = Callable[[Exception], None]


class BackgroundWork:
    """Runs one job after the other; `process` delivers the results in this order.

    `began` emits nothing whenever there is more to do.
    """

    def __init__(self) -> None:
        self.began = Signal()
        self._waiting: deque[tuple[Callable[[], Any], _Take, _Refuse]] = deque()
        self._slices: deque[Callable[[], object]] = deque()
        self._underWay: tuple[Job[Any], _Take, _Refuse] | None = None
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
        """Run `work` in a thread once earlier results have been delivered, unless closed.

        A later `process` calls `take` with its result, or `refuse` with its error. Errors other
        than `InputError` are then raised by `process`, too: they are bugs.
        """
        if not self._isClosed:
            self._waiting.append((work, take, refuse))
            self._startNext()
            self.began.emit()

    def later(self, slice_: Callable[[], object]) -> None:
        """Have a later `process` call a function on the main thread, one each time."""
        if not self._isClosed:
            self._slices.append(slice_)
            self.began.emit()

    def changeScene(self, change: Callable[[], object]) -> None:
        """Have a change made as by `later`, unless the scene is cleared before."""
        count = self._clearedCount
        self.later(lambda: change() if count == self._clearedCount else None)

    def forgetScene(self) -> None:
        self._clearedCount += 1

    def yieldTime(self) -> None:
        """Let running work continue for a moment, unless functions are postponed."""
        if self._underWay is not None and not self._slices:
            self._underWay[0].thread.join(TIME_S)

    def process(self) -> None:
        """Call one postponed function, or deliver a finished result."""
        try:
            if self._slices:
                self._slices.popleft()()
            elif self._underWay is not None and self._underWay[0].isDone:
                job, take, refuse = self._underWay
                self._underWay = None
                try:
                    result = job.outcome.result()
                except Exception as error:
                    refuse(error)
                    if not isinstance(error, InputError):
                        raise
                else:
                    take(result)
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
        job.thread.join(CLOSING_S)
        self.process()
        if self._underWay is not None:
            self._isLeft.set()
            job.thread.join(LEAVING_S)
            job.leave()
            self._underWay = None

    def _startNext(self) -> None:
        """Start waiting work after postponed functions: both at once would share Python's lock."""
        if self._waiting and self._underWay is None and not self._slices:
            work, take, refuse = self._waiting.popleft()
            self._underWay = Job(work), take, refuse


def inBackground(work: Callable[[Progress], T], progress: Progress) -> T:
    """Return what `work` returns, calling `progress` many times a second meanwhile.

    `work` is called with a function to report its progress to. `progress` may let the application
    draw, and may raise to cancel: then the worker's reports raise, too.
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
            job.thread.join(TIME_S)
    except BaseException:
        isCanceled.set()
        job.leave()
        raise
    return job.outcome.result()


class CancelableUntilBegun:
    """Lets the user cancel until the work begins to change something."""

    def __init__(self, progress: Progress) -> None:
        """`progress` raises to cancel, as for `inBackground`."""
        self._progress = progress
        self._decision = threading.Lock()

    def begin(self) -> None:
        """Note, in the worker, that canceling is over; raise if the work was canceled."""
        if not self._decision.acquire(blocking=False):
            raise AbandonedWorkError

    def progress(self, step: str, share: float) -> None:
        """Report to `progress`; its errors are passed on only before `begin`."""
        try:
            self._progress(step, share)
        except Exception:
            if self._decision.acquire(blocking=False):
                raise


class AbandonedWorkError(Exception):
    """The result of the work is no longer needed."""
