"""The section Simulator: set up, start, connect, and how the link is, in words and color."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import slicer

from rastrainer.panels.widgets import GRAY, GREEN, RED, YELLOW, light, setSentence, setUsable
from rastrainer.slicer.heartbeat import LinkState, LinkStatus
from rastrainer.slicer.probe import probe
from rastrainer.slicer.session import Session
from rastrainer.slicer.simulator_program import ProgramState
from rastrainer.slicer.translation import _

COLORS = {
    LinkState.OFF: GRAY,
    LinkState.NOT_INSTALLED: RED,
    LinkState.ABSENT: RED,
    LinkState.GREETING: YELLOW,
    LinkState.CONNECTED: GREEN,
    LinkState.STALE: YELLOW,
    LinkState.WRONG_VERSION: RED,
}
PROGRAM_SETTING = "RASTrainer/Program"
WHEELS_SETTING = "RASTrainer/Wheels"


class SimulatorPanel:
    """Wires the section's widgets to the session."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._link = session.link
        self._simulator = session.simulator
        settings = slicer.app.settings()
        ui.packageLineEdit.text = session.places.package
        ui.programPathLineEdit.currentPath = settings.value(PROGRAM_SETTING, "")
        ui.wheelsPathLineEdit.currentPath = settings.value(WHEELS_SETTING, "")
        ui.setupButton.connect("clicked()", self.setUpOrCancel)
        ui.startSimulatorButton.connect("clicked()", self.startSimulator)
        ui.stopSimulatorButton.connect("clicked()", self.stopSimulator)
        ui.programPathLineEdit.connect("currentPathChanged(QString)", self._keepPaths)
        ui.wheelsPathLineEdit.connect("currentPathChanged(QString)", self._keepPaths)
        ui.connectButton.connect("clicked()", self.toggleConnection)
        ui.probeButton.connect("clicked()", self.testConnection)
        self._listening = (
            (self._link.statusChanged, self._showStatus),
            (self._link.stateChanged, self._showTraining),
            (self._simulator.setup.progressed, self._log),
            (self._simulator.setup.finished, self._finishSetup),
            (self._simulator.program.wroteLine, self._log),
            (self._simulator.program.changed, self._showProgram),
            (self._simulator.program.pairingChanged, self._showPairing),
        )
        for signal, slot in self._listening:
            signal.connect(slot)
        self._showStatus(self._link.status)
        self._showProgram()
        self._showPairing()

    def close(self) -> None:
        """Listen to the session no more."""
        for signal, slot in self._listening:
            signal.disconnect(slot)

    def setUpOrCancel(self) -> None:
        """Begin the set-up, or break it off."""
        with slicer.util.tryWithErrorDisplay(_("The simulator could not be set up.")):
            if self._simulator.setup.isRunning:
                self._simulator.setup.cancel()
                return
            self._ui.simulatorLogEdit.clear()
            self._simulator.beginSetup(
                self._ui.packageLineEdit.text, self._ui.wheelsPathLineEdit.currentPath
            )
            self._ui.setupGroupBox.collapsed = False
            self._showProgram()

    def startSimulator(self) -> None:
        """Start the simulator on this computer."""
        with slicer.util.tryWithErrorDisplay(_("The simulator could not be started.")):
            program = self._ui.programPathLineEdit.currentPath
            self._simulator.start(
                self._ui.portSpinBox.value,
                program,
                hasWindow=self._ui.windowCheckBox.checked,
                hasNetwork=self._ui.networkCheckBox.checked,
            )

    def stopSimulator(self) -> None:
        """End the simulator that was started here."""
        with slicer.util.tryWithErrorDisplay(
            _("The simulator could not be stopped."), waitCursor=True
        ):
            self._simulator.stop()

    def toggleConnection(self) -> None:
        """Connect to the simulator, or disconnect."""
        with slicer.util.tryWithErrorDisplay(_("The connection could not be begun.")):
            if self._link.status.state is LinkState.OFF:
                self._link.connectTo(self._ui.hostLineEdit.text, self._ui.portSpinBox.value)
            else:
                self._link.disconnect()

    def testConnection(self) -> None:
        """Look once whether a simulator answers, and say so."""
        with slicer.util.tryWithErrorDisplay(
            _("The connection could not be tested."), waitCursor=True
        ):
            self._showWords(probe(self._ui.hostLineEdit.text, self._ui.portSpinBox.value))

    def _showProgram(self) -> None:
        ui, setup, program = self._ui, self._simulator.setup, self._simulator.program
        hasOwn = bool(ui.programPathLineEdit.currentPath)
        needsSetup = self._simulator.needsSetup and not hasOwn
        if setup.isRunning:
            ui.programText.text = _("The simulator is being set up. This takes some minutes.")
        elif needsSetup and program.state is ProgramState.STOPPED:
            old = setup.installedVersion
            ui.programText.text = (
                _("The simulator that is set up is of version {old}: set it up anew.").format(
                    old=old
                )
                if old
                else _("The simulator is not set up on this computer yet: press Set up, once.")
            )
        else:
            ui.programText.text = program.sentence
        ui.setupProgressBar.visible = setup.isRunning
        ui.setupButton.text = _("Cancel") if setup.isRunning else _("Set up")
        setUsable(
            ui.setupButton,
            not program.isRunning,
            _("Install the simulator into a folder of its own, by Slicer's own Python."),
            _("Stop the simulator first."),
        )
        reason = _("Set it up first.") if needsSetup else _("It is being set up.")
        if program.isRunning:
            reason = _("It runs already.")
        setUsable(
            ui.startSimulatorButton,
            not (program.isRunning or setup.isRunning or needsSetup),
            _("Start the simulator on this computer and connect to it."),
            reason,
        )
        setUsable(
            ui.stopSimulatorButton,
            program.isRunning,
            _("End the simulator that was started here. Recorded trials stay."),
            _("No simulator was started from here."),
        )
        if program.state is ProgramState.READY:
            ui.portSpinBox.value = program.port

    def _showPairing(self) -> None:
        setSentence(self._ui.pairingText, self._simulator.program.pairingSentence)

    def _finishSetup(self, error: str) -> None:
        self._log(error or _("The simulator is set up."))
        self._showProgram()
        if error:
            self._ui.programText.text = error

    def _keepPaths(self, _path: str = "") -> None:
        settings = slicer.app.settings()
        settings.setValue(PROGRAM_SETTING, self._ui.programPathLineEdit.currentPath)
        settings.setValue(WHEELS_SETTING, self._ui.wheelsPathLineEdit.currentPath)
        self._showProgram()

    def _log(self, line: str) -> None:
        self._ui.simulatorLogEdit.appendPlainText(line)

    def _showStatus(self, status: LinkStatus) -> None:
        self._showWords(status)
        isOff = status.state is LinkState.OFF
        ui = self._ui
        ui.connectButton.text = _("Connect") if isOff else _("Disconnect")
        ui.hostLineEdit.enabled = isOff
        ui.portSpinBox.enabled = isOff
        setUsable(
            ui.probeButton,
            isOff,
            _("Look once whether a simulator answers at this host and port."),
            _("Disconnect first: the state below tells how the connection is."),
        )
        if status.state is not LinkState.CONNECTED:
            setSentence(ui.trainingText, "")

    def _showWords(self, status: LinkStatus) -> None:
        self._ui.stateLight.text = light(COLORS[status.state])
        self._ui.stateText.text = status.sentence
        setSentence(self._ui.remedyText, status.remedy)

    def _showTraining(self, state: Mapping[str, Any]) -> None:
        setSentence(self._ui.trainingText, str(state.get("instruction", "")))
