"""Asks who answers at an address, again and again, until it is a simulator."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.finding import Finding, Peer
from rastrainer.slicer.probe import Probe

RETRY_S = 1.0
RETRY_OTHER_S = 5.0
"""Seconds until the next question: soon where a simulator may just be starting, later where
somebody else answers."""


class SimulatorSearch:
    """A search, from `begin` until a simulator of our version is found.

    Attributes:
        finding: the latest answer; None as long as there is none.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.finding: Finding | None = None
        self._clock = clock
        self._probe: Probe | None = None
        self._next = 0.0

    def begin(self) -> None:
        """Forget what was found, and ask at once."""
        self.end()
        self.finding = None
        self._next = self._clock()

    def end(self) -> None:
        """Ask no more."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None

    def process(self, host: str, port: int) -> Finding | None:
        """Ask where it is due; return the simulator that has just answered, else None."""
        if self._probe is None:
            if self._clock() < self._next:
                return None
            self._probe = Probe(host, port, self._clock)
        finding = self._probe.process()
        if finding is None:
            return None
        self._probe = None
        self.finding = finding
        isSoon = finding.peer in (Peer.NOBODY, Peer.SILENT, Peer.SIMULATOR)
        self._next = self._clock() + (RETRY_S if isSoon else RETRY_OTHER_S)
        isOurs = finding.peer is Peer.SIMULATOR and finding.version == PROTOCOL_VERSION
        return finding if isOurs else None
