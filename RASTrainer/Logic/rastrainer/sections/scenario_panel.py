"""The section Scenario: head, task, robot, other heads, and each method of registration on one."""

from __future__ import annotations

import os
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.number_text import fixed
from rastrainer.protocol import DECIDE, TRIAL_RUN, RegistrationMethod
from rastrainer.sections.application import askWhereToSave, fitSliceViews, fitThreeDViews
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, chosenScenario
from rastrainer.sections.scenario_files import compareMethods
from rastrainer.sections.training_panel import METHODS
from rastrainer.slicer.settings import SCENARIO, TASK
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    CancelableWork,
    chosenData,
    fillComboBox,
    fillTable,
    offerEntries,
    setEnabled,
    setSilently,
    setText,
    showPercent,
)
from rastrainer.widgets.plain_text import toolTip
from rastrainer.widgets.shown_errors import showErrors
from rastrainer.work_progress import no_progress

PICTURE_HEIGHT = 180


class ScenarioPanel(Panel):
    """The section Scenario."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.scenario
        self._scenarios, self._files = session.scenarios, session.scenarioFiles
        failure = _("This cannot be used as the head.")
        self._showHeadMessage = partial(setText, ui.otherHeadText)
        shows = (self._showHeadMessage, self._showUsable, partial(showPercent, ui.otherHeadText))
        self._work = CancelableWork(ui.useHeadButton, self.useHead, failure, *shows)
        failure = _("The scenario was not saved.")
        button, says = ui.exportScenarioButton, self._showMessage
        self._writing = CancelableWork(button, self.exportScenario, failure, says, show=no_progress)
        button, failure = ui.importScenarioButton, _("The scenario was not added.")
        self._adding = CancelableWork(button, self.importScenario, failure, self._showMessage)
        ui.scenarioComboBox.connect("activated(int)", self._showTasks)
        ui.taskComboBox.connect("activated(int)", self._chooseTask)
        for combo in (ui.scenarioComboBox, ui.taskComboBox):
            combo.connect("activated(int)", self._keepChoice)
        ui.showScenarioButton.connect("clicked()", self.show)
        ui.loadScenarioButton.connect("clicked()", self.loadIntoSimulator)
        ui.robotCheckBox.connect("toggled(bool)", self._logic.setRobotShown)
        ui.headModelComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._showUsable)

        def showRobot() -> None:
            setSilently(ui.robotCheckBox, "checked", self._logic.isRobotShown)

        self.listen(
            (session.link.statusChanged, self._showUsable),
            (session.training.answered, self._showMessage),
            (session.scenarioMade, self.continueWith),
            (session.files.shown, self._frame),
            (session.files.problemFound, self._showMessage),
            (self._logic.robotShown, fitThreeDViews),
            (self._logic.problemFound, self._showMessage),
            (session.sceneChanged, showRobot),
        )
        self._fill(session.settings.get(SCENARIO))

    def show(self) -> None:
        def showTarget() -> None:
            self._session.slices.show(scenario.target.position_ras)
            fitThreeDViews()

        with showErrors(_("The scenario cannot be shown.")):
            scenario = chosenScenario(self._ui, self._session)
            task = self._session.task
            shown = scenario.tasks[0].name if task == DECIDE else task
            self._logic.show(scenario.name, shown, showTarget)

    def loadIntoSimulator(self) -> None:
        with showErrors(_("The scenario was not loaded.")):
            scenario = chosenScenario(self._ui, self._session)
            asked = _("The simulator was asked to load {title}.")
            loaded = _("The simulator now uses {title}.").format(title=scenario.title)
            self._showMessage(asked.format(title=scenario.title))
            self._session.training.loadScenario(scenario.name, lambda: self._showMessage(loaded))

    def useHead(self) -> None:
        node = self._ui.headModelComboBox.currentNode()
        used = self._work.run(lambda report: self._logic.useHead(node, report))
        if used is not None:
            model, warnings = used
            fitThreeDViews()
            text = _("{name} is now the head; the simulator keeps its own head.")
            self._showHeadMessage(" ".join([text.format(name=model.GetName()), *warnings]))

    def importScenario(self) -> None:
        window, caption = slicer.util.mainWindow(), _("Add a scenario")
        path = qt.QFileDialog.getOpenFileName(window, caption, "", "Zip (*.zip)")
        if not path:
            return
        added = self._adding.run(lambda report: self._files.importScenario(Path(path), report))
        if added is not None:
            self._fill(added.name)
            self._showMessage(_("{title} was added.").format(title=added.title))

    def exportScenario(self) -> None:
        """Write a scenario; one without its face and skull only once the user has seen it."""
        name = chosenData(self._ui.scenarioComboBox)
        keepsNames = not self._ui.removeNamesCheckBox.checked
        # Title, name, source and a file named after them may be the patient's name.
        proposed = f"{name}.zip" if keepsNames else "head.zip"
        path = askWhereToSave(_("Save the scenario"), proposed, "Zip (*.zip)")
        removesFace = self._ui.removeFaceCheckBox.checked
        if path is None or (removesFace and not self._isFaceGone(name)):
            return
        options = ["--yes" if removesFace else "--keep-face", *["--keep-names"] * keepsNames]
        taken = self._writing.run(partial(self._files.pack, name, str(path), options))
        if taken is not None:
            self._showMessage(_("{path} was written.").format(path=path) + f" {taken}")

    def _isFaceGone(self, name: str) -> bool:
        """Show a scenario's head before and after its face is removed, and ask the user."""
        with tempfile.TemporaryDirectory() as temporary:
            picture = str(Path(temporary, "before-and-after.png"))
            options = ["--picture", picture]
            drawn = self._writing.run(partial(self._files.pack, name, os.devnull, options))
            if drawn is None:
                return False
            text, title = _("Is the face gone?"), _("Save the scenario without its face")
            ask, shown = slicer.util.confirmYesNoDisplay, qt.QPixmap(picture)
            return bool(ask(toolTip(f"{drawn} {text}"), title, iconPixmap=shown))

    def continueWith(self, name: str) -> None:
        """Choose a scenario that has just been made, show it, and have the simulator take it."""
        self._ui.scenarioCollapsibleButton.collapsed = False
        self._fill(name)
        self._keepChoice()
        self.show()
        if self._session.link.status.isConnected:
            self.loadIntoSimulator()

    def _frame(self, node: Any) -> None:
        """Fit the views to a newly loaded head, or to newly loaded images."""
        later = self._session.work.later
        if node.IsA("vtkMRMLModelNode"):
            fitThreeDViews()
        else:
            fitSliceViews(later)
            later(self._session.slices.showAgain)

    def _fill(self, wanted: str = "") -> None:
        """Offer the available scenarios, and choose one; the first if it is missing."""
        listed = self._scenarios.listed()
        names = [entry.name for entry in listed if not entry.problem] or [""]
        chosen = wanted if wanted in names else names[0]
        combo = self._ui.scenarioComboBox
        fillComboBox(combo, [(entry.title, entry.name) for entry in listed], chosen)
        for row, entry in enumerate(listed):
            if entry.preview is not None:
                combo.setItemIcon(row, qt.QIcon(str(entry.preview)))
        self._showTasks()

    def _showTasks(self, _index: int = 0) -> None:
        """Show the chosen scenario's picture and tasks, or why it cannot be used."""
        ui = self._ui
        name = chosenData(ui.scenarioComboBox)
        entry = next((each for each in self._scenarios.listed() if each.name == name), None)
        preview = entry and entry.preview
        ui.scenarioPicture.visible = preview is not None
        if preview is not None:
            picture = qt.QPixmap(str(preview)).scaledToHeight(PICTURE_HEIGHT)
            ui.scenarioPicture.setPixmap(picture)
        ui.taskComboBox.enabled = isUsable = entry is not None and not entry.problem
        self._showUsable()
        if not isUsable:
            self._showMessage(_("There is no scenario.") if entry is None else entry.problem)
            return
        scenario = self._scenarios.find(name)
        tasks = [(task.title, task.name) for task in scenario.tasks]
        tasks.append((_("Decide"), DECIDE))
        last = self._session.task or self._session.settings.get(TASK)
        others = (task for _title, task in tasks if task != TRIAL_RUN)
        offerEntries(ui.taskComboBox, tasks, last, *others)
        self._chooseTask()

    def _chooseTask(self, _index: int = 0) -> None:
        scenario = chosenScenario(self._ui, self._session)
        name = chosenData(self._ui.taskComboBox)
        task = None if name == DECIDE else scenario.task(name)
        self._session.chooseTask(task, scenario)
        text = _("Twenty registrations of this head: proceed, register again or stop?")
        if task is not None:
            text = _("{count} fiducials, complexity {complexity:.2f}; target: {target}.").format(
                count=len(task.labels), complexity=task.complexity, target=scenario.target.name
            )
        self._showMessage(text)

    def _keepChoice(self, _index: int = 0) -> None:
        settings, ui = self._session.settings, self._ui
        settings.set(SCENARIO, chosenData(ui.scenarioComboBox))
        settings.set(TASK, chosenData(ui.taskComboBox))

    def _showUsable(self, *_arguments: Any) -> None:
        ui = self._ui
        isConnected = self._session.link.status.isConnected
        isUsable, reason = ui.taskComboBox.enabled, _("Connect to the simulator first.")
        ui.showScenarioButton.enabled = ui.exportScenarioButton.enabled = isUsable
        if not isUsable:
            reason = _("Choose a scenario that can be used.")
        setEnabled(ui.loadScenarioButton, isConnected and isUsable, reason)
        mayUse = ui.headModelComboBox.currentNode() is not None or self._work.isUnderWay
        reason = _("Choose a model or a volume of the scene first.")
        setEnabled(ui.useHeadButton, mayUse, reason)

    def _showMessage(self, sentence: str) -> None:
        if sentence:
            setText(self._ui.scenarioText, sentence)


METHOD_NAMES = {
    **METHODS,
    RegistrationMethod.BONE_SCREWS.value: _("Bone screws"),
    RegistrationMethod.SCAN.value: _("Range camera"),
}


class MethodsPanel(Panel):
    """The group Methods of registration."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._showMessage = partial(setText, ui.methodsText)
        button, failure = ui.compareMethodsButton, _("The methods were not compared.")
        self._work = CancelableWork(button, self.compare, failure, self._showMessage)
        self._showMessage("")

    def compare(self) -> None:
        ui, simulator = self._ui, self._session.simulator
        scenario = chosenScenario(ui, self._session)
        trials, shift = ui.methodTrialsSpinBox.value, ui.methodShiftSpinBox.value
        self._showMessage(_("Trials are being simulated and registered."))
        found = self._work.run(partial(compareMethods, simulator, scenario, trials, shift))
        if found is not None:
            interval, percent = _("{low} to {high}"), _("{share} %")
            rows = []
            for name, (*lengths, share, low, high) in found.items():
                shown = (fixed(mm, 2) for mm in lengths)
                ends = interval.format(low=fixed(low, 2), high=fixed(high, 2))
                held = percent.format(share=fixed(100.0 * share, 0))
                rows.append((METHOD_NAMES.get(name, name), *shown, ends, held))
            fillTable(ui.methodsTable, rows)
            text = _(
                "Residuals of different methods are of different points: they do not show which "
                "is better. The true error does."
            )
            few = _("The head has too few landmarks for the other methods.")
            self._showMessage(text if len(found) == len(METHOD_NAMES) else f"{text} {few}")
