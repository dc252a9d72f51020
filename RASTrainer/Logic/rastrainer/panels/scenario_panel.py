"""The section Scenario: the head, the task, the robot, and other heads to look at."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.panels.widgets import chosenData, fillComboBox, setChecked, setUsable
from rastrainer.protocol import TRIAL_RUN
from rastrainer.slicer.heartbeat import LinkState
from rastrainer.slicer.placing import jumpTo
from rastrainer.slicer.session import Session
from rastrainer.slicer.translation import _

SAMPLE = "MRBrainTumor1"


class ScenarioPanel:
    """Wires the section's widgets to the session."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._session = session
        self._desk = session.scenario
        ui.scenarioComboBox.connect("activated(int)", self._showTasks)
        ui.taskComboBox.connect("activated(int)", self._chooseTask)
        ui.showScenarioButton.connect("clicked()", self.show)
        ui.loadScenarioButton.connect("clicked()", self.loadIntoSimulator)
        ui.robotCheckBox.connect("toggled(bool)", self.showRobot)
        ui.useHeadButton.connect("clicked()", self.useHead)
        ui.sampleDataButton.connect("clicked()", self.loadSampleData)
        ui.headModelComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._showUsable)
        session.link.statusChanged.connect(self._showUsable)
        session.training.answered.connect(self._tell)
        self._fill()

    def close(self) -> None:
        """Listen to the session no more."""
        self._session.link.statusChanged.disconnect(self._showUsable)
        self._session.training.answered.disconnect(self._tell)

    def show(self) -> None:
        """Show the chosen head and the fiducials of the chosen task."""
        with slicer.util.tryWithErrorDisplay(_("The scenario cannot be shown."), waitCursor=True):
            name = chosenData(self._ui.scenarioComboBox)
            self._desk.show(name, self._session.task)
            jumpTo(slicer.mrmlScene, self._desk.find(name).target_position)
            slicer.util.resetThreeDViews()

    def loadIntoSimulator(self) -> None:
        """Let the simulator go on with the chosen head."""
        with slicer.util.tryWithErrorDisplay(_("The scenario was not loaded.")):
            scenario = self._session.scenario.find(chosenData(self._ui.scenarioComboBox))
            self._session.training.loadScenario(str(scenario.folder))
            self._tell(_("The simulator is asked to load {title}.").format(title=scenario.title))

    def showRobot(self, shown: bool) -> None:
        """Show the robot in the 3D view, or hide it."""
        with slicer.util.tryWithErrorDisplay(_("The robot cannot be shown.")):
            self._desk.setRobotShown(shown)

    def useHead(self) -> None:
        """Look at a model, or at the skin of a volume, as the head."""
        with slicer.util.tryWithErrorDisplay(
            _("This cannot be used as the head."), waitCursor=True
        ):
            model = self._desk.useHead(self._ui.headModelComboBox.currentNode(), self._progress)
            self._ui.otherHeadText.text = _(
                "{name} is the head now; the simulator keeps its own."
            ).format(name=model.GetName())

    def loadSampleData(self) -> None:
        """Download an MRI through Slicer's Sample Data."""
        with slicer.util.tryWithErrorDisplay(
            _("The sample could not be downloaded; check the network."), waitCursor=True
        ):
            logic = slicer.util.getModuleLogic("SampleData")
            volume = logic.downloadSample(SAMPLE)
            application = slicer.app.applicationLogic()
            application.GetSelectionNode().SetActiveVolumeID(volume.GetID())
            application.PropagateVolumeSelection()
            self._ui.otherHeadText.text = _("{name} is in the scene.").format(name=volume.GetName())

    def _progress(self, step: str, share: float) -> None:
        self._ui.otherHeadText.text = f"{step}: {100 * share:.0f} %"
        slicer.app.processEvents()

    def showState(self) -> None:
        """Show what may have changed in the scene meanwhile."""
        setChecked(self._ui.robotCheckBox, self._desk.isRobotShown)

    def _fill(self) -> None:
        try:
            entries = [(scenario.title, scenario.name) for scenario in self._desk.scenarios()]
        except InputError as error:
            self._tell(str(error))
            return
        fillComboBox(self._ui.scenarioComboBox, entries, entries[0][1] if entries else "")
        self._showTasks()
        self._showUsable()

    def _showTasks(self, _index: int = 0) -> None:
        name = chosenData(self._ui.scenarioComboBox)
        if not name:
            return
        scenario = self._desk.find(name)
        tasks = [(task.title, task.name) for task in scenario.tasks]
        known = [task for _title, task in tasks]
        first = next((task for task in known if task != TRIAL_RUN), known[0])
        chosen = self._session.task if self._session.task in known else first
        fillComboBox(self._ui.taskComboBox, tasks, chosen)
        self._chooseTask()

    def _chooseTask(self, _index: int = 0) -> None:
        scenario = self._desk.find(chosenData(self._ui.scenarioComboBox))
        task = scenario.task(chosenData(self._ui.taskComboBox))
        self._session.chooseTask(task.name, task.title)
        self._tell(
            _("{count} fiducials, complexity {complexity:.2f}; target: {target}.").format(
                count=len(task.labels), complexity=task.complexity, target=scenario.target_name
            )
        )

    def _showUsable(self, *_arguments: Any) -> None:
        isConnected = self._session.link.status.state is LinkState.CONNECTED
        setUsable(
            self._ui.loadScenarioButton,
            isConnected,
            _("Let the simulator go on with this head; only between two trials."),
            _("Connect to the simulator first."),
        )
        setUsable(
            self._ui.useHeadButton,
            self._ui.headModelComboBox.currentNode() is not None,
            _("Look at this as the head, instead of the one above; of a volume, at its skin."),
            _("Choose a model or a volume of the scene first."),
        )

    def _tell(self, sentence: str) -> None:
        if sentence:
            self._ui.scenarioText.text = sentence
