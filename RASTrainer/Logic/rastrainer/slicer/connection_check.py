"""Tests once who answers at an address, where no connection is wanted."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer.errors import InputError
from rastrainer.slicer.contained import Contained
from rastrainer.slicer.heartbeat import LinkStatus, judgeFinding, lookingAt
from rastrainer.slicer.probe import Probe
from rastrainer.slicer.translation import _


class ConnectionCheck:
    """The latest test; a new one takes the place of one that is still under way."""

    def __init__(self, contained: Contained, clock: Callable[[], float]) -> None:
        self._contained = contained
        self._clock = clock
        self._probe: Probe | None = None
        self._address = ""
        self._onFound: Callable[[LinkStatus], None] = lambda _status: None

    def begin(self, host: str, port: int, onFound: Callable[[LinkStatus], None]) -> LinkStatus:
        """Begin to ask; `onFound` is called by a later `process`. Return what to say meanwhile."""
        if self._probe is not None:
            self._probe.close()
        self._probe = Probe(host, port, self._clock)
        self._address = f"{host}:{port}"
        self._onFound = onFound
        return lookingAt(self._address)

    def process(self) -> None:
        """Tell who answers, once that is known."""
        finding = None if self._probe is None else self._probe.process()
        if finding is not None:
            self._probe = None
            status = judgeFinding(finding, self._address)
            self._contained.run("The test of a connection", self._onFound, status)


def checkedAddress(host: str, port: int) -> tuple[str, int]:
    """Return an address that can be asked.

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
