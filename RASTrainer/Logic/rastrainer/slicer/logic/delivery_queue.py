"""Trials that the simulator delivers: stored in the background, in their order, and acknowledged.

Nothing is lost and nothing counts twice: the simulator offers a trial until it is acknowledged, and
it is acknowledged only when it is in the study. For an aborted trial that is all.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.json_records import record_from_json
from rastrainer.slicer.logic.trial_services import Steps, TrialServices
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.study import DeletedTrialError
from rastrainer.trial.aborted_trial import AbortedTrial

Delivery = Mapping[str, Any]
"""The record of a trial as it was delivered, not yet checked."""

Heard = tuple[Signal, Callable[..., Any]]
"""A signal and what listens to it."""

MAX_WAITING = 32
"""Most trials waiting to be stored; a simulator that has more offers them again."""


class DeliveryQueue(Listening):
    """Stores the trials that a signal of the link delivers, in their order.

    Attributes:
        problemFound: emits a sentence about a trial that was not stored, or not scored.
    """

    REFUSAL = ""
    """Sentence about a trial that was not stored, with a place for its `{error}`."""
    TOO_MANY = ""
    """Sentence where too many trials wait; without it nothing is said."""
    IN_TURN = True
    """Whether a trial waits until the previous one is accepted; otherwise all are stored before
    anything that arrives later."""

    def __init__(self, services: TrialServices, delivered: Signal, *others: Heard) -> None:
        super().__init__((delivered, self._receive), *others)
        self.problemFound = Signal()
        self._services = services
        self._waiting: deque[Delivery] = deque()
        self._underWay: list[Delivery] = []
        self._lastProblem = ""

    def close(self) -> None:
        super().close()
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Drop what has not started: the simulator offers it again, for another study."""
        self._waiting.clear()
        self._lastProblem = ""

    def report(self, sentence: str) -> None:
        """Report a problem once, though the trial is offered every two seconds."""
        if sentence and sentence != self._lastProblem:
            self._lastProblem = sentence
            self.problemFound.emit(sentence)

    def _store(self, delivery: Delivery) -> Any:
        """Store a trial; called in the background."""
        raise NotImplementedError

    def _accept(self, stored: Any) -> None:
        """Take what `_store` has returned, after the trial was acknowledged."""
        raise NotImplementedError

    def _receive(self, delivery: Delivery) -> None:
        """Queue a delivered trial; the simulator offers a dropped one again."""
        known = (*self._underWay, *self._waiting)
        if any(each.get("trialId") == delivery.get("trialId") for each in known):
            return
        if len(known) >= MAX_WAITING:
            self.report(self.TOO_MANY)
            return
        self._waiting.append(delivery)
        self._storeNext()

    def _storeNext(self) -> None:
        if self._waiting and not (self._underWay and self.IN_TURN):
            self._underWay.append(self._waiting.popleft())
            self._services.converse(self._storing(self._underWay[-1]))

    def _storing(self, delivery: Delivery) -> Steps:
        def acknowledge() -> None:
            trial = {"trialId": delivery["trialId"]}
            self._services.link.send(CommandName.ACKNOWLEDGE_TRIAL, trial)

        try:
            stored = yield lambda: self._store(delivery)
        except DeletedTrialError:
            # Its trainee was deleted for good: it must not be offered forever.
            acknowledge()
        except Exception as error:
            self.report(self.REFUSAL.format(error=error))
        else:
            acknowledge()
            self._accept(stored)
        finally:
            self._underWay.remove(delivery)
            self._storeNext()


class AbortedTrialLogic(DeliveryQueue):
    """Stores the aborted trials of a link.

    After a break in the connection, an aborted trial arrives before its repeat. It must be stored
    before it, too: a repeat counts in a study only once a reason was given for it.

    Attributes:
        kept: emits each received `AbortedTrial` once it is in the study; nothing is stored of one
            in which nothing was done.
    """

    REFUSAL = _("An aborted trial could not be stored: {error}")
    IN_TURN = False

    def __init__(self, services: TrialServices) -> None:
        super().__init__(services, services.link.trialAborted)
        self.kept = Signal()

    def _store(self, delivery: Delivery) -> AbortedTrial:
        record = record_from_json(AbortedTrial, delivery)
        self._services.inStudy(lambda study: study.add_aborted(record, delivery))
        return record

    def _accept(self, stored: AbortedTrial) -> None:
        if stored.is_kept:
            self.kept.emit(stored)
