"""Trials that the simulator delivers: stored in the background, in their order, and acknowledged.

Nothing is lost and nothing counts twice: the simulator offers a trial until it is acknowledged, and
it is acknowledged only when it is in the study. For an aborted trial that is all.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, Generic, TypeVar

from rastrainer.commands import CommandName
from rastrainer.json_records import record_from_json
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.study import DeletedTrialError, Study
from rastrainer.trial.aborted_trial import AbortedTrial

T = TypeVar("T")
Delivery = Mapping[str, Any]
"""The record of a trial as it was delivered, not yet checked."""

MAX_WAITING = 32
"""Most trials waiting to be stored; a simulator that has more offers them again."""


class DeliveryQueue(Generic[T]):
    """Stores the trials that a signal delivers, in their order.

    Attributes:
        problemFound: emits a sentence about a trial that was not stored, or not scored.
    """

    def __init__(
        self,
        link: Link,
        delivered: Signal,
        work: BackgroundWork,
        store: Callable[[Delivery], Callable[[], T]],
        accept: Callable[[T], None],
        refusal: str,
        tooMany: str = "",
        inTurn: bool = True,
    ) -> None:
        """Receive what is delivered from now on.

        Args:
            delivered: signal of the link that emits each delivery.
            work: in which trials are stored.
            store: returns what stores a delivery, called in the background.
            accept: is given what that has returned, after the trial was acknowledged.
            refusal: sentence about a trial that was not stored, with a place for its `{error}`.
            tooMany: sentence where too many trials wait; without it nothing is said.
            inTurn: whether one is stored only after the one before was accepted; otherwise all are
                stored before whatever is received after them.
        """
        self.problemFound = Signal()
        self._link = link
        self._delivered = delivered
        self._work = work
        self._store = store
        self._accept = accept
        self._refusal = refusal
        self._tooMany = tooMany
        self._inTurn = inTurn
        self._waiting: deque[Delivery] = deque()
        self._underWay: list[Delivery] = []
        self._lastProblem = ""
        delivered.connect(self._receive)

    def close(self) -> None:
        """Stop listening to the link, and start nothing more."""
        self._delivered.disconnect(self._receive)
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Drop what has not started: the simulator offers it again, for another study."""
        self._waiting.clear()
        self._lastProblem = ""

    def isStoring(self, trialId: str) -> bool:
        return any(each.get("trialId") == trialId for each in self._underWay)

    def report(self, sentence: str) -> None:
        """Report a problem once, though the trial is offered every two seconds."""
        if sentence and sentence != self._lastProblem:
            self._lastProblem = sentence
            self.problemFound.emit(sentence)

    def _receive(self, delivery: Delivery) -> None:
        """Queue a delivered trial; what is dropped is offered again."""
        trialId = delivery.get("trialId")
        known = (*self._underWay, *self._waiting)
        if any(each.get("trialId") == trialId for each in known):
            return
        if len(known) >= MAX_WAITING:
            self.report(self._tooMany)
            return
        self._waiting.append(delivery)
        self._storeNext()

    def _storeNext(self) -> None:
        if not self._waiting or (self._underWay and self._inTurn):
            return
        delivery = self._waiting.popleft()
        self._underWay.append(delivery)
        self._work.do(
            self._store(delivery),
            lambda stored: self._finish(delivery, lambda: self._take(delivery, stored)),
            lambda error: self._finish(delivery, lambda: self._refuse(delivery, error)),
        )

    def _finish(self, delivery: Delivery, conclude: Callable[[], None]) -> None:
        self._underWay = [each for each in self._underWay if each is not delivery]
        try:
            conclude()
        finally:
            self._storeNext()

    def _take(self, delivery: Delivery, stored: T) -> None:
        self._acknowledge(delivery)
        self._accept(stored)

    def _refuse(self, delivery: Delivery, error: Exception) -> None:
        if isinstance(error, DeletedTrialError):
            # Its trainee was deleted for good: it must not be offered forever.
            self._acknowledge(delivery)
        else:
            self.report(self._refusal.format(error=error))

    def _acknowledge(self, delivery: Delivery) -> None:
        self._link.send(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": delivery["trialId"]})


class AbortedTrialLogic:
    """Stores the aborted trials of a link.

    After a break in the connection, an aborted trial arrives before its repeat. It must be stored
    before it, too: a repeat counts in a study only once a reason was given for it.

    Attributes:
        kept: emits each received `AbortedTrial` once it is in the study; nothing is stored of one
            in which nothing was done.
        problemFound: emits a sentence about one that could not be stored.
    """

    def __init__(self, link: Link, openStudy: Callable[[], Study], work: BackgroundWork) -> None:
        """Receive the trials of a link.

        Args:
            openStudy: opens the study, in any thread; it may wait for a lock there.
            work: in which trials are stored.
        """
        self.kept = Signal()
        self._openStudy = openStudy
        self._queue: DeliveryQueue[AbortedTrial] = DeliveryQueue(
            link,
            link.trialAborted,
            work,
            lambda delivery: lambda: self._keep(delivery),
            self._accept,
            _("An aborted trial could not be stored: {error}"),
            inTurn=False,
        )
        self.problemFound = self._queue.problemFound

    def close(self) -> None:
        """Stop listening to the link, and start nothing more."""
        self._queue.close()

    def forgetWaiting(self) -> None:
        """Drop what has not started: the simulator offers it again, for another study."""
        self._queue.forgetWaiting()

    def _accept(self, record: AbortedTrial) -> None:
        if record.is_kept:
            self.kept.emit(record)

    def _keep(self, delivery: Delivery) -> AbortedTrial:
        record = record_from_json(AbortedTrial, delivery)
        with self._openStudy() as study:
            study.add_aborted(record, delivery)
        return record
