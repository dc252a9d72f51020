"""A stand-in of `vtkMRMLIGTLConnectorNode`, so that the link runs without desktop Slicer.

It makes the very nodes that the real connector makes, and has its oddities: the latest message of
a device wins, the order across devices is lost, time stamps are dropped, and a lost connection is
told only after the next one.
"""

from __future__ import annotations

import logging
import re
import threading
import time
from collections import deque
from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.igtl.checksum import crc64
from rastrainer.igtl.command import Command, CommandReply
from rastrainer.igtl.content import Status
from rastrainer.igtl.message import Header, Message, pack, unpack
from rastrainer.slicer.headless_command import HeadlessCommand
from rastrainer.slicer.incoming_nodes import NODE_CLASS, adoptOrCreateNode, updateNode
from rastrainer.slicer.link_nodes import ORIGINAL_NAME
from rastrainer.slicer.peer_sockets import PeerSockets

_INCOMING = "incoming"
_CRASHING_TYPE = re.compile(r"(GET|STT|STP|RTS)_")
_DEVICE_NAME_FIELD = slice(14, 34)

Raw = tuple[Header, bytes]


class HeadlessConnector(slicer.vtkMRMLScriptedModuleNode):
    """The part of the connector that we use; the host calls `PeriodicProcess` every few ms.

    Method names, constants and event numbers are those of the real class.
    """

    StateOff, StateWaitConnection, StateConnected = range(3)
    TypeNotDefined, TypeServer, TypeClient = range(3)
    ConnectedEvent = 118944
    DisconnectedEvent = 118945
    CommandReceivedEvent = 119001
    CommandResponseReceivedEvent = 119002
    CommandCompletedEvent = 119003

    def __init__(self) -> None:
        self.SetSaveWithScene(False)
        self._type = self.TypeNotDefined
        self._address = ("", 0)
        self._sockets: PeerSockets | None = None
        self._state = self.StateOff
        self._nextCommandId = 1
        self._outgoing: list[HeadlessCommand] = []
        self._lock = threading.Lock()
        self._commands: deque[Raw] = deque()
        self._latest: dict[tuple[str, str, int], Raw] = {}
        self._events: deque[int] = deque()

    def SetTypeClient(self, hostname: str, port: int) -> int:
        """Make it the client of a server."""
        self._type, self._address = self.TypeClient, (hostname, port)
        return 1

    def SetTypeServer(self, port: int) -> int:
        """Make it a server; it listens on this machine's loopback only."""
        self._type, self._address = self.TypeServer, ("127.0.0.1", port)
        return 1

    def GetServerPort(self) -> int:
        """Return the TCP port, that in use where a server was given port 0."""
        return self._sockets.port if self._sockets else self._address[1]

    def GetState(self) -> int:
        """Return one of the state constants."""
        return self._state

    def Start(self) -> int:
        """Begin to connect or to listen, again and again until `Stop`; return 1 on success."""
        if self._sockets is not None or self._type == self.TypeNotDefined:
            return 0
        isServer = self._type == self.TypeServer
        self._state = self.StateWaitConnection
        try:
            self._sockets = PeerSockets(isServer, *self._address, self._receive, self._changeState)
        except OSError as error:
            self._state = self.StateOff
            logging.error("Failed to create server socket: %s", error)
            return 0
        return 1

    def Stop(self) -> int:
        """Disconnect; return 1 on success."""
        if self._sockets is None:
            return 0
        self._sockets.stop()
        self._sockets = None
        self._state = self.StateOff
        return 1

    def GetNumberOfIncomingMRMLNodes(self) -> int:
        """Return the number of nodes that messages have been put into."""
        return self.GetNumberOfNodeReferences(_INCOMING)

    def GetIncomingMRMLNode(self, index: int) -> Any | None:
        """Return one of the nodes that messages have been put into."""
        return self.GetNthNodeReference(_INCOMING, index)

    def SendCommand(self, command: HeadlessCommand) -> None:
        """Send a command to every peer; without one nothing is sent, and nothing is said."""
        if command.IsInProgress():
            logging.error("The command %s is already in progress.", command.GetName())
            return
        command.commandId = self._nextCommandId
        self._nextCommandId += 1
        if self._state != self.StateConnected:
            return
        content = Command(command.commandId, command.GetName(), command.GetCommandContent())
        if not self._sockets.send(pack(Message("command", content, timestamp=0.0))):
            command.SetCommandStatus(command.CommandFailed)
            return
        command.SetCommandStatus(command.CommandWaiting)
        command.sentAt = time.monotonic()
        self._outgoing.append(command)

    def PeriodicProcess(self) -> None:
        """Put into the scene what has arrived, and tell the observers.

        Does nothing while there is no connection: Slicer's timer does not call it then.
        """
        if self._state != self.StateConnected:
            return
        with self._lock:
            commands, self._commands = self._commands, deque()
            latest, self._latest = self._latest, {}
            events, self._events = self._events, deque()
        for header, body in commands:
            self._processCommand(header, body)
        self._giveUpOldCommands()
        modifications = []
        for _key, raw in sorted(latest.items(), key=lambda item: item[0]):
            self._processData(*raw, modifications)
        for event in events:
            if event == self.ConnectedEvent:
                self._greet()
            self.InvokeEvent(event)
        for node, wasModifying in reversed(modifications):
            node.EndModify(wasModifying)

    def _receive(self, peer: int, header: Header, body: bytes) -> None:
        with self._lock:
            if header.type in (Command.TYPE, CommandReply.TYPE):
                self._commands.append((header, body))
            else:
                self._latest[header.type, header.device, peer] = (header, body)

    def _changeState(self, isConnected: bool) -> None:
        self._state = self.StateConnected if isConnected else self.StateWaitConnection
        with self._lock:
            self._events.append(self.ConnectedEvent if isConnected else self.DisconnectedEvent)

    def _greet(self) -> None:
        """Send the odd STATUS that Slicer opens each connection with: no name, metadata `dummy`."""
        greeting = bytearray(pack(Message("none", Status(0), {"dummy": "dummy"}, timestamp=0.0)))
        greeting[_DEVICE_NAME_FIELD] = bytes(20)
        self._sockets.send(bytes(greeting))

    def _processCommand(self, header: Header, body: bytes) -> None:
        try:
            message = unpack(header, body)
        except InputError as error:
            logging.error("A command was dropped: %s", error)
            return
        content = message.content
        if isinstance(content, CommandReply):
            self._takeAnswer(content, message)
            return
        command = HeadlessCommand()
        command.commandId = content.command_id
        command.SetName(content.name)
        command.SetCommandContent(content.body)
        command.SetCommandStatus(command.CommandWaiting)
        self.InvokeEvent(self.CommandReceivedEvent, command)

    def _takeAnswer(self, reply: CommandReply, message: Message) -> None:
        for command in self._outgoing:
            if command.commandId == reply.command_id:
                command.setResponse(reply.body, message.metadata)
                self.InvokeEvent(self.CommandResponseReceivedEvent, command)
                command.InvokeEvent(command.CommandResponseEvent)
                return
        logging.warning("An answer to no command of ours was dropped.")

    def _giveUpOldCommands(self) -> None:
        now = time.monotonic()
        for command in self._outgoing:
            if command.IsInProgress() and now - command.sentAt > command.GetTimeoutSec():
                command.SetCommandStatus(command.CommandExpired)
                command.InvokeEvent(command.CommandExpiredEvent)
        completed = [command for command in self._outgoing if command.IsCompleted()]
        self._outgoing = [command for command in self._outgoing if command.IsInProgress()]
        for command in completed:
            self.InvokeEvent(self.CommandCompletedEvent, command)
            command.InvokeEvent(command.CommandCompletedEvent)

    def _processData(self, header: Header, body: bytes, modifications: list) -> None:
        if _CRASHING_TYPE.match(header.type) or not body:
            raise RuntimeError(
                f"Slicer would not have survived this {header.type} message of {header.device}."
            )
        if header.type not in NODE_CLASS:
            logging.error("Received unknown device type %s of %s.", header.type, header.device)
            return
        if self.GetScene() is None:
            return
        node = self._incomingNode(header)
        modifications.append((node, node.StartModify()))
        if crc64(body) != header.checksum:
            logging.error("A message of %s was dropped: wrong checksum.", header.device)
            return
        try:
            updateNode(node, unpack(header, body))
        except InputError as error:
            logging.error("A message of %s was dropped: %s", header.device, error)

    def _incomingNode(self, header: Header) -> Any:
        for index in range(self.GetNumberOfIncomingMRMLNodes()):
            node = self.GetIncomingMRMLNode(index)
            isOfType = node is not None and node.IsA(NODE_CLASS[header.type])
            if isOfType and node.GetAttribute(ORIGINAL_NAME) == header.device:
                return node
        node = adoptOrCreateNode(self.GetScene(), header.type, header.device)
        self.AddNodeReferenceID(_INCOMING, node.GetID())
        return node
