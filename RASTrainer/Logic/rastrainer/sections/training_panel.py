"""The section Training: start and control a trial, and follow it touch by touch."""

from __future__ import annotations

from functools import partial
from typing import Any

import slicer

from rastrainer.commands import CommandName
from rastrainer.protocol import (
    PROCEDURE_PHASES,
    TRIAL_RUN,
    Mode,
    Phase,
    Proximity,
    RegistrationMethod,
)
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel import Panel, connectClick
from rastrainer.sections.trainees_logic import NOBODY
from rastrainer.sections.training_logic import TrialStatus
from rastrainer.slicer.settings import (
    IS_TUTORIAL_FIRST,
    MODE,
    SLICES_FOLLOW_TOOL,
    SLICES_SHOW_NEXT_POINT,
)
from rastrainer.slicer.translation import _
from rastrainer.study.outcomes import task_title
from rastrainer.widgets.controls import (
    GRAY,
    GREEN,
    RED,
    YELLOW,
    bind,
    bindChosen,
    chosenData,
    connectAsPressed,
    offerEntries,
    setEnabled,
    setLight,
    setProperty,
    setText,
)
from rastrainer.widgets.plain_text import buttonTitle, shortName, toolTip
from rastrainer.widgets.shown_errors import guardedAction

PHASES = {
    Phase.IDLE.value: _("no trial is open"),
    Phase.RUNNING.value: _("the trial is running"),
    Phase.PAUSED.value: _("the trial is paused"),
    Phase.COMPLETE.value: _("all points are touched"),
    Phase.VERIFYING.value: _("the registration is being verified"),
    Phase.ALIGNING.value: _("the guide is being aligned"),
    Phase.DRILLING.value: _("the skull is being drilled"),
    Phase.INSERTING.value: _("the instrument is being inserted"),
    Phase.REGISTERED.value: _("registered, being scored"),
    Phase.SCORED.value: _("the trial is scored"),
}
METHODS = {
    RegistrationMethod.FIDUCIALS.value: _("Fiducials"),
    RegistrationMethod.LANDMARKS.value: _("Landmarks of the face"),
    RegistrationMethod.SURFACE.value: _("Trace over the skin"),
    RegistrationMethod.LANDMARKS_SURFACE.value: _("Landmarks, then a trace"),
}
NEARNESS = {
    Proximity.FREE.value: (GREEN, _("free")),
    Proximity.PROXIMITY.value: (YELLOW, _("near the head")),
    Proximity.CONTACT.value: (RED, _("touching the head")),
}


class TrainingPanel(Panel):
    """The section Training."""

    def __init__(self, ui: Any, session: ModuleSession) -> None:
        super().__init__(ui, session)
        self._logic = session.training
        modes = [(_("Desktop screen"), Mode.DESKTOP.value), (_("Headset"), Mode.HMD.value)]
        bindChosen(ui.modeComboBox, modes, session.settings, MODE)
        bind(ui.tutorialCheckBox, "checked", session.settings, IS_TUTORIAL_FIRST)
        bind(ui.slicesNextPointCheckBox, "checked", session.settings, SLICES_SHOW_NEXT_POINT)
        bind(ui.slicesToolCheckBox, "checked", session.settings, SLICES_FOLLOW_TOOL)
        for box in (ui.slicesNextPointCheckBox, ui.slicesToolCheckBox):
            box.connect("toggled(bool)", lambda _checked: session.woken.emit())
        notStarted, logic = _("The trial was not started."), self._logic
        run = partial(self._start, TRIAL_RUN)
        self.startTrialRun = connectClick(ui.startTrialRunButton, run, notStarted)
        self.startTask = connectClick(ui.startTaskButton, self._startTask, notStarted)
        pause = partial(logic.command, CommandName.PAUSE)
        self.pause = guardedAction(pause, _("The trial was not paused."))
        resume = partial(logic.command, CommandName.RESUME)
        self.resume = guardedAction(resume, _("The trial was not resumed."))
        connectAsPressed(
            ui.pauseButton,
            lambda: self.resume if logic.status.phase == Phase.PAUSED.value else self.pause,
        )
        connectClick(ui.abortButton, self.abort, _("The trial was not aborted."))
        sayings = self._logic.answered, session.trials.problemFound
        self.listen(
            (self._logic.changed, self.showState),
            *((signal, partial(setText, ui.trainingMessageText)) for signal in sayings),
            (session.trainees.changed, self.showState),
            (session.taskChosen, self._showChoices),
            (session.link.statusChanged, self.showState),
            (session.trials.trialKept, self.showState),
            (session.secondPassed, self._showTime),
        )
        self._showChoices()
        self.showState()

    def _startTask(self) -> None:
        boxes = {"procedure": self._ui.procedureComboBox, "method": self._ui.methodComboBox}
        chosen = {name: chosenData(box) for name, box in boxes.items()}
        self._start(self._session.task, **chosen)

    def _start(self, task: str, **others: str) -> None:
        mode, isTutorialFirst = chosenData(self._ui.modeComboBox), self._ui.tutorialCheckBox.checked
        self._session.study.startTrial(task, mode, isTutorialFirst, **others)

    def abort(self) -> None:
        trial = self._logic.status
        question = _("Abort the trial of {name}? Its touches will not be registered.").format(
            name=shortName(trial.trainee)
        )
        if slicer.util.confirmYesNoDisplay(toolTip(question), _("Abort the trial")):
            self._logic.abort(trial.trialId)

    def _showChoices(self) -> None:
        """Offer what the chosen scenario has; another scenario begins with fiducials alone."""
        box, methods = self._ui.methodComboBox, self._session.methods
        offerEntries(box, [(METHODS[each], each) for each in methods], chosenData(box))
        setEnabled(
            box,
            len(methods) > 1,
            _("The chosen scenario has no landmarks: only its fiducials can be touched."),
            _("What the trainee touches, and how the head is registered. A study decides this."),
        )
        entries = [(_("none: only touches"), "")]
        entries += [(title, name) for name, title in self._session.procedures]
        box = self._ui.procedureComboBox
        offerEntries(box, entries, chosenData(box))
        self.showState()

    def showState(self, *_arguments: Any) -> None:
        ui, trial, session = self._ui, self._logic.status, self._session
        nobody = _("None: choose one in the section Trainees.")
        setText(ui.trainingTraineeText, session.trainees.chosen or nobody)
        title = _("Start {task}").format(task=buttonTitle(session.taskTitle))
        setProperty(ui.startTaskButton, "text", title)
        self._showButtons(trial)
        received = len(session.trials.received)
        kept = _("{count}, all stored in the study").format(count=received)
        setText(ui.receivedText, kept if received else _("none"))
        if not session.link.status.isConnected:
            setText(ui.phaseText, _("not connected; no touch is lost"))
            setLight(ui.clearanceLight, GRAY)
            for label in (ui.trialText, ui.nextPointText, ui.elapsedText, ui.clearanceText):
                setText(label, "–")
            setText(ui.instructionText, "")
            return
        named = f"{shortName(trial.trainee)}, {shortName(task_title(trial.task))}"
        setText(ui.trialText, named if trial.trainee else "–")
        setText(ui.phaseText, PHASES.get(trial.phase, trial.phase))
        setProperty(ui.pointsProgressBar, "maximum", trial.total)
        setProperty(ui.pointsProgressBar, "value", min(trial.touched, trial.total))
        setText(ui.nextPointText, trial.nextPoint or "–")
        self._showTime()
        color, words = NEARNESS.get(trial.proximity, (GRAY, trial.proximity))
        setLight(ui.clearanceLight, color)
        setText(ui.clearanceText, words or "–")
        text = _("Shown to the trainee: {sentence}").format(sentence=trial.instruction)
        setText(ui.instructionText, text if trial.instruction else "")

    def _showTime(self) -> None:
        if self._session.link.status.isConnected:
            minutes, seconds = divmod(int(self._logic.status.elapsedS), 60)
            setText(self._ui.elapsedText, f"{minutes}:{seconds:02d} min")

    def _showButtons(self, trial: TrialStatus) -> None:
        ui, isConnected = self._ui, self._session.link.status.isConnected
        reason = self._logic.obstacle or ("" if self._session.trainees.chosen else NOBODY)
        for button in (ui.startTrialRunButton, ui.startTaskButton):
            setEnabled(button, not reason, reason)
        isPaused = trial.phase == Phase.PAUSED.value
        setProperty(ui.pauseButton, "text", _("Resume") if isPaused else _("Pause"))
        mayPause = isPaused or trial.phase in (Phase.RUNNING, *PROCEDURE_PHASES)
        for button, isPossible in ((ui.pauseButton, mayPause), (ui.abortButton, trial.isOpen)):
            setEnabled(button, isConnected and isPossible, _("No trial is running."))
