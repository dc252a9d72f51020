"""Stand-ins of Slicer's connector and its commands, so that the link runs without desktop Slicer.

The connector makes the very nodes that the real one makes, and has its oddities: the latest message
of a device wins, the order across devices is lost, time stamps are dropped, and a lost connection
is reported only after the next one. What would crash Slicer is recorded.
"""

from __future__ import annotations

import contextlib
import logging
import re
import socket
import threading
import time
import weakref
from collections import deque
from collections.abc import Callable, Mapping
from typing import Any, BinaryIO

import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.igtl.content import ERROR_KEY, STATUS_KEY, SUCCESS, Command, CommandReply, Status
from rastrainer.igtl.message import HEADER_BYTES, Header, Message, crc64, pack, read_header, unpack
from rastrainer.slicer.link.link import ConnectorKit
from rastrainer.slicer.scene.nodes import ORIGINAL_NAME, decodedText
from rastrainer_headless.scene import NODE_CLASS, adoptOrCreateNode, asSlicerHas, updateNode

RETRY_PERIOD_S = 0.1
CRASHING_BODY = 2**31
_VERSIONS = (b"\0\1", b"\0\2")
_INCOMING = "incoming"
_CRASHING_TYPE = re.compile(r"(GET|STT|STP|RTS)_")
_DEVICE_NAME_FIELD = slice(14, 34)

Raw = tuple[Header, bytes]
WireText = str | bytes

crashes: list[str] = []
"""What would have crashed Slicer, one sentence each."""


class CrashError(RuntimeError):
    """Slicer would have crashed."""


def recordCrash(sentence: str) -> CrashError:
    """Record a crash, from any thread; the caller may raise the error."""
    crashes.append(sentence)
    logging.critical("Slicer would not have survived: %s", sentence)
    return CrashError(sentence)


def _stored(name: str) -> tuple[Callable[[Any, Any], None], Callable[[Any], Any]]:
    """Return the setter and the getter of a value, as VTK's classes have them."""
    return (lambda self, value: setattr(self, name, value)), (lambda self: getattr(self, name))


class HeadlessCommand(vtk.vtkObject):
    """The part of `vtkSlicerOpenIGTLinkCommand` that we use: a sent command, and its answer.

    It has the real class's names, values and default time-out. Python gets a text of VTK's as
    `bytes` if it is not UTF-8.
    """

    CommandUnknown, CommandWaiting, CommandExpired, CommandCancelled = range(4)
    CommandFailed, CommandResponseReceived, CommandResponseSent = range(4, 7)

    CommandCompletedEvent = 128004

    def __init__(self) -> None:
        self.commandId = -1
        self._name = self._content = self._response = ""
        self._metadata: Mapping[str, WireText] = {}
        self._timeoutS = 5.0
        self._status = self.CommandUnknown

    SetName, GetName = _stored("_name")
    SetCommandContent, GetCommandContent = _stored("_content")
    SetTimeoutSec, GetTimeoutSec = _stored("_timeoutS")
    SetCommandStatus, GetCommandStatus = _stored("_status")
    _setResponse, GetResponseContent = _stored("_response")

    def IsInProgress(self) -> bool:
        return self._status == self.CommandWaiting

    def setResponse(self, content: WireText, metadata: Mapping[str, WireText]) -> None:
        self._setResponse(content)
        self._metadata, self._status = metadata, self.CommandResponseReceived

    def GetSuccessful(self) -> bool:
        """Return whether the answer says SUCCESS in its metadata; its content does not matter."""
        return self._metadata.get(STATUS_KEY) == SUCCESS

    def GetErrorMessage(self) -> WireText:
        return self._metadata.get(ERROR_KEY, "")


class HeadlessConnector(slicer.vtkMRMLScriptedModuleNode):
    """The part of the connector that we use; the host calls `PeriodicProcess` every few ms.

    Method names, constants and event numbers match the real class.
    """

    StateOff, StateWaitConnection, StateConnected = range(3)
    ConnectedEvent = 118944
    DisconnectedEvent = 118945
    CommandReceivedEvent = 119001

    def __init__(self) -> None:
        self.SetSaveWithScene(False)
        self._address = ("", 0)
        self._thread: threading.Thread | None = None
        self._stopped = threading.Event()
        self._peer: socket.socket | None = None
        self._state = self.StateOff
        self._nextCommandId = 1
        self._outgoing: dict[int, tuple[float, weakref.ref[HeadlessCommand]]] = {}
        self._lock = threading.Lock()
        self._commands: deque[Raw] = deque()
        self._latest: dict[tuple[str, str], Raw] = {}
        self._events: deque[int] = deque()

    def SetTypeClient(self, hostname: str, port: int) -> int:
        self._address = (hostname, port)
        return 1

    def GetServerHostname(self) -> str:
        return self._address[0]

    def SetServerPort(self, port: int) -> None:
        """Change the port; a client that runs connects there the next time it has no server."""
        self._address = (self._address[0], port)

    def GetState(self) -> int:
        return self._state

    def Start(self) -> int:
        if self._thread is not None:
            return 0
        self._state = self.StateWaitConnection
        self._stopped.clear()
        self._thread = threading.Thread(target=self._keepConnected, daemon=True)
        self._thread.start()
        return 1

    def Stop(self) -> int:
        if self._thread is None:
            return 0
        self._stopped.set()
        peer = self._peer
        if peer is not None:
            with contextlib.suppress(OSError):  # The other side may have been faster.
                peer.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._thread = None
        self._state = self.StateOff
        return 1

    def GetNumberOfIncomingMRMLNodes(self) -> int:
        return self.GetNumberOfNodeReferences(_INCOMING)

    def GetIncomingMRMLNode(self, index: int) -> Any | None:
        return self.GetNthNodeReference(_INCOMING, index)

    def SendCommand(self, command: HeadlessCommand) -> None:
        """Send a command; without a connection nothing is sent, silently."""
        if command.IsInProgress():
            logging.error("The command %s is already in progress.", command.GetName())
            return
        command.commandId = self._nextCommandId
        self._nextCommandId += 1
        if self._state != self.StateConnected:
            return
        texts = decodedText(command.GetName()), decodedText(command.GetCommandContent())
        content = Command(command.commandId, *texts)
        if not self._send(pack(Message("command", content, timestamp=0.0))):
            command.SetCommandStatus(command.CommandFailed)
            return
        command.SetCommandStatus(command.CommandWaiting)
        deadline = time.monotonic() + command.GetTimeoutSec()
        self._outgoing[command.commandId] = deadline, weakref.ref(command)

    def PeriodicProcess(self) -> None:
        """Put all arrivals into the scene, and notify the observers.

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
        modifications: list[tuple[Any, int]] = []
        for key in sorted(latest):
            self._processData(*latest[key], modifications)
        for event in events:
            if event == self.ConnectedEvent:
                # The odd STATUS that Slicer opens each connection with: no name, metadata `dummy`.
                dummy = Message("none", Status(0), {"dummy": "dummy"}, timestamp=0.0)
                greeting = bytearray(pack(dummy))
                greeting[_DEVICE_NAME_FIELD] = bytes(20)
                self._send(bytes(greeting))
            self.InvokeEvent(event)
        for node, wasModifying in reversed(modifications):
            node.EndModify(wasModifying)

    def _send(self, data: bytes) -> bool:
        """Send, blocking while the peer does not read; return whether it took everything."""
        peer = self._peer
        try:
            if peer is not None:
                peer.sendall(data)
        except OSError:
            return False
        return peer is not None

    def _keepConnected(self) -> None:
        """Connect and receive until stopped; runs in its own thread."""
        while not self._stopped.is_set():
            with (
                contextlib.suppress(OSError),
                socket.create_connection(self._address, timeout=1.0) as peer,
            ):
                peer.settimeout(None)
                peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._peer = peer
                self._changeState(True)
                with contextlib.suppress(OSError, CrashError), peer.makefile("rb") as stream:
                    while not self._stopped.is_set() and (message := _readMessage(stream)):
                        self._receive(*message)
                self._peer = None
                if not self._stopped.is_set():
                    self._changeState(False)
            self._stopped.wait(RETRY_PERIOD_S)

    def _receive(self, header: Header, body: bytes) -> None:
        with self._lock:
            if header.type in (Command.TYPE, CommandReply.TYPE):
                self._commands.append((header, body))
            else:
                self._latest[header.type, header.device] = (header, body)

    def _changeState(self, isConnected: bool) -> None:
        self._state = self.StateConnected if isConnected else self.StateWaitConnection
        with self._lock:
            self._events.append(self.ConnectedEvent if isConnected else self.DisconnectedEvent)

    def _processCommand(self, header: Header, body: bytes) -> None:
        try:
            message = unpack(header, body, keep_bytes=True)
        except InputError as error:
            raise recordCrash(f"A broken command came: {error}") from None
        content = message.content
        if isinstance(content, CommandReply):
            if content.command_id not in self._outgoing:
                logging.warning("An answer to no command of ours was dropped.")
                return
            command = self._sentCommand(content.command_id)
            metadata = {key: asSlicerHas(text) for key, text in message.metadata.items()}
            command.setResponse(asSlicerHas(content.body), metadata)
        elif isinstance(content, Command):
            command = HeadlessCommand()
            command.SetName(asSlicerHas(content.name))
            command.SetCommandContent(asSlicerHas(content.body))
            self.InvokeEvent(self.CommandReceivedEvent, command)

    def _sentCommand(self, commandId: int) -> HeadlessCommand:
        """Return the object that was made in Python.

        The real connector reports to it, whether or not it still lives.
        """
        command = self._outgoing[commandId][1]()
        if command is None:
            raise recordCrash("A command was deleted before the connector was done with it.")
        return command

    def _giveUpOldCommands(self) -> None:
        for commandId, (deadline, reference) in list(self._outgoing.items()):
            if time.monotonic() > deadline:
                command = self._sentCommand(commandId)
                if command.IsInProgress():
                    command.SetCommandStatus(command.CommandExpired)
            ended = reference()
            if ended is not None and not ended.IsInProgress():
                del self._outgoing[commandId]
                ended.InvokeEvent(ended.CommandCompletedEvent)

    def _processData(
        self, header: Header, body: bytes, modifications: list[tuple[Any, int]]
    ) -> None:
        if _CRASHING_TYPE.match(header.type) or not body:
            raise recordCrash(f"A {header.type} message of {header.device} came.")
        if header.type not in NODE_CLASS:
            logging.error("Received unknown device type %s of %s.", header.type, header.device)
            return
        if self.GetScene() is None:
            return
        indexes = range(self.GetNumberOfIncomingMRMLNodes())
        known = [node for index in indexes if (node := self.GetIncomingMRMLNode(index))]
        ours = [node for node in known if node.GetAttribute(ORIGINAL_NAME) == header.device]
        node = next((node for node in ours if node.IsA(NODE_CLASS[header.type])), None)
        if node is None:
            node = adoptOrCreateNode(self.GetScene(), header.type, header.device)
            self.AddNodeReferenceID(_INCOMING, node.GetID())
        modifications.append((node, node.StartModify()))
        if crc64(body) != header.checksum:
            logging.error("A message of %s was dropped: wrong checksum.", header.device)
            return
        try:
            updateNode(node, unpack(header, body, keep_bytes=True))
        except InputError as error:
            if "extended header" in str(error):
                raise recordCrash(f"A message of {header.device} came: {error}") from None
            logging.error("A message of %s was dropped: %s", header.device, error)


def _readMessage(stream: BinaryIO) -> Raw | None:
    """Return the next message, None at the end.

    The real client takes any bytes for a header, and allocates the size that it reads there.
    """
    start = stream.read(len(_VERSIONS[0]))
    if len(start) < len(_VERSIONS[0]):
        return None
    if start not in _VERSIONS:
        raise recordCrash("The connector met something that is not OpenIGTLink.")
    headerBytes = start + stream.read(HEADER_BYTES - len(start))
    if len(headerBytes) < HEADER_BYTES:
        return None
    header = read_header(headerBytes)
    if header is None or header.body_size >= CRASHING_BODY:
        raise recordCrash("The peer sent a header that no OpenIGTLink message has.")
    body = stream.read(header.body_size)
    return (header, body) if len(body) == header.body_size else None


def headlessKit() -> ConnectorKit:
    return ConnectorKit(HeadlessConnector, HeadlessCommand)
