"""The part Curriculum of the section Study: what trainees should reach, and their progress."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import slicer

from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.slicer.translation import _
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    advice_of,
    progress_of_assignment,
    short_progress_of,
    state_of,
    title_of,
)
from rastrainer.widgets.controls import fillTable, numberOrDash, setEnabled, setText
from rastrainer.widgets.plain_text import toolTip


class CurriculumPanel(Panel):
    """The part Curriculum of the section Study."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.curriculum
        connectClick(ui.setCurriculumButton, self.setCurriculum, _("The curriculum was not set."))
        connectClick(ui.endCurriculumButton, self.endCurriculum, _("The curriculum was not ended."))
        ui.curriculumPathLineEdit.connect("currentPathChanged(QString)", self._showButtons)
        ui.everybodyCheckBox.connect("toggled(bool)", self._showButtons)
        self.listen((self._logic.changed, self._show))
        self._show()

    def setCurriculum(self) -> None:
        curriculum = Curriculum.read(Path(self._ui.curriculumPathLineEdit.currentPath))
        self._logic.choose(curriculum, self._ui.everybodyCheckBox.checked)

    def endCurriculum(self) -> None:
        isForEverybody = self._ui.everybodyCheckBox.checked
        who = _("everybody") if isForEverybody else self._session.trainees.chosen
        question = _(
            "End the curriculum of {who}? Trials stay, and count again if it is set again."
        ).format(who=who)
        if slicer.util.confirmYesNoDisplay(toolTip(question), _("End the curriculum")):
            self._logic.choose(None, isForEverybody)

    def _show(self) -> None:
        ui, standing = self._ui, self._logic.standing()
        if standing is None:
            setText(ui.curriculumText, _("No curriculum: trainees choose what they practice."))
        else:
            text = _("{title}: {reached} of {count} reached. {advice}")
            values = {"reached": standing.reached, "count": len(standing.standings)}
            title, advice = standing.curriculum.title, advice_of(standing)
            setText(ui.curriculumText, text.format(title=title, advice=advice, **values))
        rows = () if standing is None else standing.standings
        tips = [f"{each.name}: {state_of(each)}, {progress_of_assignment(each)}" for each in rows]
        everybody = self._logic.standings()
        ui.assignmentsTable.visible, ui.classTable.visible = bool(rows), bool(everybody)
        assignments = [
            (title_of(each), short_progress_of(each), numberOrDash(each.mean, 0)) for each in rows
        ]
        fillTable(ui.assignmentsTable, assignments, tips)
        fillTable(
            ui.classTable,
            (
                (
                    name,
                    f"{each.reached} / {len(each.standings)}",
                    "–" if each.next_best is None else title_of(each.next_best),
                )
                for name, each in everybody.items()
            ),
        )
        self._showButtons()

    def _showButtons(self, *_arguments: Any) -> None:
        ui = self._ui
        isSomebody = ui.everybodyCheckBox.checked or bool(self._session.trainees.chosen)
        nobody = _("Choose a trainee in the section Trainees first.")
        reason = _("Choose the file of a curriculum first.") if isSomebody else nobody
        hasFile = bool(ui.curriculumPathLineEdit.currentPath)
        setEnabled(ui.setCurriculumButton, isSomebody and hasFile, reason)
        hasOne = bool(self._logic.standings()) and isSomebody
        if not ui.everybodyCheckBox.checked:
            hasOne = self._logic.standing() is not None
        reason = _("There is no curriculum to end.") if isSomebody else nobody
        setEnabled(ui.endCurriculumButton, hasOne, reason)
