"""The group Landmarks of New scenario: those of a head, for trials without fiducials."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.scenario.points import FACE_LANDMARKS
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, chosenScenario, connectClick
from rastrainer.slicer.translation import _
from rastrainer.widgets.controls import (
    CancelableWork,
    chosenData,
    fillComboBox,
    fillTable,
    setEnabled,
    setText,
)
from rastrainer.work_progress import Progress

NAMES = {
    "Nasion": _("Nasion"),
    "Right outer canthus": _("Right outer canthus"),
    "Left outer canthus": _("Left outer canthus"),
    "Right inner canthus": _("Right inner canthus"),
    "Left inner canthus": _("Left inner canthus"),
    "Right tragus": _("Right tragus"),
    "Left tragus": _("Left tragus"),
    "Tip of the nose": _("Tip of the nose"),
}
ENTRIES = [(NAMES[name], name) for name in FACE_LANDMARKS]


class LandmarksPanel(Panel):
    """The group Landmarks."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.landmarks
        failure = _("No landmarks could be proposed.")
        self._work = CancelableWork(
            ui.proposeLandmarksButton,
            partial(self._run, self._logic.propose),
            failure,
            self._showMessage,
            self.showState,
        )
        fillComboBox(ui.landmarkNameComboBox, ENTRIES, FACE_LANDMARKS[0])
        connectClick(ui.showLandmarksButton, self.show, _("The landmarks cannot be shown."))
        connectClick(ui.placeLandmarkButton, self.place, _("No landmark can be placed."))
        ui.removeLandmarkButton.connect("clicked()", self.remove)
        ui.undoLandmarkButton.connect("clicked()", self.undo)
        check = partial(self._run, self._logic.check)
        connectClick(ui.checkLandmarksButton, check, _("The landmarks were not checked."))
        connectClick(ui.saveLandmarksButton, self.save, _("The landmarks were not saved."))
        self.listen((session.sceneChanged, self.showState))
        self._message = ""
        self.showState()

    def show(self) -> None:
        scenario = chosenScenario(self._ui, self._session)
        if not scenario.landmarks:
            raise InputError(_("{title} has no landmarks.").format(title=scenario.title))
        self._logic.points.show(scenario.landmarks)
        self._showMessage("")
        self.showState()

    def place(self) -> None:
        """Let the next click in a view place the chosen landmark."""
        self._logic.points.startPlacing(chosenData(self._ui.landmarkNameComboBox))

    def remove(self) -> None:
        self._logic.points.remove(self._ui.landmarksTable.currentRow())
        self.showState()

    def undo(self) -> None:
        self._logic.points.undo()
        self.showState()

    def save(self) -> None:
        """Copy the chosen scenario with these landmarks and use the copy."""
        title = self._ui.landmarksTitleLineEdit.text.strip()
        scenario = chosenScenario(self._ui, self._session)
        saved = self._work.run(lambda report: self._logic.save(scenario, title, report))
        if saved is not None:
            text = _("{title} was made and is chosen above.")
            self._showMessage(text.format(title=saved.title))
            self._session.scenarioMade.emit(saved.name)

    def showState(self) -> None:
        ui, points, isAtWork = self._ui, self._logic.points, self._work.isUnderWay
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

    def _run(self, work: Callable[[Scenario, Progress], str]) -> None:
        scenario = chosenScenario(self._ui, self._session)
        said = self._work.run(lambda report: work(scenario, report))
        if said is not None:
            self._showMessage(said)

    def _showMessage(self, sentence: str) -> None:
        self._message = sentence
        names = [landmark.name for landmark in self._logic.points.placed(areSelected=False)]
        if names:
            leftOut = _("Left out, as they are deselected in the module Markups: {names}.").format(
                names=", ".join(NAMES.get(name, name) for name in names)
            )
            sentence = f"{sentence} {leftOut}".strip()
        setText(self._ui.landmarksText, sentence)
