"""What happens when an aborted trial arrives: kept in the background, then acknowledged.

As with finished trials nothing is lost and nothing counts twice: the simulator offers it until it
is acknowledged, and it is acknowledged only when it is in the study.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.aborted_trial import AbortedTrial
from rastrainer.protocol import CommandName
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.study import DeletedTrialError, Study
from rastrainer.study_aborted import AbortedTrials

MOST_WAITING = 32
"""Trials that wait to be kept; a simulator that has more offers them again."""


class AbortedDesk:
    """Takes in the aborted trials that a link hands over.

    Attributes:
        kept: emits each `AbortedTrial` that comes in, once it is in the study.
        problemFound: emits a sentence about one that could not be kept.
    """

    def __init__(self, link: Link, openStudy: Callable[[], Study], work: BackgroundWork) -> None:
        """Take in the trials of a link.

        Args:
            link: to the simulator.
            openStudy: opens the study, in any thread; it may wait for a lock there.
            work: in which trials are kept.
        """
        self.kept = Signal()
        self.problemFound = Signal()
        self._link = link
        self._openStudy = openStudy
        self._work = work
        self._waiting: deque[Mapping[str, Any]] = deque()
        self._isTaking = False
        self._lastProblem = ""
        link.trialAborted.connect(self._receive)

    def close(self) -> None:
        """Listen to the link no more, and begin nothing more."""
        self._link.trialAborted.disconnect(self._receive)
        self.forgetWaiting()

    def forgetWaiting(self) -> None:
        """Leave undone what has not begun: the simulator offers it again, for another study."""
        self._waiting.clear()

    def _receive(self, value: Mapping[str, Any]) -> None:
        isKnown = any(waiting.get("trialId") == value.get("trialId") for waiting in self._waiting)
        if not isKnown and len(self._waiting) < MOST_WAITING:
            self._waiting.append(value)
            self._takeNext()

    def _takeNext(self) -> None:
        if self._isTaking or not self._waiting:
            return
        self._isTaking = True
        value = self._waiting[0]
        self._work.do(
            lambda: self._keep(value),
            lambda record: self._finish(value, lambda: self._accept(record)),
            lambda error: self._finish(value, lambda: self._refuse(value, error)),
        )

    def _keep(self, value: Mapping[str, Any]) -> AbortedTrial:
        record = AbortedTrial.from_json(value)
        with self._openStudy() as study:
            AbortedTrials(study).add(value)
        return record

    def _finish(self, value: Mapping[str, Any], go: Callable[[], None]) -> None:
        self._isTaking = False
        if self._waiting and self._waiting[0] is value:
            self._waiting.popleft()
        try:
            go()
        finally:
            self._takeNext()

    def _accept(self, record: AbortedTrial) -> None:
        self._acknowledge(record.trial_id)
        self.kept.emit(record)

    def _refuse(self, value: Mapping[str, Any], error: Exception) -> None:
        if isinstance(error, DeletedTrialError):
            # Its trainee is gone for good: it must not be offered for ever.
            self._acknowledge(value["trialId"])
            return
        sentence = _("An aborted trial could not be kept: {error}").format(error=error)
        if sentence != self._lastProblem:
            self._lastProblem = sentence
            self.problemFound.emit(sentence)

    def _acknowledge(self, trialId: str) -> None:
        self._link.send(CommandName.ACKNOWLEDGE_TRIAL, {"trialId": trialId})
