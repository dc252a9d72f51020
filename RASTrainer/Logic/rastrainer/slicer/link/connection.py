"""Keeps one connector in the scene and connected, and knows the state of the simulator.

The scene may be cleared of the connector, the simulator restarted, or the line cut silently:
`followConnection` notices and reconnects; it is to be called a second after the last time at the
latest, and soon after each event of the connector.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import slicer

from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.link.link_status import (
    RECONNECT_AFTER_S,
    LinkObservation,
    Peer,
    ProbeResult,
)
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.scene.nodes import ORIGINAL_NAME
from rastrainer.slicer.signal import Signal


class ConnectorKit(NamedTuple):
    """Makes a `vtkMRMLIGTLConnectorNode` and a `vtkSlicerOpenIGTLinkCommand`, or stand-ins."""

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
CONNECTOR_NAME = "RASTrainerLink"
NOWHERE = 0
"""The port that the connector is given once it is connected: no program can listen there. Otherwise
it would reconnect 0.1 s after a loss, perhaps to another program on that port."""
CONNECT_WITHIN_S = 1.0
"""How long the connector may connect to a simulator that has answered; then it is tested again."""
LONGEST_LOOK_S = 1.5
"""At most so much of the time since the last look counts as silence: while Slicer itself is held
up, such as by loading a volume, it hears no one."""


class SimulatorConnection:
    """One connection to a simulator, restored until `endConnection`.

    The connector is started only when a simulator has just answered, as anything else might end
    Slicer: see `rastrainer.slicer.link.probe`.

    Attributes:
        connector: the connector in the scene; None while there is no simulator to connect to.
        woken: emits nothing when there is something to do soon; perhaps from inside VTK.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        onCommandReceived: Callable[[Any, str, Any], None],
        clock: Callable[[], float],
    ) -> None:
        self.findKit = findKit
        self.connector: Any | None = None
        self.seen = LinkObservation()
        self.woken = Signal()
        self._scene = scene
        self._clock = clock
        self._onCommandReceived = onCommandReceived
        self._kit: ConnectorKit | None = None
        self._address = ("", 0)
        self._probe: Probe | None = None
        self._observerTags: list[int] = []
        self._nextProbe = self._connectsUntil = self._lastLook = 0.0
        self._heartbeatTime: int | None = None

    def beginConnection(self, address: tuple[str, int]) -> None:
        self.endConnection()
        self._kit = self.findKit()
        self._address = address
        self.seen = LinkObservation(f"{address[0]}:{address[1]}", isInstalled=self._kit is not None)

    def endConnection(self) -> None:
        self._searchAnew()
        self._dropConnector()
        self.seen = LinkObservation()

    def followConnection(self) -> bool:
        """Restore a lost connection; return whether it has just been opened."""
        if self._kit is None or not self.seen.address:
            return False
        wasOpen = self.seen.isOpen
        if self.connector is not None and self.connector.GetScene() is None:
            self._dropConnector()
            self._searchAnew()
        connector = self.connector
        if connector is None or connector.GetState() != connector.StateConnected:
            self.seen.isOpen = False
            if wasOpen or self._clock() >= self._connectsUntil:
                self._connect(isLost=wasOpen)
            return False
        if not wasOpen:
            self.seen.isOpen, self.seen.hasHeartbeat = True, False
            self.seen.peerVersion, self.seen.silenceS = None, 0.0
            self._lastLook = self._connectsUntil = self._clock()
            connector.SetServerPort(NOWHERE)
        now = self._clock()
        self.seen.silenceS += min(now - self._lastLook, LONGEST_LOOK_S)
        self._lastLook = now
        for index in range(connector.GetNumberOfIncomingMRMLNodes()):
            node = connector.GetIncomingMRMLNode(index)
            if node is None or node.GetAttribute(ORIGINAL_NAME) != DeviceName.SIM_SERVER:
                continue
            if node.GetMTime() != self._heartbeatTime:
                self._heartbeatTime = node.GetMTime()
                self.seen.hasHeartbeat = True
                self.seen.silenceS = 0.0
                self.seen.peerVersion = node.GetSubCode()
        if self.seen.silenceS > RECONNECT_AFTER_S:
            # Half-open: nothing will ever come over this connection again, if anything ever did.
            connector.Stop()
            self._searchAnew()
            self.seen.isOpen = False
        return self.seen.isOpen and not wasOpen

    def _connect(self, isLost: bool) -> None:
        """Let the connector connect; only to a simulator, so search for one first."""
        host, port = self._address
        if self.connector is not None:
            self.connector.SetServerPort(NOWHERE)
        if isLost:
            self._searchAnew()
        found = self._search(host, port)
        if found is None:
            return
        if self.connector is not None and self.connector.GetServerHostname() != found.ip:
            self._dropConnector()
        connector = self.connector or self._makeConnector()
        if connector.GetState() == connector.StateOff:
            connector.SetTypeClient(found.ip, port)
            connector.Start()
        else:
            # `Stop` would block as long as 0.1 s, and the connector retries automatically.
            connector.SetServerPort(port)
        self._connectsUntil = self._clock() + CONNECT_WITHIN_S

    def _searchAnew(self) -> None:
        """Forget who answered, and test at once."""
        if self._probe is not None:
            self._probe.close()
            self._probe = None
        self.seen.finding = None
        self._nextProbe = self._clock()

    def _search(self, host: str, port: int) -> ProbeResult | None:
        """Test when it is due; return the simulator of our version that has just answered."""
        if self._probe is None:
            if self._clock() < self._nextProbe:
                return None
            self._probe = Probe(host, port, self._clock)
        finding = self._probe.process()
        if finding is None:
            return None
        self._probe = None
        self.seen.finding = finding
        isSoon = finding.peer in (Peer.UNREACHABLE, Peer.SILENT, Peer.SIMULATOR)
        self._nextProbe = self._clock() + (RETRY_S if isSoon else RETRY_OTHER_S)
        isOurs = finding.peer is Peer.SIMULATOR and finding.version == PROTOCOL_VERSION
        return finding if isOurs else None

    def _makeConnector(self) -> Any:
        assert self._kit is not None
        self.connector = connector = self._kit.makeConnector()
        connector.SetName(CONNECTOR_NAME)
        connector.SetSaveWithScene(False)
        self._scene.AddNode(connector)
        self._observerTags = [
            connector.AddObserver(connector.CommandReceivedEvent, self._onCommandReceived),
            *(
                connector.AddObserver(event, lambda *_event: self.woken.emit())
                for event in (connector.ConnectedEvent, connector.DisconnectedEvent)
            ),
        ]
        return connector

    def _dropConnector(self) -> None:
        self.seen.isOpen = False
        self._connectsUntil = self._clock()
        if self.connector is None:
            return
        for tag in self._observerTags:
            self.connector.RemoveObserver(tag)
        self.connector.Stop()
        if self.connector.GetScene() is not None:
            self._scene.RemoveNode(self.connector)
        self.connector = self._heartbeatTime = None
