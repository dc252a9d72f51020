"""The section Set-up: where the simulator comes from, its size, and its removal."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.settings import INDEX, PROGRAM, WHEELS
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import bind, connectAsPressed, setEnabled, setText
from rastrainer.widgets.plain_text import toolTip
from rastrainer.widgets.shown_errors import showErrors


class SetupPanel(Panel):
    """Wires the section's widgets to the session; open while there is something to set up."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._simulator = session.simulator
        bind(ui.indexLineEdit, "text", session.settings, INDEX)
        bind(ui.wheelsPathLineEdit, "currentPath", session.settings, WHEELS)
        bind(ui.programPathLineEdit, "currentPath", session.settings, PROGRAM)
        ui.indexLineEdit.connect("textChanged(QString)", self._showSetup)
        ui.wheelsPathLineEdit.connect("currentPathChanged(QString)", self._showSetup)
        setup = self._simulator.setup
        connectAsPressed(ui.setupButton, lambda: setup.cancel if setup.isRunning else self.setUp)
        connectClick(ui.removeSetupButton, self.remove, _("The simulator could not be removed."))
        self.listen(
            (setup.progressed, self._follow),
            (setup.changed, self._showSetup),
            (setup.finished, self._finish),
            (self._simulator.program.changed, self._showSetup),
        )
        self._showSetup()
        ui.setupCollapsibleButton.collapsed = not self._simulator.needsSetup

    def setUp(self) -> None:
        with showErrors(_("The simulator could not be set up.")):
            self._ui.setupLogEdit.clear()
            self._simulator.startSetup(
                self._ui.indexLineEdit.text, self._ui.wheelsPathLineEdit.currentPath
            )

    def remove(self) -> None:
        question = _(
            "Remove the simulator, the folder {folder}, from this computer? Trials, studies "
            "and scenarios stay. It can be set up again at any time."
        ).format(folder=self._simulator.setup.folder)
        if slicer.util.confirmYesNoDisplay(toolTip(question), _("Remove the simulator")):
            self._simulator.removeSetup()
            self._ui.setupCollapsibleButton.collapsed = False

    def _showSetup(self, _text: str = "") -> None:
        ui, setup = self._ui, self._simulator.setup
        runs = self._simulator.program.isRunning
        self._showProgress()
        ui.setupProgressBar.visible = setup.isRunning
        ui.setupButton.text = _("Cancel") if setup.isRunning else _("Set up")
        stopFirst, none = _("Stop the simulator first."), _("There is nothing to remove.")
        setEnabled(ui.setupButton, not runs, stopFirst)
        mayRemove = setup.folder.is_dir() and not (runs or setup.isRunning)
        setEnabled(ui.removeSetupButton, mayRemove, stopFirst if runs else none)

    def _showProgress(self) -> None:
        ui, setup = self._ui, self._simulator.setup
        setText(ui.setupText, self._sentence())
        isFetching = setup.isRunning and not setup.isInstalling
        # A maximum of 0 makes a busy indicator.
        ui.setupProgressBar.maximum = setup.count if isFetching else 0
        ui.setupProgressBar.value = setup.fetched if isFetching else 0

    def _sentence(self) -> str:
        setup = self._simulator.setup
        if setup.isRunning and setup.isCanceled:
            return _("The set-up is ending.")
        if setup.isRunning and setup.isInstalling:
            return _("All packages are downloaded and are being installed.")
        if setup.isRunning:
            return _("Package {number} of {count} is being downloaded.").format(
                number=setup.fetched, count=setup.count
            )
        if setup.isCurrent:
            size = setup.installedMB
            sentence = _("The simulator is set up in {folder}.").format(folder=setup.folder)
            takes = _("It takes {size} MB; Remove deletes it.")
            return sentence if size is None else f"{sentence} {takes.format(size=size)}"
        old = setup.installedVersion
        need = _("The simulator is not set up on this computer yet: press Set up, once.")
        if old:
            need = _(
                "The installed simulator, version {old}, does not match this module: set it up "
                "again."
            ).format(old=old)
        return f"{need} {costSentence(self._ui, setup)}"

    def _follow(self, line: str) -> None:
        self._ui.setupLogEdit.appendPlainText(line)
        self._showProgress()

    def _finish(self, error: str) -> None:
        self._ui.setupLogEdit.appendPlainText(error or _("The simulator is set up."))
        self._showSetup()
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
    size = _("About {download} MB will be downloaded, and {kept} MB kept.").format(
        download=sizes[0], kept=sizes[1]
    )
    return f"{where} {size}"
