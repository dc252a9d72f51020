"""Finished and aborted trials are offered to every client until one of them acknowledges them."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Sequence

from rastrainer.aborted_trial import AbortedTrial
from rastrainer.igtl.command import Command
from rastrainer.igtl.message import Message
from rastrainer.protocol import CommandName, Device
from rastrainer.trial_record import TrialRecord
from rastrainer_simulator.igtl.connection import Connection
from rastrainer_simulator.igtl.outgoing import Outgoing

MOST_AT_ONCE = 8
"""Trials in one round of offers."""

_NUMBERS = 2**32


class TrialOffers:
    """Offers the trials that nobody has acknowledged.

    Clients keep trials by their UUID, so an offer that arrives twice does no harm.
    """

    def __init__(
        self,
        unacknowledged: Callable[[], Sequence[AbortedTrial | TrialRecord]],
        clients: Callable[[], Iterable[Connection]],
    ):
        """`unacknowledged` gives the records that wait, oldest first; `clients` who is there."""
        self._unacknowledged = unacknowledged
        self._clients = clients
        self._numbers = itertools.count(1)
        self._start = 0

    def offer_newest(self) -> None:
        """Offer the trial that was registered last, or the one aborted last where none was."""
        self._offer(self._unacknowledged()[-1:])

    def repeat(self) -> None:
        """Offer some again, others in the next round, so that none holds up the rest."""
        records = tuple(self._unacknowledged())
        start = self._start if self._start < len(records) else 0
        self._offer((records[start:] + records[:start])[:MOST_AT_ONCE])
        self._start = start + MOST_AT_ONCE if len(records) > MOST_AT_ONCE else 0

    def _offer(self, records: Iterable[AbortedTrial | TrialRecord]) -> None:
        for record in records:
            body = json.dumps(record.to_json(), allow_nan=False)
            number = next(self._numbers) % _NUMBERS
            is_aborted = isinstance(record, AbortedTrial)
            name = CommandName.TRIAL_ABORTED if is_aborted else CommandName.TRIAL_COMPLETED
            command = Command(number, name, body)
            offer = Outgoing(Message(Device.COMMAND, command))
            for connection in self._clients():
                connection.send(offer)
