"""The section Set-up: where the simulator comes from, its size, and its removal."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.panels.panel import Panel, connectClick
from rastrainer.panels.plain_text import toolTip
from rastrainer.panels.shown_errors import showErrors
from rastrainer.panels.widgets import bindPath, bindText, connectAsPressed, setText, setUsable
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.program.simulator_setup import SimulatorSetup
from rastrainer.slicer.settings import INDEX, PROGRAM, WHEELS
from rastrainer.slicer.translation import _


class SetupPanel(Panel):
    """Wires the section's widgets to the session; open while there is something to set up."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._simulator = session.simulator
        bindText(ui.indexLineEdit, session.settings, INDEX)
        bindPath(ui.wheelsPathLineEdit, session.settings, WHEELS)
        bindPath(ui.programPathLineEdit, session.settings, PROGRAM)
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
        """Start the set-up."""
        with showErrors(_("The simulator could not be set up.")):
            self._ui.setupLogEdit.clear()
            self._simulator.startSetup(
                self._ui.indexLineEdit.text, self._ui.wheelsPathLineEdit.currentPath
            )

    def remove(self) -> None:
        """Remove what was set up, after asking."""
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
        setUsable(
            ui.setupButton,
            not runs,
            _("Install the simulator into its own folder, with Slicer's Python."),
            _("Stop the simulator first."),
        )
        setUsable(
            ui.removeSetupButton,
            setup.isInstalled and not (runs or setup.isRunning),
            _("Remove the simulator's folder from this computer. Trials and studies stay."),
            _("Stop the simulator first.") if runs else _("There is nothing to remove."),
        )

    def _showProgress(self) -> None:
        ui, setup = self._ui, self._simulator.setup
        setText(ui.setupText, self._sentence())
        isFetching = setup.isRunning and not setup.progress.isInstalling
        # A maximum of 0 makes a busy indicator.
        ui.setupProgressBar.maximum = setup.progress.count if isFetching else 0
        ui.setupProgressBar.value = setup.progress.done if isFetching else 0

    def _sentence(self) -> str:
        setup = self._simulator.setup
        if setup.isEnding:
            return _("The set-up is ending.")
        if setup.isRunning:
            return self._progressSentence()
        if setup.isCurrent:
            size = setup.installedMB
            sentence = _("The simulator is set up in {folder}.").format(folder=setup.folder)
            return sentence if size is None else f"{sentence} {self._holds(size)}"
        old = setup.installedVersion
        need = _("The simulator is not set up on this computer yet: press Set up, once.")
        if old:
            need = _(
                "The installed simulator, version {old}, does not match this module: set it up "
                "again."
            ).format(old=old)
        return f"{need} {costSentence(self._ui, setup)}"

    def _holds(self, size: int) -> str:
        return _("It takes {size} MB; Remove deletes it.").format(size=size)

    def _progressSentence(self) -> str:
        progress = self._simulator.setup.progress
        if progress.isInstalling:
            return _("All packages are downloaded and are being installed.")
        return _("Package {number} of {count} is being downloaded.").format(
            number=progress.done, count=progress.count
        )

    def _follow(self, line: str) -> None:
        self._log(line)
        self._showProgress()

    def _finish(self, error: str) -> None:
        self._log(error or _("The simulator is set up."))
        self._showSetup()
        if error:
            setText(self._ui.setupText, error)
        self._ui.setupCollapsibleButton.collapsed = not self._simulator.needsSetup

    def _log(self, line: str) -> None:
        self._ui.setupLogEdit.appendPlainText(line)


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
    sizes = setup.package.sizes()
    if sizes is None:
        return where
    size = _("About {download} MB will be downloaded, and {kept} MB kept.").format(
        download=sizes.downloadMB, kept=sizes.keptMB
    )
    return f"{where} {size}"
