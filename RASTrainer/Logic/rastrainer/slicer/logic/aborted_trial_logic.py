"""What happens when an aborted trial arrives: it is stored, and acknowledged."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.delivery_queue import Delivery, DeliveryQueue
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.aborted_trials import AbortedTrials
from rastrainer.study.database.study import Study
from rastrainer.trial.aborted_trial import AbortedTrial


class AbortedTrialLogic:
    """Stores the aborted trials of a link.

    After a break in the connection, an aborted trial arrives before its repeat. It must be stored
    before it, too: a repeat counts in a study only once a reason was given for it.

    Attributes:
        kept: emits each received `AbortedTrial` once it is in the study.
        problemFound: emits a sentence about one that could not be stored.
    """

    def __init__(self, link: Link, openStudy: Callable[[], Study], work: BackgroundWork) -> None:
        """Receive the trials of a link.

        Args:
            link: to the simulator.
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
            self.kept.emit,
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

    def _keep(self, delivery: Delivery) -> AbortedTrial:
        record = AbortedTrial.from_json(delivery)
        with self._openStudy() as study:
            AbortedTrials(study).add(record, delivery)
        return record
