"""The link to the simulator: one class for desktop Slicer and for the headless side.

It keeps one connector in the scene and connected, and has each command answered exactly once. The
scene may be cleared of the connector, the simulator restarted, or the line cut silently: the link
notices and reconnects. Everything happens in `process`, which the host calls soon after something
has happened, and before `restS` seconds are over. Answers and commands are processed even sooner,
if the host supports it.
"""

from __future__ import annotations

import json
import logging
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import slicer
import vtk

from rastrainer.commands import CommandName, check_arguments, decode_answer_object
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.link import link_status
from rastrainer.slicer.link.link_status import LinkObservation, LinkState, LinkStatus, Peer
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.scene.nodes import (
    ORIGINAL_NAME,
    Role,
    decodedText,
    labelsOf,
    prepareNodes,
    shownText,
)
from rastrainer.slicer.signal import ErrorGuard, Signal
from rastrainer.slicer.translation import _

CallSoon = Callable[[Callable[[], None]], None]
"""Calls a function in the host's next turn."""
OnReply = Callable[[Reply], None]


class ConnectorKit(NamedTuple):
    """Makes a `vtkMRMLIGTLConnectorNode` and a `vtkSlicerOpenIGTLinkCommand`, or stand-ins."""

    makeConnector: Callable[[], Any]
    makeCommand: Callable[[], Any]


def desktopKit() -> ConnectorKit | None:
    if not hasattr(slicer, "vtkMRMLIGTLConnectorNode"):
        return None
    return ConnectorKit(slicer.vtkMRMLIGTLConnectorNode, slicer.vtkSlicerOpenIGTLinkCommand)


@dataclass
class Request:
    """A command that is to be sent: `content` is JSON; the last two are set once it is sent."""

    name: str
    content: str
    timeoutS: float
    onReply: OnReply
    command: Any = None
    deadline: float = 0.0


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
MAX_AT_ONCE = 16
"""Most commands without an answer; the simulator carries out as many at once."""
MAX_KEPT = 256
"""Most arrived commands that may wait. The sender has to repeat the others, as the simulator does
with trials and answers until they are acknowledged."""
_LOST = Reply(False, _("The connection to the simulator was lost."))
SOON_S, REST_S = 0.1, 1.0
"""Until the next look while something changes, and while nothing does."""
POSES_HZ = 30.0
"""Requested rate of poses; software graphics renders them 20 times a second at best."""
COMMANDS_A_TURN, CHARACTERS_A_TURN = 16, 200_000
"""How much is processed before the application may do something else."""


class Link:
    """One connection to a simulator, restored until `disconnect`: sends and receives.

    The connector, None while there is no simulator to connect to, is started only when one has just
    answered, as anything else might end Slicer: see `rastrainer.slicer.link.probe`. Its events come
    from inside VTK: they only note an arrival, and have `processArrivals` called in another turn.

    `woken` emits nothing when there is something to do soon; perhaps from inside VTK. `status` is
    as of the last `process`. `opened` is emitted after the greeting of each connection has been
    answered, `pointsChanged` with the list of touched points, `stateChanged` with what `SimState`
    says. `trialCompleted`, `trialAborted` and `stepAnswered` emit the records that the simulator
    delivers: dicts not yet checked.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        clock: Callable[[], float] = time.monotonic,
        callSoon: CallSoon = lambda _work: None,
    ) -> None:
        """Make a link that is not connected; `callSoon` is called from inside VTK."""
        self.findKit = findKit
        self.connector: Any | None = None
        self.seen = LinkObservation()
        self.woken = Signal()
        self._scene = scene
        self._clock = clock
        self._callSoon = callSoon
        self._isCallDue = False
        self._guard = ErrorGuard()
        self._kit: ConnectorKit | None = None
        self._address = ("", 0)
        self._probe: Probe | None = None
        self._observerTags: list[int] = []
        self._nextProbe = self._connectsUntil = self._lastLook = 0.0
        self._heartbeatTime: int | None = None
        self._arrived: deque[tuple[str | bytes, str | bytes]] = deque()
        self._waiting: deque[Request] = deque()
        self._sent: list[Request] = []
        self._abandoned: list[Any] = []
        self._refused: list[tuple[OnReply, Reply]] = []
        self.statusChanged = Signal()
        self.opened = Signal()
        self.pointsChanged = Signal()
        self.stateChanged = Signal()
        self.trialCompleted = Signal()
        self.trialAborted = Signal()
        self.stepAnswered = Signal()
        self.status = link_status.judge(self.seen)
        self._test: tuple[Probe, str, Callable[[LinkStatus], None]] | None = None
        self._points: tuple = ()
        self._stateText: str | bytes = ""
        self._posesAreWanted = False
        self._preparedConnector: Any | None = None
        self._preparation: Iterator[Any] = iter(())

    @property
    def restS(self) -> float | None:
        """The longest time until the next `process`; None: none is needed before `woken`.

        Nothing reports that a simulator has fallen silent, or does not answer.
        """
        isWanted = bool(self.seen.address)
        isChanging = self._probe is not None or self._clock() < self._connectsUntil
        if self.seen.isOpen:
            isChanging = not self.seen.hasHeartbeat
        if self._test is not None or (isWanted and self._kit is not None and isChanging):
            return SOON_S
        return REST_S if isWanted else None

    def connectTo(self, host: str = DEFAULT_HOST, port: int = DEFAULT_PORT) -> None:
        """Connect to a simulator, and again whenever the connection is lost."""
        host, port = self._address = _checkedAddress(host, port)
        self._endConnection()
        self._kit = self.findKit()
        self.seen = LinkObservation(f"{host}:{port}", isInstalled=self._kit is not None)
        self.process()
        self.woken.emit()

    def testConnection(
        self, host: str, port: int, onFound: Callable[[LinkStatus], None]
    ) -> LinkStatus:
        """Test once what answers at an address; `onFound` is called by a later `process`."""
        host, port = _checkedAddress(host, port)
        if self._test is not None:
            self._test[0].close()
        self._test = Probe(host, port, self._clock), f"{host}:{port}", onFound
        self.woken.emit()
        return link_status.lookingAt(f"{host}:{port}")

    def disconnect(self) -> None:
        self._endConnection()
        self.process()

    def requestPoses(self, areWanted: bool) -> None:
        """Have the simulator send poses while the arm moves, or none.

        Slicer renders all its views for each pose, so request them only while someone is looking.
        """
        if areWanted != self._posesAreWanted:
            self._posesAreWanted = areWanted
            if self.seen.isOpen:
                self._sendHello(isFirst=False)

    def process(self) -> None:
        """Connect, judge the heartbeat, and emit all arrivals."""
        self._isCallDue = False
        if self._scene.IsBatchProcessing():
            return
        if self._test is not None:
            probe, address, onFound = self._test
            finding = probe.process()
            if finding is not None:
                self._test = None
                status = link_status.judgeFinding(finding, address)
                self._guard.run("The test of a connection", onFound, status)
        if self._guard.run("The connection", self.followConnection):
            self._sendHello(isFirst=True)
        if self.connector is not self._preparedConnector:
            self._preparedConnector = self.connector
            self._preparation = iter(() if self.connector is None else prepareNodes(self._scene))
        # Each new node takes the panels and trees of Slicer long.
        next(self._preparation, None)
        status = link_status.judge(self.seen)
        if status != self.status:
            self.status = status
            self._guard.emit("The link's status", self.statusChanged, status)
        self._deliverReplies()
        if self.connector is not None:
            self._guard.run("The touched points and the state", self._emitNodes)
        self._emitCommands()

    def processArrivals(self) -> None:
        """Deliver replies and commands, as `process` does with all else."""
        self._isCallDue = False
        if not self._scene.IsBatchProcessing():
            self._deliverReplies()
            self._emitCommands()

    def _sendHello(self, isFirst: bool) -> None:
        """Greet the simulator and request poses; called again to change the request."""

        def welcome(reply: Reply) -> None:
            version = reply.data.get("protocolVersion")
            if isinstance(version, int):
                self.seen.peerVersion = version
            if reply.ok and isFirst:
                self._guard.emit("The opened link", self.opened)

        hz = POSES_HZ if self._posesAreWanted else 0.0
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "3D Slicer"}
        self.send(CommandName.HELLO, {**hello, "toolTipHz": hz, "linksHz": hz}, welcome)

    def _emitNodes(self) -> None:
        node = Role.CAPTURED_POINTS.make(self._scene)
        rows = range(node.GetNumberOfControlPoints())
        points = labelsOf(node), tuple(node.GetNthControlPointPosition(row) for row in rows)
        if points != self._points:
            self._points = points
            self._guard.emit("The touched points", self.pointsChanged, node)
        text = Role.SIM_STATE.make(self._scene).GetText()
        if text and text != self._stateText:
            self._stateText = text
            self._emitContent(text, DeviceName.SIM_STATE, self.stateChanged)

    def _emitCommands(self) -> None:
        """Emit the kept commands in order; if there are many, the rest follows later.

        What cannot be read is logged and does not stop the rest.
        """
        signals: dict[str, Signal] = {
            CommandName.TRIAL_COMPLETED: self.trialCompleted,
            CommandName.TRIAL_ABORTED: self.trialAborted,
            CommandName.STEP_ANSWERED: self.stepAnswered,
        }
        characters = 0
        for _turn in range(min(len(self._arrived), COMMANDS_A_TURN)):
            if characters > CHARACTERS_A_TURN:
                break
            name, content = self._arrived.popleft()
            characters += len(content)
            name = shownText(name)
            if name in signals:
                self._emitContent(content, name, signals[name])
            else:
                logging.warning("The simulator sent the unknown command %.40s.", name)

    def _emitContent(self, text: str | bytes, name: str, signal: Signal) -> None:
        try:
            value = decode_answer_object(decodedText(text))
        except InputError as error:
            logging.error("What came as %s cannot be read: %s", name, error)
            return
        self._guard.emit(name, signal, value)

    def send(
        self,
        name: str,
        arguments: Mapping[str, Any] | None = None,
        onReply: OnReply = lambda _reply: None,
        timeoutS: float = 5.0,
    ) -> None:
        """Send a command; `onReply` is called in a later turn, exactly once."""
        check_arguments(name, arguments or {})
        status = link_status.judge(self.seen)
        if not self.seen.isOpen or status.state is LinkState.WRONG_VERSION:
            self._refused.append((onReply, Reply(False, status.sentence)))
            self._processSoon()
            return
        content = json.dumps(dict(arguments or {}), allow_nan=False)
        self._waiting.append(Request(name, content, timeoutS, onReply))
        self._sendSome()

    def _sendSome(self) -> None:
        while self._waiting and len(self._sent) < MAX_AT_ONCE:
            # Commands wait over an open connection only.
            assert self._kit is not None
            assert self.connector is not None
            request = self._waiting.popleft()
            request.command = command = self._kit.makeCommand()
            command.SetName(request.name)
            command.SetCommandContent(request.content)
            command.SetTimeoutSec(request.timeoutS)
            self.connector.SendCommand(command)
            command.AddObserver(command.CommandCompletedEvent, self._processSoon)
            request.deadline = self._clock() + request.timeoutS
            self._sent.append(request)

    def _deliverReplies(self) -> None:
        """Deliver replies that have come or will never come; send waiting commands.

        The connector's own time-out is not enough: without a connection it neither sends a command
        nor lets one expire.
        """
        replies, self._refused = self._refused, []
        sent, self._sent = self._sent, []
        for request in sent:
            reply = self._replyTo(request)
            if reply is None:
                self._sent.append(request)
            else:
                replies.append((request.onReply, reply))
                self._abandoned.append(request.command)
        # The connector may still report on an abandoned one: it must live until then.
        self._abandoned = [command for command in self._abandoned if command.IsInProgress()]
        if self.seen.isOpen:
            self._sendSome()
        else:
            replies += [(request.onReply, _LOST) for request in self._waiting]
            self._waiting.clear()
        for onReply, reply in replies:
            self._guard.run("The reply to a command", onReply, reply)

    def _replyTo(self, request: Request) -> Reply | None:
        command = request.command
        if command.GetCommandStatus() == command.CommandResponseReceived:
            if not command.GetSuccessful():
                sentence = shownText(command.GetErrorMessage())
                return Reply(False, sentence or _("The simulator refused without giving a reason."))
            try:
                data = decode_answer_object(decodedText(command.GetResponseContent()))
            except InputError:
                return Reply(False, _("The simulator's answer cannot be read."))
            return Reply(True, "", data)
        if not self.seen.isOpen:
            return _LOST
        if not command.IsInProgress() or self._clock() > request.deadline:
            sentence = _("The simulator did not answer {name}.")
            return Reply(False, sentence.format(name=request.name))
        return None

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _keepCommand(self, _caller: Any, _event: str, command: Any) -> None:
        """Keep a command of the simulator until it can be handled: this is inside VTK."""
        if len(self._arrived) < MAX_KEPT:
            self._arrived.append((command.GetName(), command.GetCommandContent()))
        self._processSoon()

    def _processSoon(self, *_event: Any) -> None:
        """Have arrivals processed in another turn; called from inside VTK."""
        if not self._isCallDue:
            self._isCallDue = True
            self._guard.run("A command's event", self._callSoon, self.processArrivals)

    def _endConnection(self) -> None:
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
        if self.seen.silenceS > link_status.RECONNECT_AFTER_S:
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
        if self._probe is not None:
            self._probe.close()
            self._probe = None
        self.seen.finding = None
        self._nextProbe = self._clock()

    def _search(self, host: str, port: int) -> link_status.ProbeResult | None:
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
            connector.AddObserver(connector.CommandReceivedEvent, self._keepCommand),
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


def _checkedAddress(host: str, port: int) -> tuple[str, int]:
    if not host.strip():
        raise InputError(_("Enter the host of the simulator, such as 127.0.0.1."))
    if not 0 < port < 65536:
        raise InputError(_("The port must be a number from 1 to 65535."))
    return host.strip(), port
