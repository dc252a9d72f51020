"""Tests what answers at an address: until it is a simulator, or once."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer.errors import InputError
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.heartbeat import LinkStatus, judgeFinding, lookingAt
from rastrainer.slicer.link.peer import Peer, ProbeResult
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.signal import ErrorGuard
from rastrainer.slicer.translation import _

RETRY_S = 1.0
RETRY_OTHER_S = 5.0
"""Seconds until the next question: soon where a simulator may just be starting, later where
another program answers."""


class SimulatorSearch:
    """A search, from `begin` until a simulator of our version is found.

    Attributes:
        finding: the latest answer; None as long as there is none.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self.finding: ProbeResult | None = None
        self._clock = clock
        self._probe: Probe | None = None
        self._next = 0.0

    def begin(self) -> None:
        """Forget the last finding, and test at once."""
        self.end()
        self.finding = None
        self._next = self._clock()

    def end(self) -> None:
        """Stop testing."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None

    def process(self, host: str, port: int) -> ProbeResult | None:
        """Test when it is due; return the simulator that has just answered, else None."""
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


class ConnectionCheck:
    """The latest test; a new one takes the place of one that is still under way."""

    def __init__(self, guard: ErrorGuard, clock: Callable[[], float]) -> None:
        self._guard = guard
        self._clock = clock
        self._probe: Probe | None = None
        self._address = ""
        self._onFound: Callable[[LinkStatus], None] = lambda _status: None

    def begin(self, host: str, port: int, onFound: Callable[[LinkStatus], None]) -> LinkStatus:
        """Start a test; a later `process` calls `onFound`. Return the status to show meanwhile."""
        if self._probe is not None:
            self._probe.close()
        self._probe = Probe(host, port, self._clock)
        self._address = f"{host}:{port}"
        self._onFound = onFound
        return lookingAt(self._address)

    def process(self) -> None:
        """Report what answers when that is known."""
        finding = None if self._probe is None else self._probe.process()
        if finding is not None:
            self._probe = None
            status = judgeFinding(finding, self._address)
            self._guard.run("The test of a connection", self._onFound, status)


def checkedAddress(host: str, port: int) -> tuple[str, int]:
    """Return a valid address.

    Raises:
        InputError: no host, or a port that is none.
    """
    if not host.strip():
        raise InputError(_("Enter the host of the simulator, such as 127.0.0.1."))
    checkPort(port)
    return host.strip(), port


def checkPort(port: int) -> None:
    """Raise `InputError` if the port is none."""
    if not 0 < port < 65536:
        raise InputError(_("The port must be a number from 1 to 65535."))
