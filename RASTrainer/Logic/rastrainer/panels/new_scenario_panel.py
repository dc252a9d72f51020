"""The section New scenario: from a volume to something to train on."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.panels.cancelable_work import CancelableWork
from rastrainer.panels.fitted_views import fitThreeDViews
from rastrainer.panels.setup_form import SetUpForm
from rastrainer.panels.widgets import setSentence, setUsable
from rastrainer.scenario import Scenario
from rastrainer.slicer.sample_download import downloadSample
from rastrainer.slicer.scenario_maker import ScenarioWishes
from rastrainer.slicer.session import Session
from rastrainer.slicer.translation import _

SAMPLE = "MRBrainTumor1"


class NewScenarioPanel:
    """Wires the section's widgets to the session."""

    def __init__(self, ui: Any, session: Session) -> None:
        self._ui = ui
        self._session = session
        self._maker = session.scenarioMaker
        self._setUp = SetUpForm(ui.setUpGroupBox)
        self._work = CancelableWork(self._tell, self._showProgress, self._showUsable)
        ui.sampleDataButton.connect("clicked()", self.loadSampleData)
        ui.makeScenarioButton.connect("clicked()", self.makeOrCancel)
        ui.previewHeadButton.connect("clicked()", self.preview)
        ui.checkScenarioButton.connect("clicked()", self.check)
        ui.scanComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._showUsable)
        ui.newScenarioCollapsibleButton.connect("contentsCollapsed(bool)", self._takeShownVolume)
        setSentence(ui.newScenarioText, "")
        self._showUsable()

    def close(self) -> None:
        """Break off what is under way."""
        self._work.cancel()

    def loadSampleData(self) -> None:
        """Download an MRI through Slicer's Sample Data, and choose it."""
        with slicer.util.tryWithErrorDisplay(_("There is no sample."), waitCursor=True):
            logic = slicer.util.getModuleLogic("SampleData")
            volume = self._work.run(
                lambda tell: downloadSample(slicer.mrmlScene, logic, SAMPLE, tell)
            )
            if volume is None:
                return
            application = slicer.app.applicationLogic()
            application.GetSelectionNode().SetActiveVolumeID(volume.GetID())
            application.PropagateVolumeSelection()
            self._ui.scanComboBox.setCurrentNode(volume)
            self._tell(_("{name} is in the scene.").format(name=volume.GetName()))

    def _takeShownVolume(self, isFolded: bool) -> None:
        """Choose the volume that the slice views show where none is chosen."""
        if not isFolded and self._ui.scanComboBox.currentNode() is None:
            shown = slicer.app.applicationLogic().GetSelectionNode().GetActiveVolumeID()
            self._ui.scanComboBox.setCurrentNode(slicer.mrmlScene.GetNodeByID(shown or ""))

    def preview(self) -> None:
        """Show the head that is found, to accept it or to change it."""
        with slicer.util.tryWithErrorDisplay(_("No head could be shown.")):
            warnings = self._work.run(lambda tell: self._maker.preview(*self._wanted(), tell))
            if warnings is not None:
                told = _(
                    "This head is found. Change the threshold or the cut and find it again, or "
                    "change its segment in the Segment Editor; then make the scenario."
                )
                self._tell(" ".join([told, *warnings]))
                fitThreeDViews()

    def check(self) -> None:
        """Tell at once whether set-up, plan and fiducials can be used."""
        with slicer.util.tryWithErrorDisplay(_("The scenario could not be made so.")):
            own = self._ui.programPathLineEdit.currentPath
            warnings = self._work.run(lambda tell: self._maker.check(*self._wanted(), tell, own))
            if warnings is not None:
                told = _("Set-up, plan and fiducials can be used.")
                self._tell(" ".join([told, *warnings]))

    def makeOrCancel(self) -> None:
        """Make the scenario and go on with it, or break off."""
        if self._work.isUnderWay:
            self._work.cancel()
            return
        with slicer.util.tryWithErrorDisplay(_("The scenario was not made.")):
            own = self._ui.programPathLineEdit.currentPath
            made = self._work.run(lambda tell: self._maker.make(*self._wanted(), tell, own))
            if made is not None:
                self._goOn(*made)

    def _goOn(self, scenario: Scenario, warnings: list[str]) -> None:
        """Choose the new scenario, show it, and have the simulator take it."""
        self._session.scenarioMade.emit(scenario.name)
        told = _("{title} is made and chosen above.").format(title=scenario.title)
        self._tell(" ".join([told, *warnings]))

    def _wanted(self) -> tuple[Any, ScenarioWishes]:
        ui = self._ui
        return ui.scanComboBox.currentNode(), ScenarioWishes(
            title=ui.titleLineEdit.text,
            source=ui.sourceLineEdit.text,
            license=ui.licenseLineEdit.text,
            threshold=_chosen(ui.thresholdSpinBox),
            cutMm=_chosen(ui.cutSpinBox),
            hasSkull=ui.skullCheckBox.checked,
            hasVolume=ui.volumeCheckBox.checked,
            setUp=self._setUp.setUp(),
            targets=ui.plannedTargetsComboBox.currentNode(),
            trajectory=ui.plannedTrajectoryComboBox.currentNode(),
            isHandPlaced=ui.handPlacedCheckBox.checked,
        )

    def _showProgress(self, step: str, share: float) -> None:
        if step:
            self._tell(step)
        self._ui.newScenarioProgressBar.value = round(100 * share)

    def _showUsable(self, *_arguments: Any) -> None:
        ui = self._ui
        hasVolume = ui.scanComboBox.currentNode() is not None
        isAtWork = self._work.isUnderWay
        reason = _("Choose a volume first.")
        ui.newScenarioProgressBar.visible = isAtWork
        ui.makeScenarioButton.text = _("Cancel") if isAtWork else _("Make scenario")
        setUsable(
            ui.makeScenarioButton,
            hasVolume or isAtWork,
            _("Find the head, place fiducials and tasks, and train on it at once."),
            reason,
        )
        setUsable(
            ui.previewHeadButton,
            hasVolume and not isAtWork,
            _("Show the head that is found, and as a segment that may be edited."),
            reason if not hasVolume else _("A head is being looked for."),
        )
        setUsable(
            ui.checkScenarioButton,
            hasVolume and not isAtWork,
            _("Say what is wrong with set-up, plan and fiducials on this head; make nothing."),
            reason if not hasVolume else _("A head is being looked for."),
        )
        ui.sampleDataButton.enabled = ui.scanComboBox.enabled = not isAtWork

    def _tell(self, sentence: str) -> None:
        setSentence(self._ui.newScenarioText, sentence)


def _chosen(box: Any) -> float | None:
    """Return a spin box's value; None where it shows its special text."""
    return None if box.value == box.minimum else box.value
