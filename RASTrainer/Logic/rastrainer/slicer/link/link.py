"""The link to the simulator: one class for desktop Slicer and for the headless side.

Everything happens in `process`, which the host calls soon after something has happened, and before
`restS` seconds are over. Answers and commands are processed even sooner, if the host supports it.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, PROTOCOL_VERSION
from rastrainer.slicer.link.connection import ConnectorKit, SlicerConnection
from rastrainer.slicer.link.link_status import LinkState, LinkStatus, judgeFinding, lookingAt
from rastrainer.slicer.link.pending_commands import Arrivals, OnReply, PendingCommands, Request
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.scene.nodes import prepareNodes
from rastrainer.slicer.signal import ErrorGuard, Signal
from rastrainer.slicer.translation import _

CallSoon = Callable[[Callable[[], None]], None]
"""Calls a function in the host's next turn."""


def neverSoon(_work: Callable[[], None]) -> None:
    """Do nothing: the next `process` will do it."""


SOON_S, REST_S = 0.1, 1.0
"""Until the next look while something changes, and while nothing does."""
POSES_HZ = 30.0
"""Requested rate of poses; software graphics renders them 20 times a second at best."""


class Link:
    """Sends commands, and emits what the simulator reports.

    Attributes:
        statusChanged: emits the new `LinkStatus`.
        opened: emits nothing, after the greeting of each connection has been answered.
        pointsChanged: emits the list of touched points (`vtkMRMLMarkupsFiducialNode`).
        stateChanged: emits what `SimState` says, a dict.
        trialCompleted: emits the record that the simulator delivers, a dict not yet checked.
        trialAborted: emits the record of an aborted trial, a dict not yet checked.
        stepAnswered: emits the answers to a questionnaire of a study, a dict not yet checked.
        woken: emits nothing when `process` has something to do soon; perhaps from inside VTK.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        client: str = "3D Slicer",
        clock: Callable[[], float] = time.monotonic,
        callSoon: CallSoon = neverSoon,
    ) -> None:
        """Make a link that is not connected.

        Args:
            findKit: returns what makes the connector; None where it is not installed.
            client: name of this side, sent to the simulator.
            callSoon: calls a function in the host's next turn, so that answers and commands need
                not wait for the next `process`; it is called from inside VTK.
        """
        self.statusChanged = Signal()
        self.opened = Signal()
        self.pointsChanged = Signal()
        self.stateChanged = Signal()
        self.trialCompleted = Signal()
        self.trialAborted = Signal()
        self.stepAnswered = Signal()
        self.woken = Signal()
        self._scene = scene
        self._client = client
        self._callSoon = callSoon
        self._isCallDue = False
        self._guard = ErrorGuard()
        self._test = ConnectionCheck(self._guard, clock)
        self._arrivals = Arrivals(
            scene,
            self._guard,
            self.pointsChanged,
            self.stateChanged,
            {
                CommandName.TRIAL_COMPLETED: self.trialCompleted,
                CommandName.TRIAL_ABORTED: self.trialAborted,
                CommandName.STEP_ANSWERED: self.stepAnswered,
            },
        )
        self._connection = SlicerConnection(
            scene, findKit, self._keepCommand, self.woken.emit, clock
        )
        self._pending = PendingCommands(self._guard, clock, self._processSoon)
        self._posesAreWanted = False
        self._preparedConnector: Any | None = None
        self._preparation: Iterator[Any] = iter(())
        self._status = self._connection.status

    @property
    def status(self) -> LinkStatus:
        """The state of the link in words, as of the last `process`."""
        return self._status

    @property
    def isInstalled(self) -> bool:
        """Whether the extension with the connector is installed."""
        return self._connection.isInstalled

    @property
    def isOpen(self) -> bool:
        return self._connection.isOpen

    @property
    def restS(self) -> float | None:
        """The longest time until the next `process`; None: none is needed before `woken`.

        Nothing reports that a simulator has fallen silent, or does not answer.
        """
        if self._connection.isChanging or self._test.isRunning:
            return SOON_S
        return REST_S if self._connection.isWanted else None

    @property
    def connector(self) -> Any | None:
        """The connector; a host without Slicer's timer calls its `PeriodicProcess`."""
        return self._connection.connector

    def connectTo(self, host: str = DEFAULT_HOST, port: int = DEFAULT_PORT) -> None:
        """Connect to a simulator, and again whenever the connection is lost."""
        self._begin(checkedAddress(host, port), isListening=False)

    def listenOn(self, port: int = DEFAULT_PORT) -> None:
        """Wait for a simulator that was started with `--connect`."""
        checkPort(port)
        self._begin(("", port), isListening=True)

    def testConnection(
        self, host: str, port: int, onFound: Callable[[LinkStatus], None]
    ) -> LinkStatus:
        """Test once what answers at an address; `onFound` is called by a later `process`.

        Returns:
            The status to show meanwhile.
        """
        status = self._test.begin(*checkedAddress(host, port), onFound)
        self.woken.emit()
        return status

    def disconnect(self) -> None:
        """Close the connection and do not reconnect."""
        self._connection.end()
        self.process()

    def requestPoses(self, areWanted: bool) -> None:
        """Have the simulator send poses while the arm moves, or none.

        Slicer renders all its views for each pose, so request them only while someone is looking.
        """
        if areWanted != self._posesAreWanted:
            self._posesAreWanted = areWanted
            if self.isOpen:
                self._sendHello(isFirst=False)

    def send(
        self,
        name: str,
        arguments: Mapping[str, Any] | None = None,
        onReply: OnReply = lambda _reply: None,
        timeoutS: float = 5.0,
    ) -> None:
        """Send a command; `onReply` is called by a later `process`, exactly once."""
        check_arguments(name, arguments or {})
        status = self._connection.status
        if not self.isOpen or status.state is LinkState.WRONG_VERSION:
            self._pending.refuse(onReply, status.sentence)
            self._processSoon()
            return
        content = json.dumps(dict(arguments or {}), allow_nan=False)
        self._pending.send(Request(name, content, timeoutS, onReply), self._transmit)

    def process(self) -> None:
        """Connect, judge the heartbeat, and emit what has arrived."""
        self._isCallDue = False
        if self._scene.IsBatchProcessing():
            return
        self._test.process()
        if self._guard.run("The connection", self._connection.follow):
            self._sendHello(isFirst=True)
        if self.connector is not self._preparedConnector:
            self._preparedConnector = self.connector
            self._preparation = iter(() if self.connector is None else prepareNodes(self._scene))
        # Each new node takes the panels and trees of Slicer long.
        next(self._preparation, None)
        self._emitStatus()
        self._pending.poll(self.isOpen, self._transmit)
        if self.connector is not None:
            self._arrivals.emitNodes()
        self._arrivals.emitCommands()

    def _begin(self, address: tuple[str, int], isListening: bool) -> None:
        self._connection.begin(address, isListening)
        self.process()
        self.woken.emit()

    def _transmit(self, request: Request) -> Any:
        """Return the connector's command for a request, sent."""
        kit, connector = self._connection.kit, self.connector
        # Commands are transmitted over an open connection only.
        assert kit is not None
        assert connector is not None
        command = kit.makeCommand()
        command.SetName(request.name)
        command.SetCommandContent(request.content)
        command.SetTimeoutSec(request.timeoutS)
        connector.SendCommand(command)
        return command

    def _keepCommand(self, name: str | bytes, content: str | bytes) -> None:
        """Keep a command of the simulator until it can be handled: this is inside VTK."""
        self._arrivals.keepCommand(name, content)
        self._guard.run("A command's event", self._processSoon)

    def _processSoon(self) -> None:
        """Have what has arrived processed soon; called from inside VTK."""
        if not self._isCallDue:
            self._isCallDue = True
            self._callSoon(self._processArrivals)

    def _processArrivals(self) -> None:
        self._isCallDue = False
        if not self._scene.IsBatchProcessing():
            self._pending.poll(self.isOpen, self._transmit)
            self._arrivals.emitCommands()

    def _sendHello(self, isFirst: bool) -> None:
        """Greet the simulator and request poses; called again to change the request."""

        def welcome(reply: Reply) -> None:
            version = reply.data.get("protocolVersion")
            if isinstance(version, int):
                self._connection.peerVersion = version
            if reply.ok and isFirst:
                self._guard.emit("The opened link", self.opened)

        hz = POSES_HZ if self._posesAreWanted else 0.0
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": self._client}
        self.send(CommandName.HELLO, {**hello, "toolTipHz": hz, "linksHz": hz}, welcome)

    def _emitStatus(self) -> None:
        status = self._connection.status
        if status != self._status:
            self._status = status
            self._guard.emit("The link's status", self.statusChanged, status)


class ConnectionCheck:
    """The latest test; a new one replaces one that is still running."""

    def __init__(self, guard: ErrorGuard, clock: Callable[[], float]) -> None:
        self._guard = guard
        self._clock = clock
        self._probe: Probe | None = None
        self._address = ""
        self._onFound: Callable[[LinkStatus], None] = lambda _status: None

    @property
    def isRunning(self) -> bool:
        """Whether a test is under way."""
        return self._probe is not None

    def begin(self, host: str, port: int, onFound: Callable[[LinkStatus], None]) -> LinkStatus:
        """Start a test; a later `process` calls `onFound`. Return the status to show meanwhile."""
        if self._probe is not None:
            self._probe.close()
        self._probe = Probe(host, port, self._clock)
        self._address = f"{host}:{port}"
        self._onFound = onFound
        return lookingAt(self._address)

    def process(self) -> None:
        """Report what answers, once that is known."""
        finding = None if self._probe is None else self._probe.process()
        if finding is not None:
            self._probe = None
            status = judgeFinding(finding, self._address)
            self._guard.run("The test of a connection", self._onFound, status)


def checkedAddress(host: str, port: int) -> tuple[str, int]:
    """Return a valid address."""
    if not host.strip():
        raise InputError(_("Enter the host of the simulator, such as 127.0.0.1."))
    checkPort(port)
    return host.strip(), port


def checkPort(port: int) -> None:
    """Raise `InputError` if the port is invalid."""
    if not 0 < port < 65536:
        raise InputError(_("The port must be a number from 1 to 65535."))
