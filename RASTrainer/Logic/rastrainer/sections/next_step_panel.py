"""The line at the top: the state of the link, the trainee, the task, and the next step."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any

import qt

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN, Phase
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.next_step_logic import (
    NextAction,
    NextStep,
    Section,
    WorkflowState,
    nextStep,
)
from rastrainer.sections.panel import Panel
from rastrainer.slicer.link.link_status import NOT_INSTALLED
from rastrainer.slicer.translation import _
from rastrainer.trial.record import TrialRecord
from rastrainer.widgets.controls import LINK_LOOKS, connectAsPressed, setEnabled, setLight, setText
from rastrainer.widgets.plain_text import buttonTitle, shortName

SHORTCUT = "Ctrl+Return"
THIS_COMPUTER = ("", "127.0.0.1", "localhost", "::1")


class NextStepPanel(Panel):
    """Leads through a session: it draws what `nextStep` says, and lets the sections do it.

    Sections are folded and opened only when the workflow moves to another one. Those without a next
    step, such as Scenario and Plan, are never changed.
    """

    def __init__(
        self, ui: Any, session: ModuleSession, actions: Mapping[NextAction, Callable[[], None]]
    ) -> None:
        """`actions` does what belongs to a section: everything but waiting and viewing."""
        super().__init__(ui, session)
        self._actions = actions
        self._sections = {each: getattr(ui, f"{each.value}CollapsibleButton") for each in Section}
        self._now = WorkflowState(session.link.status)
        self._step = nextStep(self._now)
        self._section: Section | None = None
        connectAsPressed(ui.nextStepButton, lambda: partial(self._do, self._step))
        ui.hostLineEdit.connect("textChanged(QString)", self.showState)
        ui.programPathLineEdit.connect("currentPathChanged(QString)", self._lookAtSetup)
        ui.scoreCollapsibleButton.connect("contentsCollapsed(bool)", self._noteScoreSeen)
        self.listen(
            (session.link.statusChanged, self.showState),
            (session.training.changed, self._followTrial),
            (session.taskChosen, self.showState),
            (session.simulator.program.changed, self.showState),
            (session.simulator.setup.changed, self._lookAtSetup),
            (session.simulator.setup.finished, self._lookAtSetup),
            (session.simulator.running.changed, self.showState),
            (session.trainees.changed, self._lookUp),
            (session.study.changed, self._lookUp),
            # Each section shows it in a separate turn; only then is there something to see.
            (session.trials.trialScored, lambda each: self._noteResultLater(each.record)),
            (session.trials.drillKept, self._noteResultLater),
            (session.trials.problemFound, lambda _sentence: self._note(isUnscored=True)),
        )
        self._lookAtSetup()
        self._lookUp()

    def _do(self, step: NextStep) -> None:
        if step.action in self._actions:
            self._actions[step.action]()
        elif step.action is NextAction.CHOOSE_TRAINEE:
            self._sections[Section.TRAINEES].collapsed = False
            self._ui.traineeComboBox.showPopup()
        elif step.action is NextAction.ANSWER:
            self._sections[Section.STUDY].collapsed = False
        elif step.action is NextAction.SHOW_RESULT:
            self._note(hasNewResult=False, isResultShown=True)
        self.showState()

    def _note(self, **changes: Any) -> None:
        self._now = replace(self._now, **changes)
        self.showState()

    def showState(self, *_arguments: Any) -> None:
        session, ui = self._session, self._ui
        simulator, trial = session.simulator, session.training.status
        self._now = now = replace(
            self._now,
            # Reported at once, before downloading a simulator to which no connection is possible.
            link=session.link.status if session.link.findKit() else NOT_INSTALLED,
            program=simulator.program.state,
            programSentence=simulator.program.sentence,
            isBeingSetUp=simulator.setup.isRunning,
            isElsewhere=ui.hostLineEdit.text.strip() not in THIS_COMPUTER,
            runningSentence=simulator.running.sentence if simulator.running.canConnect else "",
            isLearning=bool(self._now.trainee) and session.training.learner == self._now.trainee,
            isDeciding=bool(self._now.trainee) and session.training.decider == self._now.trainee,
            taskTitle=session.taskTitle,
            trial=trial,
            isLoading=session.training.loadings > 0,
        )
        color, word = LINK_LOOKS[now.link.state]
        setLight(ui.linkLight, color)
        setText(ui.linkText, word)
        trainee, task = now.trainee, now.taskTitle
        if now.link.isConnected and trial.isOpen:
            titles = {session.task: session.taskTitle, TRIAL_RUN: _("Trial run")}
            trainee, task = trial.trainee, titles.get(trial.task, trial.task)
        setText(ui.nowTraineeText, shortName(trainee) or _("No trainee"))
        setText(ui.nowTaskText, shortName(task))
        self._showStep(nextStep(now))

    def _showStep(self, step: NextStep) -> None:
        ui, self._step = self._ui, step
        if ui.nextStepButton.text != buttonTitle(step.title):
            ui.nextStepButton.text = buttonTitle(step.title)
            # A new text removes the shortcut.
            ui.nextStepButton.setShortcut(qt.QKeySequence(SHORTCUT))
        isPossible = step.action is not NextAction.WAIT
        tip = _("The next thing to do ({shortcut})").format(shortcut=SHORTCUT)
        setEnabled(ui.nextStepButton, isPossible, step.sentence, tip)
        setText(ui.nextStepText, step.sentence)
        if self._section is not step.section:
            self._section = step.section
            for each, button in self._sections.items():
                button.collapsed = each is not step.section

    def _lookUp(self, *_arguments: Any) -> None:
        trainees, now = self._session.trainees, self._now
        if trainees.chosen != now.trainee:
            now = replace(now, hasPracticed=False, hasNewResult=False, isResultShown=False)
        now = replace(now, trainee=trainees.chosen, progress=None)
        # The section Trainees shows the error.
        with contextlib.suppress(InputError):
            now = replace(now, hasTrainees=bool(trainees.trainees()))
            now = replace(now, hasPracticed=now.hasPracticed or bool(trainees.history()))
            now = replace(now, progress=self._session.study.progress())
        self._now = now
        self.showState()

    def _lookAtSetup(self, *_arguments: Any) -> None:
        # It is in a file, which should not be read at each state of a trial.
        self._note(needsSetup=self._session.simulator.needsSetup)

    def _followTrial(self) -> None:
        trial, now = self._session.training.status, self._now
        if trial.phase == Phase.RUNNING.value:
            hasPracticed = now.hasPracticed or trial.trainee == now.trainee
            now = replace(now, hasPracticed=hasPracticed, isUnscored=False)
            self._now = replace(now, hasNewResult=False, isResultShown=False)
        self.showState()

    def _noteResultLater(self, record: TrialRecord | DrillRecord) -> None:
        def note() -> None:
            if record.trainee == self._now.trainee:
                # A drill has no registration to be viewed before.
                isDrill = isinstance(record, DrillRecord)
                self._note(**{"isResultShown" if isDrill else "hasNewResult": True})

        self._session.work.later(note)

    def _noteScoreSeen(self, isFolded: bool) -> None:
        """Treat a result as seen when the user opens its section."""
        if not isFolded and self._now.hasNewResult:
            self._note(hasNewResult=False, isResultShown=True)
