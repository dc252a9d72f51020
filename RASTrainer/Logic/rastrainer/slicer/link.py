"""The link to the simulator: one class for desktop Slicer and for the headless side.

Everything happens in `process`, which the host calls about ten times a second: nodes are polled
rather than observed, since any of them may be deleted at any time.
"""

from __future__ import annotations

import json
import logging
import time
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import (
    DEFAULT_HOST,
    DEFAULT_PORT,
    PROTOCOL_VERSION,
    CommandName,
    Device,
    check_arguments,
    decode_json_object,
)
from rastrainer.slicer.connection import Connection
from rastrainer.slicer.connector_kit import ConnectorKit
from rastrainer.slicer.heartbeat import LinkState, LinkStatus
from rastrainer.slicer.link_nodes import capturedPointsNode, prepareNodes, simStateNode
from rastrainer.slicer.pending_commands import OnReply, PendingCommands
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _


class Link:
    """Sends commands, and hands over what the simulator tells.

    Attributes:
        statusChanged: emits the new `LinkStatus`.
        opened: emits nothing, after each greeting that the simulator has answered.
        pointsChanged: emits the list of touched points (`vtkMRMLMarkupsFiducialNode`).
        stateChanged: emits what `SimState` says, a dict.
        trialCompleted: emits the record that the simulator delivers, a dict not yet checked.
        stepAnswered: emits the answers to a questionnaire of a study, a dict not yet checked.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        client: str = "3D Slicer",
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.statusChanged = Signal()
        self.opened = Signal()
        self.pointsChanged = Signal()
        self.stateChanged = Signal()
        self.trialCompleted = Signal()
        self.stepAnswered = Signal()
        self._scene = scene
        self._client = client
        # From inside VTK nothing may raise: commands are kept here until `process`.
        self._received: deque[tuple[str, str]] = deque()
        self._connection = Connection(
            scene, findKit, lambda *command: self._received.append(command), clock
        )
        self._pending = PendingCommands(clock)
        self._preparedConnector: Any | None = None
        self._points: tuple = ()
        self._stateText = ""
        self._status = self._connection.status

    @property
    def status(self) -> LinkStatus:
        """The state of the link in words, as of the last `process`."""
        return self._status

    @property
    def isOpen(self) -> bool:
        """Whether there is a connection."""
        return self._connection.isOpen

    @property
    def connector(self) -> Any | None:
        """The connector; a host without Slicer's timer calls its `PeriodicProcess`."""
        return self._connection.connector

    def connectTo(self, host: str = DEFAULT_HOST, port: int = DEFAULT_PORT) -> None:
        """Connect to a simulator, and again whenever the connection is lost.

        Raises:
            InputError: no host, or a port that is none.
        """
        if not host.strip():
            raise InputError(_("Enter the host of the simulator, such as 127.0.0.1."))
        self._begin((host.strip(), port), isListening=False)

    def listenOn(self, port: int = DEFAULT_PORT) -> None:
        """Wait for a simulator that was started with `--connect`.

        Raises:
            InputError: a port that is none.
        """
        self._begin(("", port), isListening=True)

    def disconnect(self) -> None:
        """Close the connection and stay without one."""
        self._connection.end()
        self.process()

    def send(
        self,
        name: str,
        arguments: Mapping[str, Any] | None = None,
        onReply: OnReply = lambda _reply: None,
        timeoutS: float = 5.0,
    ) -> None:
        """Send a command; `onReply` is called by a later `process`, exactly once.

        Raises:
            InputError: the command or its arguments are not those of the protocol.
        """
        check_arguments(name, arguments or {})
        status = self._connection.status
        if not self.isOpen or status.state is LinkState.WRONG_VERSION:
            self._pending.refuse(onReply, status.sentence)
            return
        command = self._connection.kit.makeCommand()
        command.SetName(name)
        command.SetCommandContent(json.dumps(dict(arguments or {}), allow_nan=False))
        command.SetTimeoutSec(timeoutS)
        self._pending.send(self._connection.connector, command, onReply)

    def process(self) -> None:
        """Do what is due: connect, judge the heartbeat, hand over what has arrived."""
        if self._scene.IsBatchProcessing():
            return
        if self._connection.follow():
            self._sayHello()
        if self.connector is not self._preparedConnector:
            self._preparedConnector = self.connector
            if self.connector is not None:
                prepareNodes(self._scene)
        self._tellStatus()
        self._pending.poll(self.isOpen)
        if self.connector is not None:
            self._handOverNodes()
        self._handOverCommands()

    def _begin(self, address: tuple[str, int], isListening: bool) -> None:
        if not 0 < address[1] < 65536:
            raise InputError(_("The port must be a number from 1 to 65535."))
        self._connection.begin(address, isListening)
        self.process()

    def _sayHello(self) -> None:
        def welcome(reply: Reply) -> None:
            version = reply.data.get("protocolVersion")
            if isinstance(version, int):
                self._connection.peerVersion = version
            if reply.ok:
                self.opened.emit()

        hello = {"protocolVersion": PROTOCOL_VERSION, "client": self._client}
        self.send(CommandName.HELLO, hello, welcome)

    def _tellStatus(self) -> None:
        status = self._connection.status
        if status != self._status:
            self._status = status
            self.statusChanged.emit(status)

    def _handOverNodes(self) -> None:
        pointsNode = capturedPointsNode(self._scene)
        points = _snapshot(pointsNode)
        if points != self._points:
            self._points = points
            self.pointsChanged.emit(pointsNode)
        text = simStateNode(self._scene).GetText() or ""
        if text and text != self._stateText:
            self._stateText = text
            self._handOver(text, Device.SIM_STATE, self.stateChanged)

    def _handOverCommands(self) -> None:
        signals = {
            CommandName.TRIAL_COMPLETED: self.trialCompleted,
            CommandName.STEP_ANSWERED: self.stepAnswered,
        }
        while self._received:
            name, content = self._received.popleft()
            if name in signals:
                self._handOver(content, name, signals[name])
            else:
                logging.warning("The simulator sent the unknown command %s.", name)

    def _handOver(self, text: str, name: str, signal: Signal) -> None:
        try:
            value = decode_json_object(text)
        except InputError as error:
            logging.error("What came as %s cannot be read: %s", name, error)
            return
        signal.emit(value)


def _snapshot(markupsNode: Any) -> tuple:
    return tuple(
        (markupsNode.GetNthControlPointLabel(i), tuple(markupsNode.GetNthControlPointPosition(i)))
        for i in range(markupsNode.GetNumberOfControlPoints())
    )
