"""The sections Set-up and Simulator: its packages, start, connection, and one left running."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.slicer.link.link_status import LinkState, LinkStatus
from rastrainer.slicer.program.simulator_program import ProgramState
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.settings import HAS_NETWORK, HAS_WINDOW, HOST, INDEX, PORT, PROGRAM, WHEELS
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    LINK_LOOKS,
    bind,
    connectAsPressed,
    setEnabled,
    setLight,
    setProperty,
    setSilently,
    setText,
)
from rastrainer.widgets.plain_text import toolTip
from rastrainer.widgets.shown_errors import guardedAction


class SetupPanel(Panel):
    """The section Set-up; open while there is something to set up."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._simulator = session.simulator
        bind(ui.indexLineEdit, "text", session.settings, INDEX)
        bind(ui.wheelsPathLineEdit, "currentPath", session.settings, WHEELS)
        bind(ui.programPathLineEdit, "currentPath", session.settings, PROGRAM)
        ui.indexLineEdit.connect("textChanged(QString)", self._show)
        ui.wheelsPathLineEdit.connect("currentPathChanged(QString)", self._show)
        setup = self._simulator.setup
        setUp = guardedAction(self._setUp, _("The simulator could not be set up."))
        connectAsPressed(ui.setupButton, lambda: setup.cancel if setup.isRunning else setUp)
        connectClick(ui.removeSetupButton, self._remove, _("The simulator could not be removed."))
        self.listen(
            (setup.progressed, ui.setupLogEdit.appendPlainText),
            (setup.progressed, self._show),
            (setup.changed, self._show),
            (setup.finished, self._finish),
            (self._simulator.program.changed, self._show),
        )
        self._show()
        ui.setupCollapsibleButton.collapsed = not self._simulator.needsSetup

    def _setUp(self) -> None:
        ui = self._ui
        ui.setupLogEdit.clear()
        self._simulator.startSetup(ui.indexLineEdit.text, ui.wheelsPathLineEdit.currentPath)

    def _remove(self) -> None:
        question = _(
            "Remove the simulator, the folder {folder}, from this computer? Trials, studies "
            "and scenarios stay. It can be set up again at any time."
        ).format(folder=self._simulator.setup.folder)
        if slicer.util.confirmYesNoDisplay(toolTip(question), _("Remove the simulator")):
            self._simulator.removeSetup()
            self._ui.setupCollapsibleButton.collapsed = False

    def _show(self, _text: str = "") -> None:
        ui, setup = self._ui, self._simulator.setup
        runs = self._simulator.program.isRunning
        setText(ui.setupText, self._sentence())
        isFetching = setup.isRunning and not setup.isInstalling
        # A maximum of 0 makes a busy indicator.
        setProperty(ui.setupProgressBar, "maximum", setup.count if isFetching else 0)
        setProperty(ui.setupProgressBar, "value", setup.fetched if isFetching else 0)
        setProperty(ui.setupProgressBar, "visible", setup.isRunning)
        setProperty(ui.setupButton, "text", _("Cancel") if setup.isRunning else _("Set up"))
        stopFirst, none = _("Stop the simulator first."), _("There is nothing to remove.")
        setEnabled(ui.setupButton, not runs, stopFirst)
        mayRemove = setup.folder.is_dir() and not (runs or setup.isRunning)
        setEnabled(ui.removeSetupButton, mayRemove, stopFirst if runs else none)

    def _sentence(self) -> str:
        setup = self._simulator.setup
        if setup.isRunning and setup.isCanceled:
            return _("The set-up is ending.")
        if setup.isRunning and setup.isInstalling:
            return _("All packages are downloaded and are being installed.")
        if setup.isRunning:
            text = _("Package {number} of {count} is being downloaded.")
            return text.format(number=setup.fetched, count=setup.count)
        if setup.isCurrent:
            size = setup.installedMB
            sentence = _("The simulator is set up in {folder}.").format(folder=setup.folder)
            takes = _("It takes {size} MB; Remove deletes it.")
            return sentence if size is None else f"{sentence} {takes.format(size=size)}"
        need = _("The simulator is not set up on this computer yet: press Set up, once.")
        if setup.installedVersion:
            need = _(
                "The installed simulator, version {old}, does not match this module: set it up "
                "again."
            ).format(old=setup.installedVersion)
        return f"{need} {costSentence(self._ui, setup)}"

    def _finish(self, error: str) -> None:
        self._ui.setupLogEdit.appendPlainText(error or _("The simulator is set up."))
        self._show()
        if error:
            setText(self._ui.setupText, error)
        self._ui.setupCollapsibleButton.collapsed = not self._simulator.needsSetup


def costSentence(ui: Any, setup: SimulatorSetup) -> str:
    """State source, size and folder before anything is done."""
    source = _("the public package index of Python")
    if ui.wheelsPathLineEdit.currentPath:
        source = _("the folder {path}").format(path=ui.wheelsPathLineEdit.currentPath)
    elif ui.indexLineEdit.text:
        source = _("the package index {address}").format(address=ui.indexLineEdit.text)
    where = _(
        "The simulator itself comes with this module. What it needs comes from {source}, each "
        "file verified by its hash, and is installed in {folder}."
    ).format(source=source, folder=setup.folder)
    sizes = setup.package.sizesMB()
    if sizes is None:
        return where
    size = _("About {download} MB will be downloaded, and {kept} MB kept.")
    return f"{where} {size.format(download=sizes[0], kept=sizes[1])}"


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
        self._start = guardedAction(self._startProgram, _("The simulator could not be started."))
        self.connect = guardedAction(self._connect, _("The connection could not be started."))
        ui.startSimulatorButton.connect("clicked()", self.startAndConnect)
        notStopped = _("The simulator could not be stopped.")
        connectClick(ui.stopSimulatorButton, self._simulator.stop, notStopped)
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

    def _connect(self) -> None:
        """Connect to the simulator, unless a connection is already being made."""
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

    def _startProgram(self) -> None:
        port, ui = self._ui.portSpinBox.value, self._ui
        self._simulator.start(port, ui.windowCheckBox.checked, ui.networkCheckBox.checked)

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
        ui, isOff = self._ui, status.state is LinkState.OFF
        ui.connectButton.text = _("Connect") if isOff else _("Disconnect")
        ui.hostLineEdit.enabled = ui.portSpinBox.enabled = isOff
        why = _("Disconnect first: the state of the connection is shown below.")
        setEnabled(ui.probeButton, isOff, why)
        if not status.isConnected:
            setText(ui.trainingText, "")

    def _showWords(self, status: LinkStatus) -> None:
        setLight(self._ui.stateLight, LINK_LOOKS[status.state][0])
        setText(self._ui.stateText, status.sentence)
        setText(self._ui.remedyText, status.remedy)


class RunningSimulatorPanel(Panel):
    """Wires its widgets to the session; visible only if a simulator was found."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._running = running = session.simulator.running
        failure = _("The connection could not be started.")
        self.connectToIt = connectClick(ui.connectToRunningButton, running.connect, failure)
        connectClick(ui.endRunningButton, running.end, _("The simulator could not be ended."))
        self.listen((running.changed, self._show))
        running.look()
        self._show()

    def _show(self) -> None:
        ui, running = self._ui, self._running
        ui.runningSimulatorFrame.visible = running.holder is not None
        setText(ui.runningSimulatorText, running.sentence)
        setEnabled(ui.connectToRunningButton, running.canConnect, _("Its address is not known."))
        why = _("It is ending, or its process is not known.")
        setEnabled(ui.endRunningButton, running.canEnd, why)
