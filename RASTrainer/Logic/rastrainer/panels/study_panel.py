"""The section Study: leads the chosen trainee through the protocol, step by step."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import qt
import slicer

from rastrainer.errors import InputError
from rastrainer.panels.panel import Panel, connectClick
from rastrainer.panels.plain_text import toolTip
from rastrainer.panels.shown_errors import showErrors
from rastrainer.panels.widgets import (
    chosenData,
    fillTable,
    setText,
    setUsable,
    textLabel,
)
from rastrainer.protocol import StepKind
from rastrainer.slicer.logic.module_session import ModuleSession
from rastrainer.slicer.logic.study_logic import TRIALS
from rastrainer.slicer.translation import _
from rastrainer.study.protocol.questionnaires import (
    Questionnaire,
    QuestionnaireItem,
    find_questionnaire,
)
from rastrainer.study.protocol.step_progress import SKIPPED, StepEntry, StepProgress
from rastrainer.study.protocol.steps import instruction
from rastrainer.study_messages import StudyStep

TIMED = (StepKind.TRIAL_RUN, StepKind.BREAK)


class StudyPanel(Panel):
    """The section Study."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.study
        self._form = QuestionnaireForm(ui.questionnaireWidget)
        self._progress: StepProgress | None = None
        self._judged: tuple | None = None
        connectClick(ui.beginStudyButton, self.begin, _("The study was not started."))
        connectClick(
            ui.enrollButton, lambda: self._logic.enroll(), _("The trainee was not enrolled.")
        )
        ui.startStepButton.connect("clicked()", self.startStep)
        ui.skipStepButton.connect("clicked()", self.skipStep)
        ui.repeatStepButton.connect("clicked()", self.explainRepeat)
        connectClick(
            ui.saveAnswersButton,
            lambda: self._logic.answer(self._form.answers()),
            _("The answers were not saved."),
        )
        ui.protocolPathLineEdit.connect("currentPathChanged(QString)", self._showButtons)
        self.listen(
            (self._logic.changed, self._show),
            (session.training.changed, self._followTrial),
            (session.link.statusChanged, self._showButtons),
            (session.trainees.changed, self._showButtons),
            (session.secondPassed, self._showTime),
        )
        self._show()

    def begin(self) -> None:
        """Make the chosen file the protocol of the study, after asking."""
        question = _(
            "Begin the study with this protocol? A study keeps its protocol permanently; "
            "another protocol needs a new study file."
        )
        if slicer.util.confirmYesNoDisplay(question, _("Begin the study")):
            self._logic.begin(Path(self._ui.protocolPathLineEdit.currentPath))

    def startStep(self) -> None:
        """Start the trial that comes next."""
        with showErrors(_("The step was not started.")):
            self._logic.startStep()

    def skipStep(self) -> None:
        """Skip the step, for a reason; a reason that is refused can be completed."""
        question = _("Why is it skipped? The reason goes into the report.")
        step = None if self._progress is None else self._progress.next_step
        if step is not None:
            # By its name: while the dialog is open, the step may be done.
            skip = partial(self._logic.skipStep, step.name)
            with showErrors(_("The step was not skipped.")):
                self._withReason(_("Skip the step"), question, skip)

    def explainRepeat(self) -> None:
        """Say why an aborted trial is played again; only then can it be started."""
        question = _("Why is the aborted trial repeated? The reason goes into the report.")
        with showErrors(_("The reason was not saved.")):
            self._withReason(_("Repeat the step"), question, self._logic.explainRepeat)

    def _withReason(self, title: str, question: str, do: Callable[[str], None]) -> None:
        """Do what needs a reason; a reason that is refused can be completed."""
        reason = self._askWhy(title, question, "", "")
        while reason:
            try:
                do(reason)
            except InputError as error:
                reason = self._askWhy(title, question, reason, str(error))
            else:
                return

    def _askWhy(self, title: str, question: str, reason: str, problem: str) -> str:
        """Return the reason, beginning with what was typed; empty if canceled."""
        return qt.QInputDialog.getText(
            slicer.util.mainWindow(),
            title,
            toolTip(f"{problem} {question}".strip()),
            qt.QLineEdit.Normal,
            reason,
        )

    def _showTime(self) -> None:
        """Show the time of a trial run or a break."""
        progress = self._progress
        step = None if progress is None else progress.next_step
        if progress is None or step is None or step.kind not in TIMED:
            setText(self._ui.stepTimeText, "")
        else:
            setText(
                self._ui.stepTimeText,
                _("{over} of {minutes:g} min have passed.").format(
                    over=_clock(self._logic.minutesElapsed(progress)), minutes=step.minutes
                ),
            )

    def _followTrial(self) -> None:
        """Warn, once for each trial, of one that will not count."""
        self._showButtons()
        trial = self._session.training.status
        key = (trial.trainee, trial.task, trial.mode, trial.method, trial.procedure, trial.isOpen)
        if key != self._judged:
            self._judged = key
            with contextlib.suppress(InputError):
                setText(self._ui.offProtocolText, self._logic.offProtocolSentence())

    def _show(self) -> None:
        ui = self._ui
        self._judged = None
        try:
            protocol, progress = self._logic.study.protocol(), self._logic.progress()
        except InputError as error:
            protocol = progress = None
            setText(ui.protocolText, str(error))
        else:
            setText(
                ui.protocolText,
                _("No protocol: trainees practice freely.") if protocol is None else protocol.title,
            )
        self._progress = progress
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
        step = None if progress is None else progress.next_step
        questionnaire = step if step is not None and step.kind is StepKind.QUESTIONNAIRE else None
        ui.questionnaireWidget.visible = ui.saveAnswersButton.visible = questionnaire is not None
        if questionnaire is None:
            self._form.show(None, None)
        else:
            key = (self._session.trainees.chosen, questionnaire.name)
            self._form.show(key, find_questionnaire(questionnaire.questionnaire))
        isAborted = progress is not None and bool(progress.unexplained)
        ui.repeatStepButton.visible = isAborted
        ui.startStepButton.visible = step is not None and step.kind in TRIALS and not isAborted
        ui.skipStepButton.visible = step is not None
        self._showTime()
        self._followTrial()

    def _showButtons(self, *_arguments: Any) -> None:
        ui = self._ui
        setUsable(
            ui.beginStudyButton,
            bool(ui.protocolPathLineEdit.currentPath),
            _("Guide the trainees through this protocol from now on."),
            _("Choose the file of a protocol first."),
        )
        setUsable(
            ui.enrollButton,
            bool(self._session.trainees.chosen),
            _("Give the trainee the first free place, which decides the order of modes and tasks."),
            _("Choose a trainee in the section Trainees first."),
        )
        if self._progress is not None and self._progress.next_step is not None:
            self._showStartButton(self._progress.next_step)

    def _showStartButton(self, step: StudyStep) -> None:
        reason = self._session.training.obstacle
        setUsable(self._ui.startStepButton, not reason, instruction(step), reason)


def _row(progress: StepProgress, number: int) -> tuple[str, str, str]:
    step = progress.steps[number]
    if number < len(progress.entries):
        return str(number + 1), _outcome(progress.entries[number]), instruction(step)
    isNext = number == len(progress.entries)
    return str(number + 1), _("next") if isNext else "", instruction(step)


def _outcome(entry: StepEntry) -> str:
    if entry.outcome == SKIPPED:
        return _("skipped: {reason}").format(reason=entry.details["reason"])
    return _("done")


def _clock(minutes: float) -> str:
    whole, seconds = divmod(int(60.0 * minutes), 60)
    return f"{whole}:{seconds:02d}"


class QuestionnaireForm:
    """Fills a widget with the items of one questionnaire after another."""

    def __init__(self, widget: Any) -> None:
        """`widget` has a form layout that nothing else uses."""
        self._widget = widget
        self._key: Any = None
        self._questionnaire: Questionnaire | None = None
        self._boxes: list[Any] = []
        self._parts: list[Any] = []

    def show(self, key: Any, questionnaire: Questionnaire | None) -> None:
        """Show a questionnaire, empty, unless the one with this key is already shown."""
        if key == self._key:
            return
        self._key, self._questionnaire = key, questionnaire
        self._clear()
        if questionnaire is None:
            return
        head = textLabel(
            _(
                "{title}: {lowest} is {low}, {highest} is {high}, unless a line says otherwise. "
                "Read the wording from its form."
            ).format(
                title=questionnaire.title,
                lowest=questionnaire.lowest,
                low=questionnaire.anchors[0],
                highest=questionnaire.highest,
                high=questionnaire.anchors[1],
            )
        )
        layout = self._widget.layout()
        layout.addRow(head)
        self._parts.append(head)
        for number, item in enumerate(questionnaire.items, start=1):
            label, box = textLabel(f"{number}. {_lineOf(item, questionnaire)}"), qt.QComboBox()
            label.setObjectName(f"{item.name}Label")
            box.setObjectName(f"{item.name}ComboBox")
            box.addItem("–", "")
            for mark in questionnaire.marks:
                box.addItem(str(mark), str(mark))
            layout.addRow(label, box)
            self._parts += [label, box]
            self._boxes.append(box)

    def answers(self) -> tuple[int, ...]:
        """Return the answers in the order of the items."""
        chosen = [chosenData(box) for box in self._boxes]
        open_ = [str(number) for number, mark in enumerate(chosen, start=1) if not mark]
        if open_ and self._questionnaire is not None:
            raise InputError(
                _("{title}: not answered yet: {items}.").format(
                    title=self._questionnaire.title, items=", ".join(open_)
                )
            )
        return tuple(int(mark) for mark in chosen)

    def _clear(self) -> None:
        for part in self._parts:
            self._widget.layout().removeWidget(part)
            part.setParent(None)
            part.deleteLater()
        self._parts, self._boxes = [], []


def _lineOf(item: QuestionnaireItem, questionnaire: Questionnaire) -> str:
    """Return an item's question, with the ends of its scale if they are its own."""
    if not item.anchors:
        return item.topic
    return _("{topic}: {lowest} is {low}, {highest} is {high}").format(
        topic=item.topic,
        lowest=questionnaire.lowest,
        low=item.anchors[0],
        highest=questionnaire.highest,
        high=item.anchors[1],
    )
