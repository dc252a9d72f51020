"""Finished trials are offered to every client until one of them acknowledges them."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from rastrainer.igtl.command import Command
from rastrainer.igtl.message import Message
from rastrainer.protocol import CommandName, Device
from rastrainer_simulator.igtl.connection import Connection
from rastrainer_simulator.igtl.outgoing import Outgoing

_MOST_AT_ONCE = 8
_LARGEST_NUMBER = 2**32


class TrialOffers:
    """The trials that nobody has acknowledged yet, oldest first.

    Clients keep trials by their UUID, so an offer that arrives twice does no harm.
    """

    def __init__(self, clients: Callable[[], Iterable[Connection]]):
        self._clients = clients
        self._records: dict[str, Mapping[str, Any]] = {}
        self._numbers = itertools.count(1)

    def add(self, record: Mapping[str, Any]) -> None:
        """Offer a trial's record at once, and from then on with `repeat`."""
        self._records[record["trialId"]] = record
        self._offer([record])

    def remove(self, trial_id: str) -> None:
        """Offer a trial no more."""
        self._records.pop(trial_id, None)

    def repeat(self) -> None:
        """Offer the oldest again; the others follow as these are acknowledged."""
        self._offer(itertools.islice(self._records.values(), _MOST_AT_ONCE))

    def _offer(self, records: Iterable[Mapping[str, Any]]) -> None:
        for record in records:
            number = next(self._numbers) % _LARGEST_NUMBER
            body = json.dumps(record, allow_nan=False)
            command = Command(number, CommandName.TRIAL_COMPLETED, body)
            offer = Outgoing(Message(Device.COMMAND, command))
            for connection in self._clients():
                connection.send(offer)
