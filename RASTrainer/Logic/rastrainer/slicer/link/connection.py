"""Keeps one connector in the scene and connected, and knows the state of the simulator.

The scene may be cleared of the connector, the simulator restarted, or the line cut silently:
`follow` notices and reconnects; it is to be called a second after the last time at the latest, and
soon after each event of the connector.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import slicer
import vtk

from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.link.link_status import (
    RECONNECT_AFTER_S,
    LinkObservation,
    LinkStatus,
    Peer,
    ProbeResult,
    judge,
    notInstalled,
)
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.scene.nodes import findIncomingNode


@dataclass(frozen=True)
class ConnectorKit:
    """Makes the two objects that the link talks to.

    Attributes:
        makeConnector: returns a new `vtkMRMLIGTLConnectorNode`, or a stand-in.
        makeCommand: returns a new `vtkSlicerOpenIGTLinkCommand`, or a stand-in.
    """

    makeConnector: Callable[[], Any]
    makeCommand: Callable[[], Any]


def desktopKit() -> ConnectorKit | None:
    if not hasattr(slicer, "vtkMRMLIGTLConnectorNode"):
        return None
    return ConnectorKit(slicer.vtkMRMLIGTLConnectorNode, slicer.vtkSlicerOpenIGTLinkCommand)


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

    @property
    def isTesting(self) -> bool:
        """Whether a test is under way."""
        return self._probe is not None

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


CONNECTOR_NAME = "RASTrainerLink"
NOWHERE = 0
"""The port that the connector is given once it is connected: no program can listen there. Otherwise
it would reconnect 0.1 s after a loss, to whatever has the simulator's port by then."""
CONNECT_WITHIN_S = 1.0
"""How long the connector may connect to a simulator that has answered; then it is tested again."""
LONGEST_LOOK_S = 1.5
"""At most so much of the time since the last look counts as silence: while Slicer itself is held
up, such as by loading a volume, it hears no one."""


class SlicerConnection:
    """One connection to a simulator, for as long as it is wanted.

    The connector is started only when a simulator has just answered, as anything else might end
    Slicer: see `rastrainer.slicer.link.probe`. A Slicer that listens cannot ask who will connect.

    Attributes:
        kit: what the connector and its commands are made with; None where it is not installed.
        connector: the connector in the scene; None while there is no simulator to connect to.
        isOpen: there is a TCP connection.
        peerVersion: version of the simulator's protocol; None as long as it is not known.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        onCommand: Callable[[str | bytes, str | bytes], None],
        onChange: Callable[[], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Prepare a connection.

        `onCommand(name, content)`, and `onChange()` once the connector has another state, are
        called from inside VTK: they must not raise.
        """
        self.kit: ConnectorKit | None = None
        self.connector: Any | None = None
        self.isOpen = False
        self.peerVersion: int | None = None
        self._scene = scene
        self._findKit = findKit
        self._onCommand = onCommand
        self._onChange = onChange
        self._clock = clock
        self._search = SimulatorSearch(clock)
        self._observerTags: list[int] = []
        self._address: tuple[str, int] | None = None
        self._isListening = False
        self._connectsUntil = 0.0
        self._hasHeartbeat = False
        self._silenceS = self._lastLook = 0.0
        self._heartbeatTime: int | None = None

    @property
    def isInstalled(self) -> bool:
        """Whether connectors can be made: the extension is installed."""
        return self._findKit() is not None

    @property
    def status(self) -> LinkStatus:
        """The state of the connection, in words."""
        if self._address is not None and self.kit is None:
            return notInstalled()
        host, port = self._address or ("", 0)
        return judge(
            LinkObservation(
                address=f"{host}:{port}",
                isWanted=self._address is not None,
                isListening=self._isListening,
                finding=self._search.finding,
                isOpen=self.isOpen,
                silenceS=self._silenceS,
                hasHeartbeat=self._hasHeartbeat,
                peerVersion=self.peerVersion,
            )
        )

    @property
    def isWanted(self) -> bool:
        return self._address is not None

    @property
    def isChanging(self) -> bool:
        """Whether its state will soon be another, such as that of a test of who answers."""
        if self._address is None or self.kit is None:
            return False
        if self.isOpen:
            return not self._hasHeartbeat
        return self._search.isTesting or self._clock() < self._connectsUntil

    def begin(self, address: tuple[str, int], isListening: bool) -> None:
        """Request a connection: to the address, or from any client of its port."""
        self.end()
        self.kit = self._findKit()
        self._address = address
        self._isListening = isListening
        self._search.begin()

    def end(self) -> None:
        """Stop requesting a connection."""
        self._address = None
        self._search.end()
        self._dropConnector()

    def follow(self) -> bool:
        """Restore what was lost; return whether the connection has just been opened."""
        if self._address is None or self.kit is None:
            return False
        wasOpen = self.isOpen
        if self.connector is not None and self.connector.GetScene() is None:
            self._dropConnector()
            self._search.begin()
        self.isOpen = (
            self.connector is not None
            and self.connector.GetState() == self.connector.StateConnected
        )
        if not self.isOpen:
            self._connect(*self._address, isLost=wasOpen)
            return False
        if not wasOpen:
            self._noteOpened()
        self._countSilence()
        if self._silenceS > RECONNECT_AFTER_S:
            # Half-open: nothing will ever come over this connection again, if anything ever did.
            if self.connector is not None:
                self.connector.Stop()
            self._search.begin()
            self.isOpen = False
        return self.isOpen and not wasOpen

    def _connect(self, host: str, port: int, isLost: bool) -> None:
        """Let the connector connect or listen; only to a simulator, so search for one first."""
        if self._clock() < self._connectsUntil and not isLost:
            return
        if self._isListening:
            self._listen(port)
            return
        if self.connector is not None:
            self.connector.SetServerPort(NOWHERE)
        if isLost:
            self._search.begin()
        finding = self._search.process(host, port)
        if finding is not None:
            self._connectTo(finding.ip, port)

    def _listen(self, port: int) -> None:
        connector = self.connector
        if connector is None:
            connector = self._makeConnector()
            connector.SetTypeServer(port)
        if connector.GetState() == connector.StateOff:
            connector.Start()
        self._connectsUntil = self._clock() + CONNECT_WITHIN_S

    def _connectTo(self, ip: str, port: int) -> None:
        if self.connector is not None and self.connector.GetServerHostname() != ip:
            self._dropConnector()
        connector = self.connector or self._makeConnector()
        if connector.GetState() == connector.StateOff:
            connector.SetTypeClient(ip, port)
            connector.Start()
        else:
            # `Stop` would block for as long as 0.1 s, and the connector retries automatically.
            connector.SetServerPort(port)
        self._connectsUntil = self._clock() + CONNECT_WITHIN_S

    def _noteOpened(self) -> None:
        """Note that a connection has just been opened."""
        self._hasHeartbeat = False
        self.peerVersion = None
        self._silenceS = 0.0
        self._lastLook = self._connectsUntil = self._clock()
        if self.connector is not None and not self._isListening:
            self.connector.SetServerPort(NOWHERE)

    def _makeConnector(self) -> Any:
        """Return a new connector in the scene; requires a kit."""
        assert self.kit is not None
        self.connector = connector = self.kit.makeConnector()
        connector.SetName(CONNECTOR_NAME)
        connector.SetSaveWithScene(False)
        self._scene.AddNode(connector)
        self._observerTags = [
            connector.AddObserver(connector.CommandReceivedEvent, self._onCommandReceived),
            *(
                connector.AddObserver(event, lambda *_event: self._onChange())
                for event in (connector.ConnectedEvent, connector.DisconnectedEvent)
            ),
        ]
        return connector

    def _dropConnector(self) -> None:
        self.isOpen = False
        self._connectsUntil = self._clock()
        if self.connector is None:
            return
        for tag in self._observerTags:
            self.connector.RemoveObserver(tag)
        self.connector.Stop()
        if self.connector.GetScene() is not None:
            self._scene.RemoveNode(self.connector)
        self.connector = None
        self._heartbeatTime = None

    def _countSilence(self) -> None:
        """Add the time since the last look to the silence; a new heartbeat ends it."""
        now = self._clock()
        self._silenceS += min(now - self._lastLook, LONGEST_LOOK_S)
        self._lastLook = now
        node = findIncomingNode(self.connector, DeviceName.SIM_SERVER)
        if node is None or node.GetMTime() == self._heartbeatTime:
            return
        self._heartbeatTime = node.GetMTime()
        self._hasHeartbeat = True
        self._silenceS = 0.0
        self.peerVersion = node.GetSubCode()

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onCommandReceived(self, _caller: Any, _event: str, command: Any) -> None:
        self._onCommand(command.GetName(), command.GetCommandContent())
