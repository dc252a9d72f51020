"""The link to the simulator: one class for desktop Slicer and for the headless side.

Everything happens in `process`, which the host calls soon after something has happened, and before
`restS` seconds are over. Answers and commands are processed even sooner, if the host supports it.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from typing import Any

from rastrainer.commands import CommandName, decode_answer_object
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.link.connection import CallSoon, ConnectorKit, SimulatorConnection
from rastrainer.slicer.link.link_status import (
    LinkObservation,
    LinkStatus,
    judge,
    judgeFinding,
    lookingAt,
)
from rastrainer.slicer.link.probe import Probe
from rastrainer.slicer.scene.nodes import (
    Role,
    decodedText,
    labelsOf,
    prepareNodes,
    shownText,
)
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

SOON_S, REST_S = 0.1, 1.0
"""Until the next look while something changes, and while nothing does."""
POSES_HZ = 30.0
"""Requested rate of poses; software graphics renders them 20 times a second at best."""
COMMANDS_A_TURN, CHARACTERS_A_TURN = 16, 200_000
"""How much is processed before the application may do something else."""


class Link(SimulatorConnection):
    """Sends commands, and emits what the simulator reports.

    `status` is as of the last `process`. `opened` is emitted after the greeting of each connection
    has been answered, `pointsChanged` with the list of touched points, `stateChanged` with what
    `SimState` says. `trialCompleted`, `trialAborted` and `stepAnswered` emit the records that the
    simulator delivers: dicts not yet checked.
    """

    def __init__(
        self,
        scene: Any,
        findKit: Callable[[], ConnectorKit | None],
        clock: Callable[[], float] = time.monotonic,
        callSoon: CallSoon = lambda _work: None,
    ) -> None:
        """Make a link that is not connected; `callSoon` is called from inside VTK."""
        super().__init__(scene, findKit, clock, callSoon)
        self.statusChanged = Signal()
        self.opened = Signal()
        self.pointsChanged = Signal()
        self.stateChanged = Signal()
        self.trialCompleted = Signal()
        self.trialAborted = Signal()
        self.stepAnswered = Signal()
        self.status = judge(self.seen)
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
        return lookingAt(f"{host}:{port}")

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
                status = judgeFinding(finding, address)
                self._guard.run("The test of a connection", onFound, status)
        if self._guard.run("The connection", self.followConnection):
            self._sendHello(isFirst=True)
        if self.connector is not self._preparedConnector:
            self._preparedConnector = self.connector
            self._preparation = iter(() if self.connector is None else prepareNodes(self._scene))
        # Each new node takes the panels and trees of Slicer long.
        next(self._preparation, None)
        status = judge(self.seen)
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


def _checkedAddress(host: str, port: int) -> tuple[str, int]:
    if not host.strip():
        raise InputError(_("Enter the host of the simulator, such as 127.0.0.1."))
    if not 0 < port < 65536:
        raise InputError(_("The port must be a number from 1 to 65535."))
    return host.strip(), port
