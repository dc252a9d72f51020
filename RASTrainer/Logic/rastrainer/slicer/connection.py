"""Keeps one connector in the scene and connected, and knows how the simulator is.

The scene may be cleared of the connector, the simulator restarted, the line cut without a word:
`follow`, which is called about ten times a second, finds out and makes it good.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import vtk

from rastrainer.protocol import Device
from rastrainer.slicer.connector_kit import ConnectorKit
from rastrainer.slicer.heartbeat import (
    RECONNECT_AFTER_S,
    LinkObservation,
    LinkStatus,
    judge,
    notInstalled,
)
from rastrainer.slicer.link_nodes import findIncomingNode

CONNECTOR_NAME = "RASTrainerLink"


class Connection:
    """One connection to a simulator, for as long as it is wanted.

    Attributes:
        kit: what the connector and its commands are made with; None where it is not installed.
        connector: the connector in the scene; None while no connection is wanted.
        isOpen: there is a TCP connection.
        peerVersion: version of the simulator's protocol; None as long as it is not known.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        onCommand: Callable[[str, str], None],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`onCommand(name, content)` is called from inside VTK: it must not raise."""
        self.kit: ConnectorKit | None = None
        self.connector: Any | None = None
        self.isOpen = False
        self.peerVersion: int | None = None
        self._scene = scene
        self._findKit = findKit
        self._onCommand = onCommand
        self._clock = clock
        self._observerTag = 0
        self._address: tuple[str, int] | None = None
        self._isListening = False
        self._isHeard = False
        self._lastSign = 0.0
        self._heartbeatTime: int | None = None

    @property
    def status(self) -> LinkStatus:
        """How the connection is, in words."""
        if self._address is not None and self.kit is None:
            return notInstalled()
        host, port = self._address or ("", 0)
        return judge(
            LinkObservation(
                address=f"{host}:{port}",
                isWanted=self._address is not None,
                isListening=self._isListening,
                isOpen=self.isOpen,
                silenceS=self._clock() - self._lastSign,
                isHeard=self._isHeard,
                peerVersion=self.peerVersion,
            )
        )

    def begin(self, address: tuple[str, int], isListening: bool) -> None:
        """Want a connection: to the address, or from whoever connects to its port."""
        self.end()
        self.kit = self._findKit()
        self._address = address
        self._isListening = isListening

    def end(self) -> None:
        """Want no connection any more."""
        self._address = None
        self._dropConnector()

    def follow(self) -> bool:
        """Make good what was lost; return whether the connection has just been opened."""
        if self._address is None or self.kit is None:
            return False
        self._keepConnector()
        wasOpen = self.isOpen
        self.isOpen = self.connector.GetState() == self.connector.StateConnected
        if not self.isOpen:
            return False
        if not wasOpen:
            self._isHeard = False
            self.peerVersion = None
            self._lastSign = self._clock()
        self._hearHeartbeat()
        if self._clock() - self._lastSign > RECONNECT_AFTER_S:
            # Half-open: nothing will ever come over this connection again, if anything ever did.
            self.connector.Stop()
            self.connector.Start()
            self.isOpen = False
        return self.isOpen and not wasOpen

    def _keepConnector(self) -> None:
        if self.connector is not None and self.connector.GetScene() is not None:
            return
        self._dropConnector()
        self.connector = self.kit.makeConnector()
        self.connector.SetName(CONNECTOR_NAME)
        self.connector.SetSaveWithScene(False)
        self._scene.AddNode(self.connector)
        self._observerTag = self.connector.AddObserver(
            self.connector.CommandReceivedEvent, self._onCommandReceived
        )
        host, port = self._address
        if self._isListening:
            self.connector.SetTypeServer(port)
        else:
            self.connector.SetTypeClient(host, port)
        self.connector.Start()

    def _dropConnector(self) -> None:
        if self.connector is None:
            return
        self.connector.RemoveObserver(self._observerTag)
        self.connector.Stop()
        if self.connector.GetScene() is not None:
            self._scene.RemoveNode(self.connector)
        self.connector = None
        self.isOpen = False
        self._heartbeatTime = None

    def _hearHeartbeat(self) -> None:
        node = findIncomingNode(self.connector, Device.SIM_SERVER)
        if node is None or node.GetMTime() == self._heartbeatTime:
            return
        self._heartbeatTime = node.GetMTime()
        self._isHeard = True
        self._lastSign = self._clock()
        self.peerVersion = node.GetSubCode()

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _onCommandReceived(self, _caller: Any, _event: str, command: Any) -> None:
        self._onCommand(command.GetName(), command.GetCommandContent())
