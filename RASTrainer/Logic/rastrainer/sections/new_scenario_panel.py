"""The section New scenario: from a volume, with landmarks of its head, to something to train on."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import qt
import slicer

from rastrainer.errors import InputError
from rastrainer.head.trial_head import MAX_PERTURBATION, Perturbation
from rastrainer.number_text import fixed
from rastrainer.protocol import WORLD_LIMIT_MM
from rastrainer.scenario.points import FACE_LANDMARKS
from rastrainer.scenario.scenario import STAND_DIAMETERS_MM, OperatingTable, Scenario, Stand
from rastrainer.scenario.setup import HeadPlace, SetUp
from rastrainer.sections.application import downloadSample, fitThreeDViews
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.new_scenario_logic import NewScenarioOptions
from rastrainer.sections.panel import Panel, chosenScenario, connectClick
from rastrainer.sections.scenario_files import ScenarioFiles
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    CancelableWork,
    chosenData,
    fillComboBox,
    fillTable,
    setEnabled,
    setText,
)
from rastrainer.widgets.shown_errors import showErrors
from rastrainer.work_progress import Progress

NARROWEST = 60
_USUAL = SetUp()
_MOVED, _MOST = _USUAL.perturbation, MAX_PERTURBATION
_PLACE, _EXTENT = (-WORLD_LIMIT_MM, WORLD_LIMIT_MM), (1.0, WORLD_LIMIT_MM)
_ROWS = (
    (_("Head center, mm:"), "head", _PLACE, _USUAL.head.center_mm),
    (_("Head rotation, °:"), "yaw", (-180.0, 180.0), (_USUAL.head.yaw_deg,)),
    (_("Shift in a trial, ± mm:"), "shift", (0.0, _MOST.translation_mm), (_MOVED.translation_mm,)),
    (_("Rotation in a trial, ± °:"), "turn", (0.0, _MOST.yaw_deg), (_MOVED.yaw_deg,)),
    (_("Tilt in a trial, ± °:"), "tilt", (0.0, _MOST.tilt_deg), (_MOVED.tilt_deg,)),
    (_("Table center, mm:"), "table", _PLACE, _USUAL.table.center_mm),
    (_("Table size, mm:"), "size", _EXTENT, _USUAL.table.size_mm),
    (_("Stand diameter, mm:"), "stand", STAND_DIAMETERS_MM, (_USUAL.stand.diameter_mm,)),
    (_("Robot base, mm:"), "base", _PLACE, _USUAL.robot_base_mm),
)
"""Label, name, lowest and highest, usual values; places are in the table's frame."""


def addSetUpRows(parent: Any) -> dict[str, list[Any]]:
    """Fill a widget without layout with spin boxes `head0SpinBox` and so on; return them by row."""
    layout = qt.QFormLayout(parent)
    boxes: dict[str, list[Any]] = {}
    for label, name, (least, most), usual in _ROWS:
        row = qt.QWidget()
        across = qt.QHBoxLayout(row)
        across.setContentsMargins(0, 0, 0, 0)
        boxes[name] = []
        for place, value in enumerate(usual):
            box = qt.QDoubleSpinBox()
            box.objectName = f"{name}{place}SpinBox"
            box.minimum, box.maximum = least, most
            box.decimals = 1
            # Three share a row: they must not be as wide as the widest number.
            box.minimumWidth = NARROWEST
            box.value = value
            across.addWidget(box)
            boxes[name].append(box)
        layout.addRow(label, row)
    return boxes


SAMPLE = "MRBrainTumor1"


class NewScenarioPanel(Panel):
    """The section New scenario."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._maker = session.scenarioMaker
        self._setUp = addSetUpRows(ui.setUpGroupBox)
        failure = _("The scenario was not made.")
        shows = (self._showMessage, self._showUsable, self._showProgress)
        self._work = CancelableWork(ui.makeScenarioButton, self.make, failure, *shows)
        ui.sampleDataButton.connect("clicked()", self.loadSampleData)
        connectClick(ui.previewHeadButton, self.preview, _("No head could be shown."))
        failure = _("The scenario could not be made with these choices.")
        connectClick(ui.checkScenarioButton, self.check, failure)
        ui.scanComboBox.connect("currentNodeChanged(vtkMRMLNode*)", self._showUsable)
        ui.newScenarioCollapsibleButton.connect("contentsCollapsed(bool)", self._takeShownVolume)
        self._showMessage("")
        self._showUsable()

    def loadSampleData(self) -> None:
        with showErrors(_("The sample could not be loaded."), waitCursor=True):
            logic = slicer.util.getModuleLogic("SampleData")
            volume = self._work.run(partial(downloadSample, slicer.mrmlScene, logic, SAMPLE))
            if volume is None:
                return
            application = slicer.app.applicationLogic()
            application.GetSelectionNode().SetActiveVolumeID(volume.GetID())
            application.PropagateVolumeSelection()
            self._ui.scanComboBox.setCurrentNode(volume)
            self._showMessage(_("{name} is in the scene.").format(name=volume.GetName()))

    def _takeShownVolume(self, isFolded: bool) -> None:
        """Choose the volume that the slice views show where none is chosen."""
        if not isFolded and self._ui.scanComboBox.currentNode() is None:
            shown = slicer.app.applicationLogic().GetSelectionNode().GetActiveVolumeID()
            self._ui.scanComboBox.setCurrentNode(slicer.mrmlScene.GetNodeByID(shown or ""))

    def preview(self) -> None:
        """Show the head that is found, to accept it or to change it."""
        warnings = self._work.run(lambda report: self._maker.preview(self._wanted(), report))
        if warnings is not None:
            text = _(
                "This is the head that was found. Change the threshold or the cut and find it "
                "again, or edit its segment in the Segment Editor; then make the scenario."
            )
            self._showMessage(text, *warnings)
            fitThreeDViews()

    def check(self) -> None:
        warnings = self._work.run(lambda report: self._maker.check(self._wanted(), report))
        if warnings is not None:
            self._showMessage(_("Set-up, plan and fiducials can be used."), *warnings)

    def make(self) -> None:
        made = self._work.run(lambda report: self._maker.make(self._wanted(), report))
        if made is not None:
            scenario, warnings = made
            self._session.scenarioMade.emit(scenario.name)
            text = _("{title} was made and is chosen above.").format(title=scenario.title)
            self._showMessage(text, *warnings)

    def _wanted(self) -> NewScenarioOptions:
        ui = self._ui
        values = {name: tuple(box.value for box in boxes) for name, boxes in self._setUp.items()}
        setUp = SetUp(
            head=HeadPlace(values["head"], *values["yaw"]),
            perturbation=Perturbation(*values["shift"], *values["turn"], *values["tilt"]),
            table=OperatingTable(values["table"], values["size"]),
            stand=Stand(*values["stand"]),
            robot_base_mm=values["base"],
        )
        return NewScenarioOptions(
            volume=ui.scanComboBox.currentNode(),
            title=ui.titleLineEdit.text,
            source=ui.sourceLineEdit.text,
            license=ui.licenseLineEdit.text,
            threshold=_chosen(ui.thresholdSpinBox),
            cutMm=_chosen(ui.cutSpinBox),
            hasSkull=ui.skullCheckBox.checked,
            hasVolume=ui.volumeCheckBox.checked,
            setUp=setUp,
            targets=ui.plannedTargetsComboBox.currentNode(),
            trajectory=ui.plannedTrajectoryComboBox.currentNode(),
            isHandPlaced=ui.handPlacedCheckBox.checked,
        )

    def _showProgress(self, step: str, share: float) -> None:
        if step:
            self._showMessage(step)
        self._ui.newScenarioProgressBar.value = round(100 * share)

    def _showUsable(self, *_arguments: Any) -> None:
        ui = self._ui
        hasVolume = ui.scanComboBox.currentNode() is not None
        isAtWork = self._work.isUnderWay
        reason = _("Choose a volume first.")
        setEnabled(ui.makeScenarioButton, hasVolume or isAtWork, reason)
        if hasVolume:
            reason = _("A head is already being searched for.")
        for button in (ui.previewHeadButton, ui.checkScenarioButton):
            setEnabled(button, hasVolume and not isAtWork, reason)
        ui.newScenarioProgressBar.visible = isAtWork
        ui.sampleDataButton.enabled = ui.scanComboBox.enabled = not isAtWork

    def _showMessage(self, *sentences: str) -> None:
        setText(self._ui.newScenarioText, " ".join(sentences))


def _chosen(box: Any) -> float | None:
    """Return a spin box's value; None while it shows its special text."""
    return None if box.value == box.minimum else box.value


_SHOWN = [_("Nasion"), _("Right outer canthus"), _("Left outer canthus")]
_SHOWN += [_("Right inner canthus"), _("Left inner canthus"), _("Right tragus")]
_SHOWN += [_("Left tragus"), _("Tip of the nose")]
NAMES = dict(zip(FACE_LANDMARKS, _SHOWN, strict=True))
"""The landmarks' names on the screen, by their names in files."""
ENTRIES = [(NAMES[name], name) for name in FACE_LANDMARKS]


class LandmarksPanel(Panel):
    """The group Landmarks."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._points = points = session.landmarks
        propose = partial(self._run, points.propose)
        failure = _("No landmarks could be proposed.")
        shows = self._showMessage, self.showState
        self._work = CancelableWork(ui.proposeLandmarksButton, propose, failure, *shows)
        fillComboBox(ui.landmarkNameComboBox, ENTRIES, FACE_LANDMARKS[0])
        connectClick(ui.showLandmarksButton, self.show, _("The landmarks cannot be shown."))
        names, table = ui.landmarkNameComboBox, ui.landmarksTable
        place, failure = ui.placeLandmarkButton, _("No landmark can be placed.")
        connectClick(place, lambda: points.startPlacing(chosenData(names)), failure)
        ui.removeLandmarkButton.connect("clicked()", lambda: points.remove(table.currentRow()))
        ui.undoLandmarkButton.connect("clicked()", points.undo)
        for button in (ui.removeLandmarkButton, ui.undoLandmarkButton):
            button.connect("clicked()", self.showState)
        check = partial(self._run, points.check)
        connectClick(ui.checkLandmarksButton, check, _("The landmarks were not checked."))
        connectClick(ui.saveLandmarksButton, self.save, _("The landmarks were not saved."))
        self._message = ""
        section = ui.newScenarioCollapsibleButton
        self.showWhileOpen(section, self.showState, session.sceneChanged)
        self.showState()

    def show(self) -> None:
        scenario = chosenScenario(self._ui, self._session)
        if not scenario.landmarks:
            raise InputError(_("{title} has no landmarks.").format(title=scenario.title))
        self._points.show(scenario.landmarks)
        self._showMessage("")
        self.showState()

    def save(self) -> None:
        with self._points.written() as path:
            title, plan = self._ui.landmarksTitleLineEdit.text, ["--landmarks", str(path)]
            saved = self.saveCopy(self._work, title, plan)
        if saved is not None:
            text = _("{title} was made and is chosen above.")
            self._showMessage(text.format(title=saved.title))

    def showState(self) -> None:
        ui, points, isAtWork = self._ui, self._points, self._work.isUnderWay
        self._showMessage(self._message)
        rows = [
            (NAMES.get(each.name, each.name), *(fixed(float(v), 1) for v in each.position_ras))
            for each in points.placed()
        ]
        if fillTable(ui.landmarksTable, rows):
            # The first usual landmark that is missing comes next.
            placed = [landmark.name for landmark in points.placed()]
            missing = [name for name in FACE_LANDMARKS if name not in placed]
            fillComboBox(ui.landmarkNameComboBox, ENTRIES, (*missing, FACE_LANDMARKS[0])[0])
        none = _("Place landmarks first, or have them proposed.")
        setEnabled(ui.removeLandmarkButton, bool(rows), _("No landmark is placed."))
        setEnabled(ui.undoLandmarkButton, points.canUndo, _("Nothing was changed."))
        for button in (ui.checkLandmarksButton, ui.saveLandmarksButton):
            reason = _("Wait until the current work is done.") if isAtWork else none
            setEnabled(button, bool(rows) and not isAtWork, reason)

    def _run(self, work: Callable[[ScenarioFiles, Scenario, Progress], str]) -> None:
        scenario = chosenScenario(self._ui, self._session)
        said = self._work.run(partial(work, self._session.scenarioFiles, scenario))
        if said is not None:
            self._showMessage(said)

    def _showMessage(self, sentence: str) -> None:
        self._message = sentence
        others = self._points.placed(areSelected=False)
        if others:
            leftOut = _("Left out, as they are deselected in the module Markups: {names}.")
            names = ", ".join(NAMES.get(each.name, each.name) for each in others)
            sentence = f"{sentence} {leftOut.format(names=names)}".strip()
        setText(self._ui.landmarksText, sentence)
