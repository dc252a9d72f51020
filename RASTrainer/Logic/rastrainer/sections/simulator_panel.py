"""The section Simulator: start, connect, and the state of the link in words and color."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.setup_panel import costSentence
from rastrainer.slicer.link.link_status import LinkState, LinkStatus
from rastrainer.slicer.program.simulator_program import ProgramState
from rastrainer.slicer.settings import HAS_NETWORK, HAS_WINDOW, HOST, PORT
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    LINK_COLORS,
    bind,
    connectAsPressed,
    setEnabled,
    setLight,
    setSilently,
    setText,
)
from rastrainer.widgets.plain_text import toolTip
from rastrainer.widgets.shown_errors import guardedAction, showErrors


class SimulatorPanel(Panel):
    """The section Simulator."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._link = session.link
        self._simulator = session.simulator
        bind(ui.hostLineEdit, "text", session.settings, HOST)
        bind(ui.portSpinBox, "value", session.settings, PORT)
        bind(ui.windowCheckBox, "checked", session.settings, HAS_WINDOW)
        bind(ui.networkCheckBox, "checked", session.settings, HAS_NETWORK)
        self._startsAfterSetup = False
        ui.startSimulatorButton.connect("clicked()", self.startAndConnect)
        connectClick(
            ui.stopSimulatorButton, self._simulator.stop, _("The simulator could not be stopped.")
        )
        ui.programPathLineEdit.connect("currentPathChanged(QString)", self._showProgram)
        disconnect = guardedAction(self._link.disconnect, _("The connection could not be closed."))
        connectAsPressed(ui.connectButton, lambda: self.connect if self._isOff() else disconnect)
        connectClick(ui.probeButton, self.testConnection, _("The connection could not be tested."))
        setup, program = self._simulator.setup, self._simulator.program
        self.listen(
            (self._link.statusChanged, self._showStatus),
            (
                self._link.stateChanged,
                lambda state: setText(ui.trainingText, str(state.get("instruction", ""))),
            ),
            (setup.changed, self._showProgram),
            (setup.finished, self._startAfterSetup),
            (program.wroteLine, ui.simulatorLogEdit.appendPlainText),
            (program.changed, self._showProgram),
        )
        self._showStatus(self._link.status)
        self._showProgram()

    def startAndConnect(self) -> None:
        """Start the simulator on this computer and connect; set it up first, after asking."""
        if not self._simulator.needsSetup:
            self._start()
            return
        question = _(
            "The simulator is not set up on this computer yet. Set it up now, and start it then? "
            "{cost} Slicer itself is not changed. This takes some minutes."
        ).format(cost=costSentence(self._ui, self._simulator.setup))
        if slicer.util.confirmOkCancelDisplay(toolTip(question), _("Set up the simulator")):
            self._ui.setupButton.click()
            # Not if it could not be started: a later set-up should not start anything.
            self._startsAfterSetup = self._simulator.setup.isRunning

    def connect(self) -> None:
        """Connect to the simulator, unless a connection is already being made."""
        with showErrors(_("The connection could not be started.")):
            if self._isOff():
                self._link.connectTo(self._ui.hostLineEdit.text, self._ui.portSpinBox.value)

    def testConnection(self) -> None:
        """Check once whether a simulator answers, and show the result."""

        def show(status: LinkStatus) -> None:
            if self._isOff():
                self._showWords(status)

        host, port = self._ui.hostLineEdit.text, self._ui.portSpinBox.value
        self._showWords(self._link.testConnection(host, port, show))

    def _isOff(self) -> bool:
        return self._link.status.state is LinkState.OFF

    def _startAfterSetup(self, error: str) -> None:
        startsNow, self._startsAfterSetup = self._startsAfterSetup and not error, False
        if startsNow:
            self._start()

    def _start(self) -> None:
        ui = self._ui
        with showErrors(_("The simulator could not be started.")):
            self._simulator.start(
                ui.portSpinBox.value,
                hasWindow=ui.windowCheckBox.checked,
                hasNetwork=ui.networkCheckBox.checked,
            )

    def _showProgram(self, _path: str = "") -> None:
        ui, setup, program = self._ui, self._simulator.setup, self._simulator.program
        if setup.isRunning:
            text = _("The simulator is being set up.")
        elif self._simulator.needsSetup and program.state is ProgramState.STOPPED:
            text = _("The simulator is not set up yet: see Set-up.")
        else:
            text = program.sentence
        setText(ui.programText, text)
        setText(ui.pairingText, program.pairingSentence)
        isEnding = program.state is ProgramState.STOPPING
        isUp = program.isRunning and not isEnding
        why = _("It is running.") if program.isRunning else _("It is being set up.")
        setEnabled(ui.startSimulatorButton, not (isUp or setup.isRunning), why)
        why = _("It is ending.") if isEnding else _("No simulator was started from here.")
        setEnabled(ui.stopSimulatorButton, isUp, why)
        if program.state is ProgramState.READY:
            setSilently(ui.portSpinBox, "value", program.port)

    def _showStatus(self, status: LinkStatus) -> None:
        self._showWords(status)
        isOff = status.state is LinkState.OFF
        ui = self._ui
        ui.connectButton.text = _("Connect") if isOff else _("Disconnect")
        ui.hostLineEdit.enabled = isOff
        ui.portSpinBox.enabled = isOff
        why = _("Disconnect first: the state of the connection is shown below.")
        setEnabled(ui.probeButton, isOff, why)
        if status.state is not LinkState.CONNECTED:
            setText(ui.trainingText, "")

    def _showWords(self, status: LinkStatus) -> None:
        setLight(self._ui.stateLight, LINK_COLORS[status.state])
        setText(self._ui.stateText, status.sentence)
        setText(self._ui.remedyText, status.remedy)


class RunningSimulatorPanel(Panel):
    """Wires its widgets to the session; visible only if a simulator was found."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._running = running = session.simulator.running
        self.connectToIt = guardedAction(running.connect, _("The connection could not be started."))
        ui.connectToRunningButton.connect("clicked()", self.connectToIt)
        connectClick(ui.endRunningButton, running.end, _("The simulator could not be ended."))
        self.listen((running.changed, self._show))
        running.look()
        self._show()

    def _show(self) -> None:
        ui, running = self._ui, self._running
        ui.runningSimulatorFrame.visible = running.holder is not None
        setText(ui.runningSimulatorText, running.sentence)
        why = _("Its address is not known.")
        setEnabled(ui.connectToRunningButton, running.canConnect, why)
        why = _("It is ending, or its process is not known.")
        setEnabled(ui.endRunningButton, running.canEnd, why)
