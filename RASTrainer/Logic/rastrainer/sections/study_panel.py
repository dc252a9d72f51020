"""The section Study: leads the chosen trainee through the protocol, and sets curricula."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.errors import InputError
from rastrainer.protocol import StepKind
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.trainees_logic import NOBODY
from rastrainer.slicer.translation import _
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    advice_of,
    progress_of_assignment,
    short_progress_of,
    state_of,
    title_of,
)
from rastrainer.study.protocol.questionnaires import Questionnaire, find_questionnaire
from rastrainer.study.protocol.steps import SKIPPED, StepProgress, instruction
from rastrainer.study_messages import StudyStep
from rastrainer.widgets.controls import (
    chosenData,
    fillTable,
    numberOrDash,
    setEnabled,
    setText,
    textLabel,
)
from rastrainer.widgets.plain_text import toolTip

TIMED = (StepKind.TRIAL_RUN, StepKind.BREAK)


class StudyPanel(Panel):
    """The section Study."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.study
        self._form = QuestionnaireForm(ui.questionnaireWidget)
        self._progress: StepProgress | None = None
        self._step: StudyStep | None = None
        connectClick(ui.beginStudyButton, self.begin, _("The study was not started."))
        connectClick(ui.enrollButton, self._logic.enroll, _("The trainee was not enrolled."))
        failure = _("The step was not started.")
        self.startStep = connectClick(ui.startStepButton, self._logic.startStep, failure)
        question = _("Why is the aborted trial repeated? The reason goes into the report.")
        title, explain = _("Repeat the step"), self._logic.explainRepeat
        ask = partial(self._withReason, title, question, explain)
        failure = _("The reason was not saved.")
        self.explainRepeat = connectClick(ui.repeatStepButton, ask, failure)
        connectClick(ui.skipStepButton, self.skipStep, _("The step was not skipped."))
        connectClick(
            ui.saveAnswersButton,
            lambda: self._logic.answer(self._form.answers()),
            _("The answers were not saved."),
        )
        ui.protocolPathLineEdit.connect("currentPathChanged(QString)", self._showButtons)
        section, trainees = ui.studyCollapsibleButton, session.trainees
        self.showWhileOpen(section, self._show, self._logic.changed)
        changes = session.training.changed, session.link.statusChanged, trainees.changed
        self.showWhileOpen(section, self._followTrial, *changes)
        self.showWhileOpen(section, self._showTime, session.secondPassed)
        self._show()

    def begin(self) -> None:
        question = _(
            "Begin the study with this protocol? A study keeps its protocol permanently; "
            "another protocol needs a new study file."
        )
        if slicer.util.confirmYesNoDisplay(question, _("Begin the study")):
            self._logic.begin(Path(self._ui.protocolPathLineEdit.currentPath))

    def skipStep(self) -> None:
        question = _("Why is it skipped? The reason goes into the report.")
        if self._step is not None:
            # The step may be done while the dialog is open.
            skip = partial(self._logic.skipStep, self._step.name)
            self._withReason(_("Skip the step"), question, skip)

    def _withReason(self, title: str, question: str, do: Callable[[str], None]) -> None:
        """Do what needs a reason; a reason that is refused can be completed."""
        reason = problem = ""
        while True:
            text = toolTip(f"{problem} {question}".strip())
            window, isShown = slicer.util.mainWindow(), qt.QLineEdit.Normal
            reason = qt.QInputDialog.getText(window, title, text, isShown, reason)
            if not reason:
                return
            try:
                do(reason)
            except InputError as error:
                problem = str(error)
            else:
                return

    def _showTime(self) -> None:
        step, text = self._step, ""
        if self._progress is not None and step is not None and step.kind in TIMED:
            minutes, seconds = divmod(int(60.0 * self._logic.minutesElapsed(self._progress)), 60)
            text = _("{over} of {minutes:g} min have passed.").format(
                over=f"{minutes}:{seconds:02d}", minutes=step.minutes
            )
        setText(self._ui.stepTimeText, text)

    def _followTrial(self) -> None:
        self._showButtons()
        with contextlib.suppress(InputError):
            setText(self._ui.offProtocolText, self._logic.offProtocolSentence())

    def _show(self) -> None:
        ui = self._ui
        protocol = progress = None
        title = _("No protocol: trainees practice freely.")
        try:
            protocol, progress = self._logic.study.protocol(), self._logic.progress()
        except InputError as error:
            title = str(error)
        setText(ui.protocolText, title if protocol is None else protocol.title)
        self._progress = progress
        self._step = step = None if progress is None else progress.next_step
        ui.protocolPathLineEdit.visible = ui.beginStudyButton.visible = protocol is None
        ui.enrollButton.visible = protocol is not None and progress is None
        ui.stepGroupBox.visible = progress is not None
        if progress is not None:
            with contextlib.suppress(InputError):
                uncounted = self._logic.uncountedSentence()
                sentences = (progress.sentence, progress.repeat_sentence, uncounted)
                setText(ui.stepText, " ".join(filter(None, sentences)))
            ui.stepsProgressBar.maximum = len(progress.steps)
            ui.stepsProgressBar.value = len(progress.entries)
            fillTable(ui.stepsTable, [_row(progress, n) for n in range(len(progress.steps))])
        isAsked = step is not None and step.kind is StepKind.QUESTIONNAIRE
        ui.questionnaireWidget.visible = ui.saveAnswersButton.visible = isAsked
        if step is not None and isAsked:
            key = (self._session.trainees.chosen, step.name)
            self._form.show(key, find_questionnaire(step.questionnaire))
        else:
            self._form.show(None, None)
        isAborted = progress is not None and bool(progress.unexplained)
        ui.repeatStepButton.visible = isAborted
        ui.startStepButton.visible = step is not None and step.is_played and not isAborted
        ui.skipStepButton.visible = step is not None
        self._showTime()
        self._followTrial()

    def _showButtons(self, *_arguments: Any) -> None:
        ui = self._ui
        hasProtocol = bool(ui.protocolPathLineEdit.currentPath)
        setEnabled(ui.beginStudyButton, hasProtocol, _("Choose the file of a protocol first."))
        setEnabled(ui.enrollButton, bool(self._session.trainees.chosen), NOBODY)
        if self._step is not None:
            reason = self._session.training.obstacle
            setEnabled(ui.startStepButton, not reason, reason, instruction(self._step))


def _row(progress: StepProgress, number: int) -> tuple[str, str, str]:
    outcome = _("next") if number == len(progress.entries) else ""
    if number < len(progress.entries):
        entry, outcome = progress.entries[number], _("done")
        if entry.outcome == SKIPPED:
            outcome = _("skipped: {reason}").format(reason=entry.details["reason"])
    return str(number + 1), outcome, instruction(progress.steps[number])


class QuestionnaireForm:
    """Fills a widget with the items of one questionnaire after another."""

    def __init__(self, widget: Any) -> None:
        """`widget` has a form layout that nothing else uses."""
        self._widget = widget
        self._key: Any = None
        self._questionnaire: Questionnaire | None = None
        self._boxes: list[Any] = []

    def show(self, key: Any, questionnaire: Questionnaire | None) -> None:
        """Show a questionnaire, empty, unless the shown one has this key."""
        if key == self._key:
            return
        self._key, self._questionnaire = key, questionnaire
        layout, self._boxes = self._widget.layout(), []
        while layout.rowCount():
            layout.removeRow(0)
        if questionnaire is None:
            return
        ends = {"lowest": questionnaire.lowest, "highest": questionnaire.highest}
        low, high = questionnaire.anchors
        text = _(
            "{title}: {lowest} is {low}, {highest} is {high}, unless a line says otherwise. "
            "Read the wording from its form."
        )
        text = text.format(title=questionnaire.title, low=low, high=high, **ends)
        layout.addRow(textLabel(text))
        for number, item in enumerate(questionnaire.items, start=1):
            line = item.topic
            if item.anchors:
                low, high = item.anchors
                text = _("{topic}: {lowest} is {low}, {highest} is {high}")
                line = text.format(topic=item.topic, low=low, high=high, **ends)
            label, box = textLabel(f"{number}. {line}"), qt.QComboBox()
            label.setObjectName(f"{item.name}Label")
            box.setObjectName(f"{item.name}ComboBox")
            box.addItem("–", "")
            for mark in questionnaire.marks:
                box.addItem(str(mark), str(mark))
            layout.addRow(label, box)
            self._boxes.append(box)

    def answers(self) -> tuple[int, ...]:
        chosen = [chosenData(box) for box in self._boxes]
        open_ = [str(number) for number, mark in enumerate(chosen, start=1) if not mark]
        if open_ and self._questionnaire is not None:
            raise InputError(
                _("{title}: not answered yet: {items}.").format(
                    title=self._questionnaire.title, items=", ".join(open_)
                )
            )
        return tuple(int(mark) for mark in chosen)


class CurriculumPanel(Panel):
    """The part Curriculum of the section Study."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.curriculum
        connectClick(ui.setCurriculumButton, self.setCurriculum, _("The curriculum was not set."))
        connectClick(ui.endCurriculumButton, self.endCurriculum, _("The curriculum was not ended."))
        ui.curriculumPathLineEdit.connect("currentPathChanged(QString)", self._showButtons)
        ui.everybodyCheckBox.connect("toggled(bool)", self._showButtons)
        self.showWhileOpen(ui.curriculumCollapsibleButton, self._show, self._logic.changed)
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
        members = []
        for name, each in everybody.items():
            best = "–" if each.next_best is None else title_of(each.next_best)
            members.append((name, f"{each.reached} / {len(each.standings)}", best))
        fillTable(ui.classTable, members)
        self._showButtons()

    def _showButtons(self, *_arguments: Any) -> None:
        ui = self._ui
        isSomebody = ui.everybodyCheckBox.checked or bool(self._session.trainees.chosen)
        reason = _("Choose the file of a curriculum first.") if isSomebody else NOBODY
        hasFile = bool(ui.curriculumPathLineEdit.currentPath)
        setEnabled(ui.setCurriculumButton, isSomebody and hasFile, reason)
        hasOne = bool(self._logic.standings()) and isSomebody
        if not ui.everybodyCheckBox.checked:
            hasOne = self._logic.standing() is not None
        reason = _("There is no curriculum to end.") if isSomebody else NOBODY
        setEnabled(ui.endCurriculumButton, hasOne, reason)
